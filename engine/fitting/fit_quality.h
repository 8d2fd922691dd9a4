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

  // Returns the stationary point that Gauss-Newton steps reach from `start`. Each step is shortened until it
  // reduces the distance and is never longer than 0.75 of a mean span.
  ClosestPoint project_from(const Vector3& point, const Vector2& start, int steps) const;

  // Does the same search, started from the surface sample nearest to the point.
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
  std::vector<bool> span_folds, span_cusps;  // one flag for each pair of spans, u-major

  bool is_clean() const { return folds + cusps == 0; }
  bool is_better_than(const FoldCheck& other) const {
    return folds < other.folds || (folds == other.folds && cusps < other.cusps);
  }
};

// Normals of a scan at parameters of the surface. `normals` is empty or as long as `uv`; `are_estimated`
// marks estimates for a scan without normals.
struct NormalsAtParameters {
  std::span<const Vector2> uv;
  std::span<const Vector3> normals;
  bool are_estimated = false;
};

// Counts folds and cusps.
//
// Folds: each span has 4 x 4 samples at cell centres, off poles and seams. A sample folds if its normal
// opposes those of the six data points nearest in (u, v), the nearest of them being less than a span away.
// Distances in space would mislead on thin walls, and normals vary from point to point at sharp rims. Without
// data normals, or with estimated ones, a sample also folds if its normal opposes the next sample's.
//
// Cusps: each span has 12 x 12 samples. A cusp is a turn of the normal by more than 120 degrees between
// neighbouring samples. It is a loop too small for the points to show, or an edge sharper than the knots can
// follow.
FoldCheck check_folds(const Surface& surface, const NormalsAtParameters& data);

struct Deviation {
  double max_m = 0.0, p95_m = 0.0, mean_m = 0.0;  // p95_m: 95th percentile
};
// Returns zeros for an empty list.
Deviation compute_deviation(std::vector<double> distances_m);

struct FitErrors {
  // Distances from the data to their closest surface points: data_to_surface excludes strays, all_to_surface
  // includes them. The data are the given points or, for a coarse mesh, points all over it.
  Deviation data_to_surface, all_to_surface;
  std::size_t strays = 0;  // given points of zero trust: off the surface, unlike the points around them
  // Distances from surface samples, 4 x 4 per span, to the plane of the nearest data points, or to the
  // nearest point if that is closer.
  Deviation surface_to_data;
  double unseen_fraction = 0.0;  // fraction of samples without data nearby, which surface_to_data ignores
  // Values for each data point, for pictures: position, surface parameters, distance, and the stray flag.
  std::vector<Vector3> positions_m;
  std::vector<Vector2> uv;
  std::vector<double> distance_m;
  std::vector<bool> is_stray;
};

struct FittedSurface;

FitErrors measure_errors(const FittedSurface& fit, const FitPoints& points);

}  // namespace spoonbill
