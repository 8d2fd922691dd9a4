// Quality of a fitted surface: closest points, folds and cusps, distances between data and surface both ways.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {

struct ClosestPoint {
  Vector2 uv = Vector2::Zero();
  double distance_m = 0.0;
  Vector3 point_m = Vector3::Zero();
};

// Closest-point search on one surface, which must stay unchanged and outlive this object. Thread-safe for
// reading.
class ClosestParameters {
 public:
  explicit ClosestParameters(const Surface& surface);
  ClosestParameters(const ClosestParameters&) = delete;
  ClosestParameters& operator=(const ClosestParameters&) = delete;

  // Searches for the closest point with at most `steps` Newton steps from the parameters `start`. Each step
  // is shortened until it reduces the distance, and is never longer than 0.75 of a mean knot span. The search
  // ends early if a step hardly reduces the distance.
  ClosestPoint project_from(const Vector3& point, const Vector2& start, int steps) const;

  // Makes the same search as project_from(), starting from the surface sample nearest to the point.
  ClosestPoint project(const Vector3& point, int steps) const;

 private:
  Vector3 position_at(const Vector2& uv) const;

  const Surface* surface_;
  PieceBasis u_, v_;
  Vector2 longest_step_;
  std::vector<Vector3> samples_;
  std::vector<Vector2> sample_uv_;
  NearestPoints nearest_;
};

struct FoldCheck {
  std::size_t samples = 0, folds = 0, cusps = 0;
  // One flag for each rectangle of (u, v) between successive knots; v varies fastest.
  std::vector<bool> span_folds, span_cusps;

  bool is_clean() const { return folds + cusps == 0; }
  bool is_better_than(const FoldCheck& other) const {
    return folds < other.folds || (folds == other.folds && cusps < other.cusps);
  }
};

// Normals of a scan and the surface parameters `uv` of their points. `normals` is empty or at least as long
// as `uv`; `are_estimated` is true if the scan had no normals and these are estimates.
struct NormalsAtParameters {
  std::span<const Vector2> uv;
  std::span<const Vector3> normals;
  bool are_estimated = false;
};

// Counts folds and cusps. A span here is a rectangle of (u, v) between successive knots.
//
// Folds: each span has 4 x 4 samples at cell centres, away from poles and seams. A sample folds if its normal
// opposes those of all six data points nearest in (u, v), the nearest of them being less than a span away.
// Distances in space would be misleading on thin walls. Six points are needed because normals vary from point
// to point at sharp rims. Without data normals, or with estimated ones, a sample also folds if its normal
// opposes that of the next sample.
//
// Cusps: each span has 12 x 12 samples. A cusp is a turn of the normal by more than 120 degrees between
// neighbouring samples. Its cause is a loop smaller than the spacing of the points, or an edge sharper than
// the knots can follow.
FoldCheck check_folds(const Surface& surface, const NormalsAtParameters& data);

struct Deviation {
  double max_m = 0.0, p95_m = 0.0, mean_m = 0.0;  // p95_m: 95th percentile
};
// Returns the deviation of a list of distances; all its values are zero if the list is empty.
Deviation compute_deviation(std::vector<double> distances_m);

struct FitErrors {
  // Distances from the data points to their closest surface points: data_to_surface excludes strays,
  // all_to_surface includes them. The data points are the given points. For a mesh whose long edges were
  // divided, they are the vertices after the division.
  Deviation data_to_surface, all_to_surface;
  // Number of strays: given points of zero trust, which are off the surface while their neighbours are not.
  std::size_t strays = 0;
  // Distances from surface samples, 4 x 4 per span, to the plane through the nearest data points or to the
  // nearest data point, whichever is closer.
  Deviation surface_to_data;
  // Fraction of the samples without nearby data; surface_to_data ignores these samples.
  double unseen_fraction = 0.0;
  // Values of each data point, for drawing: position, surface parameters, distance, and the stray flag.
  std::vector<Vector3> positions_m;
  std::vector<Vector2> uv;
  std::vector<double> distance_m;
  std::vector<bool> is_stray;
};

struct FittedSurface;

FitErrors measure_errors(const FittedSurface& fit, const FitPoints& points);

}  // namespace spoonbill
