// Exact signed distances from a fixed body, to judge how far another body's skin is inside it.
#pragma once

#include <array>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Signed distances of points from a closed surface. The nearest points are found by Newton's method on the
// B-spline surface itself, from the nearest samples on both sides of a thin wall. The solver's own contact
// search is not used, so that its mistakes show.
class ExactDistance {
 public:
  // Points farther away than this are not measured.
  static constexpr double reach_m = 0.002;

  explicit ExactDistance(const Surface& surface);
  ExactDistance(const ExactDistance&) = delete;
  ExactDistance& operator=(const ExactDistance&) = delete;

  // Returns the distance, negative inside the body; reach_m if the point is outside and farther away.
  double at(const Vector3& point_m) const;

 private:
  struct Sample {
    Vector3 point_m, normal;
    double u, v;
  };
  using Cell = std::array<int, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  static Cell cell_of(const Vector3& point_m);

  Surface surface_;
  PieceBasis u_, v_;
  std::unordered_map<Cell, std::vector<Sample>, CellHash> cells_;
};

// A point of a skin, with its normal and the area that it represents.
struct SkinPoint {
  Vector3 point_m, normal;
  double area_m2;
};
// Samples a surface whose du x dv points outward at the centres of equal rectangles of its parameters.
std::vector<SkinPoint> sample_skin_points(const Surface& surface, int samples_each_way);

// Returns how far the deepest of these points is inside the body; 0 if none is.
double find_depth_m(const ExactDistance& body, const std::vector<SkinPoint>& skin);

// Returns how far the skin can move along a unit vector until it touches the body.
double find_gap_along_m(const ExactDistance& body, const std::vector<SkinPoint>& skin, const Vector3& down);

}  // namespace spoonbill
