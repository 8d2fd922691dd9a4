// Fits B-spline surfaces to a scan: one surface for each connected component, with its errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/fit_quality.h"
#include "engine/fitting/fit_surface.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Treatment of a scan with several connected components: fit the largest only, bridge all into one closed
// body, or fit each.
enum class IslandChoice { largest, bridge, all };

struct FitRequest {
  FitSettings settings;
  std::optional<ShapeKind> kind;  // kind of shape; default: detected
  // Treatment of several components. Default: fit the largest, which must contain half of the distinct
  // points.
  std::optional<IslandChoice> islands;
};

struct FittedBody {
  Surface surface;
  ShapeKind kind = ShapeKind::closed;
  FitErrors errors;
  FoldCheck folds;
  std::vector<Vector3> points_m;  // given points that belong to the body
  Vector3 size_m = Vector3::Zero();
};

// Connected component that could not be fitted while others could.
struct UnfittedIsland {
  std::size_t points = 0;
  // Size and centre of the component's bounding box.
  Vector3 size_m = Vector3::Zero(), centre_m = Vector3::Zero();
  std::string reason;
};

struct ScanFit {
  std::vector<FittedBody> bodies;        // fitted bodies, the largest first
  std::size_t islands = 0;               // number of connected components found
  std::vector<UnfittedIsland> unfitted;  // sorted by size, the largest first; only with IslandChoice::all
  // Number of bridged components that had open ends away from the gaps; these ends were capped.
  std::size_t open_bridged = 0;
  // Number of given points at different positions. For a mesh, the number of vertices after joining.
  std::size_t distinct = 0;
  double joining_distance_m = 0.0;  // 0 for a cloud
  // Numbers of points that no body uses, by reason: merged with another point, outliers, points of tiny
  // components, and points of components that were not fitted.
  std::size_t joined = 0, outliers = 0, dust = 0, other_islands = 0;
  // Number of cloud points whose normals were flipped to agree with neighbouring normals. Flipping is needed
  // when all normals face the scanner.
  std::size_t flipped_normals = 0;
};

// Fits a scan with finite points. Fails with advice in these cases: there are too few points (a cloud needs
// at least 90); a shape cannot be parameterised as the requested kind; less than half of the distinct points
// are used although the request does not choose islands; components cannot be bridged; or `progress` stopped
// the fit. With IslandChoice::all, components that cannot be fitted are listed in `unfitted`.
Result<ScanFit> fit_scan(Scan scan, const FitRequest& request);

}  // namespace spoonbill
