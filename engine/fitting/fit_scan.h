// B-spline surfaces of a scan: from points or triangles to one surface for each island, with its errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/fit_errors.h"
#include "engine/fitting/fit_surface.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Of a scan in several islands: only the largest, one closed body over the gaps, or each a body.
enum class IslandChoice { largest, bridge, all };

struct FitRequest {
  FitSettings settings;
  std::optional<ShapeKind> kind;  // found where none is asked for
  IslandChoice islands = IslandChoice::largest;
};

struct FittedBody {
  Surface surface;
  ShapeKind kind = ShapeKind::closed;
  FitErrors errors;
  FoldCheck folds;
  std::vector<Vector3> points_m;  // those given that belong to it
  Vector3 size_m = Vector3::Zero();
};

// An island of several that no surface could be laid out on.
struct UnfittedIsland {
  std::size_t points = 0;
  Vector3 size_m = Vector3::Zero(), centre_m = Vector3::Zero();  // of the box around it
  std::string why;
};

struct ScanFit {
  std::vector<FittedBody> bodies;        // the largest first
  std::size_t islands = 0;               // found, whatever was fitted of them
  std::vector<UnfittedIsland> unfitted;  // where all were asked for; the largest first
  std::size_t open_bridged = 0;          // islands bridged that were open elsewhere than at gaps, now capped
  // Points left out: where another is, apart, in specks, on islands that are none of the bodies.
  std::size_t joined = 0, outliers = 0, dust = 0, other_islands = 0;
  // Points of a cloud whose normals faced otherwise than those beside them and were turned, as where all face
  // the scanner; zero where they agreed.
  std::size_t turned_normals = 0;
};

// The scan's points must be finite. Refused, with what to try instead: too few points (of a cloud fewer than
// 90), a shape that cannot be laid out as the kind asked for (of several islands, where all are asked for:
// none of which can), islands that cannot be bridged.
Result<ScanFit> fit_scan(Scan scan, const FitRequest& request);

}  // namespace spoonbill
