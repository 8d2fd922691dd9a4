// Mapping from a lattice to a B-spline surface. Points of the surface are embedded in the lattice's cells by
// fixed weights: trilinear ones, or those of a linear map for points far outside the cells.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/collapsed_edges.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Difference between the displacements of a surface's samples and the displacements that the control net
// reproduces: the largest and the root mean square difference, and the parameters (u, v) of the largest. The
// ranges contain the samples beyond a tolerance; they are empty if there are none.
struct MappingResidual {
  double largest_m = 0.0;
  double root_mean_square_m = 0.0;
  double u = 0.0, v = 0.0;
  std::optional<Range<double>> u_range = {}, v_range = {};
};

// Ticks in which a surface catches up with its lattice after its knots have changed. A sudden catch would
// move the surface under the tool and could be felt.
inline constexpr int catch_up_ticks = 64;

// Mapping of one body: surface samples that are embedded in the lattice move with the nodes, and
// DisplacementRefit moves the control points with the samples. Owned by the simulation. update() and
// measure_residual() allocate nothing.
class BodyMapping {
 public:
  // Makes the mapping. `rest` is the surface from which the lattice's rest shape was made. `current` is the
  // surface for the lattice's present displacements, with the same knots; it may be behind the lattice.
  //
  // The part of the surface wholly behind a plane stays exactly fixed: knots are inserted at its edge, which
  // changes no shape, and the control points that affect it are fixed. Only parts at an open end of v are
  // fixed in this way. A plane that cuts a sheet across u fixes only nodes.
  //
  // If samples would be farther apart than half of `contact_cell_m`, elements are halved once more, and
  // samples that are then crowded bear no contacts (contact_samples.h). They may still be farther apart.
  static Result<BodyMapping> make(const Surface& rest, const Surface& current, const SpringLattice& lattice,
                                  const std::vector<FixingPlane>& planes, InstructionSet set,
                                  double contact_cell_m = std::numeric_limits<double>::infinity());

  const Surface& rest() const { return rest_; }
  const Surface& current() const { return current_; }
  const NestedGrid& nested() const { return *nested_; }

  // Moves current() by the nodes' displacement since make().
  void update(const SpringLattice& lattice);
  // Puts the rest shape at a pose. Call this instead of update() for a rigid body. Allocates nothing.
  void place(const Pose& pose);

  // A mapping starts with the shape of current(). If the lattice has moved away from this shape, the surface
  // then catches up in catch_up_ticks calls of catch_up(), one a tick. finish_catching_up() ends this at
  // once. catch_up_ticks_left() returns how many calls are left. Neither allocates; update() must follow.
  void catch_up();
  void finish_catching_up();
  int catch_up_ticks_left() const { return catch_up_ticks_left_; }

  // Difference between the lattice and the surface where the surface is free to move, as of the last
  // measure_residual().
  const MappingResidual& residual() const { return residual_; }
  void measure_residual(double tolerance_m = std::numeric_limits<double>::infinity());
  // Returns the lengths at rest of the element that contains (u, v), along u and along v through this point.
  std::array<double, 2> element_lengths_m(double u, double v) const;

  // Returns the mapping of a refined surface: a knot at the midpoint of each element that contains one of the
  // parameters `u` or `v`. It depends only on what stays the same between make() and the mapping's end, so
  // another thread may call this function while this mapping moves. Call adopt() before the first update().
  // The caller must check the new number of control points.
  Result<BodyMapping> refined(std::span<const double> u, std::span<const double> v,
                              const SpringLattice& lattice, const std::vector<FixingPlane>& planes) const;
  // Takes over the present shape of the mapping that refined() was called for, up to rounding, and then
  // catches up with the lattice. Allocates nothing.
  void adopt(const BodyMapping& coarser, const SpringLattice& lattice);
  // Returns the index here of each sample of the mapping that refined() was called for. Allocates.
  std::vector<int> find_samples_of(const BodyMapping& coarser) const;

