// Levels of detail of one surface (section 4.1 of Pungotra et al. 2013). A level is a grid of samples, whose
// spacing halves from each level to the next. Samples are evaluated on demand. Bounds of the surface between
// samples give lower bounds of the distance between two surfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/geometry.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/patch_kernels.h"

namespace spoonbill {

// Rectangle in a surface's parameter domain that encloses some cells of a grid. If these cells are on both
// sides of a periodic direction's seam, the rectangle covers the whole domain in that direction.
struct ParameterRange {
  double u0, u1, v0, v1;
  bool contains(double u, double v) const { return u0 <= u && u <= u1 && v0 <= v && v <= v1; }
};

// Upper bounds of the norms of the second derivatives over each element (one polynomial piece in u by one in
// v).
//
// The bounds come from the control points of the derivative surfaces, whose convex hull contains the
// derivatives:
//   Q_i = p (P_{i+1} - P_i) / (u_{i+p+1} - u_{i+1}),
//   second_i = (p - 1) (Q_{i+1} - Q_i) / (u_{i+p+1} - u_{i+2}).
// A cell of sides h_u, h_v inside one element is within (h_u^2 M_uu + h_v^2 M_vv) / 8 of the bilinear patch
// through its corners, with M_uu and M_vv the bounds of the element. This is the error of linear
// interpolation, once for each direction. The bounds are valid only for the control points of the last
// update.
//
// Not thread-safe. Allocates only on construction.
class SurfaceBounds {
 public:
  SurfaceBounds(const KnotVector& u, const KnotVector& v);

  // Updates the bounds of all elements from the control points. The overload with `element_v` updates only
  // the elements in that column, and only if they have not been updated since begin().
  void update(const ControlNet& net);
  void begin() { ++stamp_; }
  void update(const ControlNet& net, int element_v);

  // Updates the boxes that box() and row_box() return. box() encloses the control points of the elements in
  // column element_v, row_box() those of the elements in row element_u.
  void update_boxes(const ControlNet& net);
  Box box(int element_v) const;
  Box row_box(int element_u) const;

  int elements_u() const { return static_cast<int>(span_u_.size()); }
  int elements_v() const { return static_cast<int>(span_v_.size()); }

  // Returns an upper bound of the distance of the surface from the bilinear patch of a cell of the element,
  // in metres. `h_u` and `h_v` are the lengths of the cell in u and v.
  double bulge(int element_u, int element_v, double h_u, double h_v) const {
    const std::size_t e = static_cast<std::size_t>(element_u * elements_v() + element_v);
    return (h_u * h_u * second_uu_[e] + h_v * h_v * second_vv_[e]) / 8.0;
  }

 private:
  // Numbers of rows and columns of the unrolled control net. This net repeats the first control points of a
  // periodic direction at its end.
  int rows_ = 0, columns_ = 0;
  int degree_u_ = 0, degree_v_ = 0;
  void update_column_norms(const ControlNet& net, int column);
  void unroll_row(const ControlNet& net, int i);
  void update_row_norms(const ControlNet& net, int i);
  void update_elements(int element_u);

  std::vector<int> span_u_, span_v_;  // knot span of each element
  // Index of the row or column of control points for each row and column of the unrolled net.
  std::vector<int> control_u_, control_v_;
  std::vector<double> first_scale_u_, second_scale_u_, first_scale_v_, second_scale_v_;
  // Squared norms of the second derivatives' control points, by row and column of the unrolled net.
  std::vector<double> norm_uu_, norm_vv_;
  std::vector<double> second_uu_, second_vv_;
  std::uint64_t stamp_ = 1;
  // Value of stamp_ at the last update of each column of the unrolled net, and of the elements in each span
  // of v.
  std::vector<std::uint64_t> column_at_, element_at_;
  std::vector<double> row_[3][3];         // working memory: row i of the unrolled net is at index i mod 3
  std::vector<double> low_[3], high_[3];  // bounds of the coordinates in each column of control points
  std::vector<Box> row_boxes_;            // one box for each row of control points
};

// Distance in metres up to which surfaces count as touching.
inline constexpr double touch_tolerance_m = 1e-6;

// A sampling grid with nested strides, one for each level of detail.
struct NestedGrid {
  Grid grid;
  int levels = 0;  // number of times that the stride is halved until it is 1
};

// For each sample of a grid, 1 if a search skips it. Empty if it skips none.
using SkippedSamples = std::vector<std::uint8_t>;
inline bool is_skipped(const SkippedSamples& skipped, int sample) {
  return !skipped.empty() && skipped[static_cast<std::size_t>(sample)] != 0;
}

// Makes a grid in which each element has 2^levels cells in each direction, so that no cell has a knot in its
// interior. `levels` must not be negative.
Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels);

// The patch between the samples (i, j) and (i + step, j + step) of the finest grid. The step is 2^(levels -
// level), with the `levels` of the NestedGrid.
struct LevelCell {
  int i, j, level;
};

// A sphere that contains the surface over one cell.
struct CoverSphere {
  Vector3 centre;
  double radius;
};

// Corners in the order (low u, low v), (low u, high v), (high u, low v), (high u, high v).
using PatchCorners = std::array<Vector3, 4>;

