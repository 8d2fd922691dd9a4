// Bounds on how far a surface patch can bulge away from its corner samples.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// The largest norms of the second derivatives over each element (one polynomial piece in u by one in v), from
// the control points of the derivative surfaces, whose convex hull they cannot leave:
//   Q_i = p (P_{i+1} - P_i) / (u_{i+p+1} - u_{i+1}),  second_i = (p - 1) (Q_{i+1} - Q_i) / (u_{i+p+1} -
//   u_{i+2}).
// A cell of sides h_u, h_v inside one element then lies within (h_u^2 M_uu + h_v^2 M_vv) / 8 of the bilinear
// patch through its corners (the error of linear interpolation, once for each direction). They must follow
// the moving control points: a hull or a bound of the first shape is not one of the present shape.
//
// Allocates only when made; one owner, one thread.
class SurfaceBounds {
 public:
  SurfaceBounds(const KnotVector& u, const KnotVector& v);

  // Takes the bounds from the present control points; those of the elements (., element_v) alone once begin()
  // has put all aside.
  void update(const ControlNet& net);
  void begin() { ++stamp_; }
  void update(const ControlNet& net, int element_v);

  // A box about the elements (., element_v) or (element_u, .): the hull of their control points, as of the
  // last take_boxes().
  void take_boxes(const ControlNet& net);
  Box box(int element_v) const;
  Box row_box(int element_u) const;

  int elements_u() const { return static_cast<int>(span_u_.size()); }
  int elements_v() const { return static_cast<int>(span_v_.size()); }

  // How far the surface can leave the bilinear patch of a cell of the element.
  double bulge(int element_u, int element_v, double h_u, double h_v) const {
    const std::size_t e = static_cast<std::size_t>(element_u * elements_v() + element_v);
    return (h_u * h_u * second_uu_[e] + h_v * h_v * second_vv_[e]) / 8.0;
  }

 private:
  int rows_ = 0, columns_ = 0;  // of the unrolled net
  int degree_u_ = 0, degree_v_ = 0;
  void take_norms(const ControlNet& net, int column);
  void unroll_row(const ControlNet& net, int i);
  void take_row(const ControlNet& net, int i);
  void take_elements(int element_u);

  std::vector<int> span_u_, span_v_;        // of each element
  std::vector<int> control_u_, control_v_;  // unrolled index to control index
  std::vector<double> first_scale_u_, second_scale_u_, first_scale_v_, second_scale_v_;
  std::vector<double> norm_uu_, norm_vv_;  // squared, one an unrolled control point
  std::vector<double> second_uu_, second_vv_;
  std::uint64_t stamp_ = 1;
  std::vector<std::uint64_t> column_at_, element_at_;  // when taken: by unrolled column, by element_v
  std::vector<double> row_[3][3];         // working memory: unrolled row i of control points at i mod 3
  std::vector<double> low_[3], high_[3];  // of each control column
  std::vector<Box> row_boxes_;            // of each control row
};

}  // namespace spoonbill