  // sample() returns the embedding of a grid sample. at() returns the embedding of any point, blended from
  // the embeddings of the samples around the point.
  const EmbeddedPoint& sample(int index) const { return embedding_[index]; }
  EmbeddedPoint at(double u, double v) const;
  // contact_cell_m() returns that of make(). skipped() returns the samples that bear no contacts with other
  // bodies, because others are near. Samples that bear contacts are at most contact_spacing_m() apart;
  // infinite if contact_cell_m() is.
  double contact_cell_m() const { return contact_cell_m_; }
  const SkippedSamples& skipped() const { return skipped_; }
  double contact_spacing_m() const { return contact_spacing_m_; }
  // Returns the index of the first sample at the same point, across a seam or at a pole; otherwise the
  // sample's own index.
  int find_twin(int row, int column) const;
  // embedded_rest_m() returns the position of a sample's embedded point in the undeformed lattice, m.
  // embedded_m() returns its position at the last make(), update() or place(), m. This position differs from
  // that of the sample on current() by what the control net cannot reproduce.
  const Vector3& embedded_rest_m(int index) const { return embedded_rest_m_[index]; }
  Vector3 embedded_m(int index) const {
    if (placed_) return placed_->position_m + placed_->orientation * embedded_rest_m_[index];
    const std::size_t from = static_cast<std::size_t>(index) / columns_ * stride_ + index % columns_;
    const float* const base = base_moves_.data() + 4 * static_cast<std::size_t>(index);
    const Vector3 base_m(base[0], base[1], base[2]);
    return embedded_rest_m_[index] + base_m + Vector3(sample_[0][from], sample_[1][from], sample_[2][from]);
  }

 private:
  BodyMapping(Surface rest, Surface current, InstructionSet set)
      : set_(set), rest_(std::move(rest)), base_(current), current_(std::move(current)) {}
  void embed(const SpringLattice& lattice);
  // Embedding of one sample in the compact form that update() reads. An unused entry has weight 0.
  struct CellWeights {
    int node[8];
    float weight[8];
  };
  // Computes the displacement of each sample since make().
  void sample_displacements(const SpringLattice& lattice);
  // Computes the displacements that the samples of base_ have from rest_.
  void compute_base_displacements();
  // Starts at a shape of the surface that differs from base_ by these displacements at the samples, stored in
  // followed_.
  void start_catching_up(const SpringLattice& lattice);

  InstructionSet set_;
  Surface rest_, base_, current_;
  std::optional<Pose> placed_;  // pose at the last place(); empty for a body that deforms
  // Shared pointer, because colliders keep the grid's address when the mapping is moved.
  std::shared_ptr<NestedGrid> nested_;
  double contact_cell_m_ = 0.0, contact_spacing_m_ = 0.0;
  SkippedSamples skipped_;
  std::vector<EmbeddedPoint> embedding_;
  std::vector<Vector3> embedded_rest_m_;
  std::vector<CellWeights> cell_weights_;  // for each sample, the same weights as in embedding_
  AlignedVector<float> node_moves_;        // displacements of the nodes: x, y, z and 0 for each
  // Displacements of the samples that base_ stands for: x, y, z and 0 for each. Until the surface has caught
  // up, they differ from those of base_, reached_moves_.
  AlignedVector<float> base_moves_, reached_moves_;
  int catch_up_ticks_left_ = 0;
  // First and past-the-end column of the samples where the surface is free to move.
  int free_columns_begin_ = 0, free_columns_end_ = 0;
  // Blending matrices of the coarser surface at the samples, only after refined().
  std::optional<BlendingMatrix> coarser_u_, coarser_v_;
  std::vector<double> half_;  // working memory of adopt()
  // Displacements of the samples since make() by axis. Each of the grid's rows has stride_ values, of which
  // the first columns_ are used.
  AlignedVector<float> sample_[3];
  std::size_t columns_ = 0, stride_ = 0;
  std::vector<float> control_[3];
  bool first_pole_ = true, last_pole_ = true;    // whether v starts with a pole, and whether it ends with one
  std::vector<NetEdge> collapsed_edges_;         // edges whose control points are kept exactly together
  std::vector<DisplacementRefit> refit_;         // empty until made, then one element
  std::vector<GridEvaluator<float>> evaluator_;  // empty until made, then one element
  GridSamples<float> followed_;                  // displacement of the surface at the samples
  MappingResidual residual_;
};

}  // namespace spoonbill