inline Vector3 patch_centre(const PatchCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

// Samples, bounds and spheres of one surface at all levels. Not thread-safe. Allocates only on construction.
// The grid must outlive the object.
class SurfaceLevels {
 public:
  explicit SurfaceLevels(const NestedGrid& nested, InstructionSet set = best_instruction_set());

  // Starts a query. Must be called whenever the control points may have moved. Returns false if none has
  // moved since the last call; all evaluated values then remain valid. The optional `samples` contain all
  // samples of the surface on the finest grid, in the order of GridEvaluator<double>; if they are given, no
  // sample is evaluated. The surface must have the grid's knots. The surface and the given samples must exist
  // until the next begin().
  bool begin(const Surface& surface, const PlanarPoints& samples = {});

  const Surface& surface() const { return *surface_; }
  PiecewiseSurface pieces() const { return {surface_, &u_pieces_, &v_pieces_}; }
  const NestedGrid& nested() const { return *nested_; }
  SurfaceBounds& bounds() { return bounds_; }
  int samples_evaluated() const { return samples_evaluated_; }

  // Returns one sample of the finest grid. The index of a sample is row * columns + column.
  Vector3 sample(int index);
  // Evaluates the samples of the coarsest level that are in one column. This is cheaper than single samples,
  // because the samples of a column share their sums along v.
  void sample_column(int column);
  // Evaluates all samples of one element. This is cheaper than single samples, and the results are bitwise
  // equal.
  void sample_element(int element_u, int element_v);
  // Returns all samples of the finest grid. Only entries that have been evaluated are valid.
  PlanarPoints samples() const { return external_samples_.x != nullptr ? external_samples_ : own_samples(); }
  const PatchKernels& kernels() const { return *kernels_; }

  int step(int level) const { return 1 << (nested_->levels - level); }
  bool is_finest(const LevelCell& cell) const { return cell.level >= nested_->levels; }
  PatchCorners corners(const LevelCell& cell);

  // Computes the boxes of the elements in row element_u from their corners and bulges, and the bulges
  // themselves. Both arrays have elements_v() entries.
  void element_boxes(int element_u, Box* boxes, double* bulges);

  // Returns an upper bound of the distance of the surface from the bilinear patch of the cell, in metres.
  double bulge(const LevelCell& cell);
  const CoverSphere& cover(const LevelCell& cell);

  // Returns the index of a cell among the cells of all levels. The cells of one level are contiguous.
  int cell_index(const LevelCell& cell) const {
    const int down = shift(cell.level);
    return first_cell_[cell.level] + (cell.i >> down) * ((nested_->grid.columns() - 1) >> down) +
           (cell.j >> down);
  }
  int shift(int level) const { return nested_->levels - level; }  // a cell's step is 2^shift
  int cell_count(int level) const;
  int total_cell_count() const { return static_cast<int>(covers_.size()); }

 private:
  // Basis functions at one sample. Their values are `Bands::padded` numbers apart.
  struct BandEntry {
    const int* controls;
    const double* values;
  };
  // Basis functions of each element in one direction, evaluated at the element's samples of the finest level.
  struct Bands {
    int bandwidth = 0, samples = 0, padded = 0;
    std::vector<int> controls;
    AlignedVector<double> values;
    TileBand tile_band(int element) const;
    BandEntry at(int row) const;
  };
  static Bands make_bands(const GridDirection& direction, int levels);
  bool store_net(const ControlNet& net);
  PlanarPoints own_samples() const { return {x_.data(), y_.data(), z_.data()}; }
  void set_sample(int index, const Vector3& point);

  const NestedGrid* nested_;
  const PatchKernels* kernels_;
  const Surface* surface_ = nullptr;
  PlanarPoints external_samples_;
  ControlNet net_;  // control points at the last begin()
  SurfaceBounds bounds_;
  PieceBasis u_pieces_, v_pieces_;
  Bands u_bands_, v_bands_;
  std::vector<double> x_, y_, z_;
  AlignedVector<double> tile_lines_;       // working memory of sample_element()
  std::vector<std::uint32_t> element_at_;  // value of generation_ when each element was sampled
  // Working memory: for one column of samples, the sum along v in each row of control points.
  std::vector<Vector3> lines_;
  std::vector<std::uint32_t> sampled_at_;  // value of generation_ when each sample was evaluated
  // Value of generation_ when the coarsest samples of each column were evaluated.
  std::vector<std::uint32_t> column_at_;
  std::vector<CoverSphere> covers_;  // indexed by cell_index()
  std::vector<std::uint32_t> covered_at_;
  std::vector<int> first_cell_;  // index of the first cell of each level
  std::uint32_t generation_ = 0;
  int samples_evaluated_ = 0;
};

// Returns a lower bound of the distance between two patches, in metres. It is the largest gap between their
// corners along three directions (the line between the centres and both normals), minus both bulges. A
// surface leaves the hull of its patch's corners by at most its bulge, so a plane that separates the hulls
// bounds the distance.
double patch_distance(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b);

// Returns a lower bound of the distance between two patches, in metres. It is the largest gap between their
// corners along the in-plane directions that are perpendicular to the sides of each patch, minus both bulges.
// This bound separates slivers that are side by side.
double patch_distance_in_plane(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b);

}  // namespace spoonbill
