// Levels of detail of one surface (section 4.1 of Pungotra et al. 2013): samples at nested strides of its
// blending matrices, evaluated as they are asked for, and spheres that provably cover the patches between.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/patch_kernels.h"
#include "engine/collision/levels/surface_bounds.h"

namespace spoonbill {

// Whether anything touches is decided to this.
inline constexpr double touch_tolerance_m = 1e-6;

struct NestedGrid {
  Grid grid;
  int levels = 0;  // strides halve level by level until they are 1
};

// Parameters nested so that no cell holds a knot inside and each element has 2^levels cells a direction.
Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels);

// The patch between the samples (i, j) and (i + step, j + step), where the step is 2^(levels - level).
struct LevelCell {
  int i, j, level;
};

struct CoverSphere {
  Vector3 centre;
  double radius;
};

// Corners in the order (low u, low v), (low u, high v), (high u, low v), (high u, high v).
using PatchCorners = std::array<Vector3, 4>;

// One owner, one thread; allocates only when made. The grid must outlive it.
class SurfaceLevels {
 public:
  explicit SurfaceLevels(const NestedGrid& nested, InstructionSet set = best_instruction_set());

  // To be called whenever the control points may have moved. Where none has since the last time, returns
  // false and keeps all that was evaluated of them. The surface must have the grid's knots and outlive the
  // calls below. Where all samples of the finest grid are known already, they may be given in its order, as
  // GridEvaluator<double> has them: none is then evaluated. They must be the surface's and outlive the calls
  // below.
  bool begin(const Surface& surface, const PlanarPoints& samples = {});

  const Surface& surface() const { return *surface_; }
  PiecewiseSurface pieces() const { return {surface_, &u_pieces_, &v_pieces_}; }
  const NestedGrid& nested() const { return *nested_; }
  SurfaceBounds& bounds() { return bounds_; }
  int samples_evaluated() const { return samples_evaluated_; }

  // index: row * columns + column of the finest grid.
  Vector3 sample(int index);
  // The coarsest samples of one column, which share their sums along v.
  void sample_column(int column);
  // All samples of one element, at a fraction of what they cost one by one; to the same bits.
  void sample_element(int element_u, int element_v);
  // Of the finest grid; valid where sampled.
  PlanarPoints samples() const { return given_.x != nullptr ? given_ : own_samples(); }
  const PatchKernels& kernels() const { return *kernels_; }

  int step(int level) const { return 1 << (nested_->levels - level); }
  bool is_finest(const LevelCell& cell) const { return cell.level >= nested_->levels; }
  PatchCorners corners(const LevelCell& cell);

  // About each of the elements (element_u, .), by its corners and its bulge, which go with them.
  void element_boxes(int element_u, Box* boxes, double* bulges);

  // How far the surface can leave the bilinear patch through the corners of the cell.
  double bulge(const LevelCell& cell);
  const CoverSphere& cover(const LevelCell& cell);

  // Cells of all levels, counted through; those of one level follow each other.
  int cell_index(const LevelCell& cell) const {
    const int down = shift(cell.level);
    return first_cell_[cell.level] + (cell.i >> down) * ((nested_->grid.columns() - 1) >> down) +
           (cell.j >> down);
  }
  int shift(int level) const { return nested_->levels - level; }  // a cell's step is 2^shift
  int cell_count(int level) const;
  int all_cells() const { return static_cast<int>(covers_.size()); }

 private:
  // The basis functions at one sample, `padded` apart.
  struct BandEntry {
    const int* controls;
    const double* values;
  };
  // The basis functions of each element of one direction at its finest samples.
  struct Bands {
    int bandwidth = 0, samples = 0, padded = 0;
    std::vector<int> controls;
    AlignedVector<double> values;
    TileBand of(int element) const;
    BandEntry at(int row) const;
  };
  static Bands bands_of(const GridDirection& direction, int levels);
  bool take_net(const ControlNet& net);
  PlanarPoints own_samples() const { return {x_.data(), y_.data(), z_.data()}; }
  void set_sample(int index, const Vector3& point);

  const NestedGrid* nested_;
  const PatchKernels* kernels_;
  const Surface* surface_ = nullptr;
  PlanarPoints given_;
  ControlNet net_;  // as of the last begin()
  SurfaceBounds bounds_;
  PieceBasis u_pieces_, v_pieces_;
  Bands u_bands_, v_bands_;
  std::vector<double> x_, y_, z_;
  AlignedVector<double> tile_lines_;       // working memory of a tile
  std::vector<std::uint32_t> element_at_;  // the begin() since which all samples of an element are there
  std::vector<Vector3> lines_;             // working memory: a column's sums along v, one a control row
  std::vector<std::uint32_t> sampled_at_;  // the begin() since which a sample was evaluated
  std::vector<std::uint32_t> column_at_;   // the same for the coarsest samples of a whole column
  std::vector<CoverSphere> covers_;        // by cell_index()
  std::vector<std::uint32_t> covered_at_;
  std::vector<int> first_cell_;  // of each level
  std::uint32_t begun_ = 0;
  int samples_evaluated_ = 0;
};

}  // namespace spoonbill
