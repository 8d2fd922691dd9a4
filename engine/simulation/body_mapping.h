// From lattice to surface: grid samples are embedded in the lattice's cells by fixed trilinear weights,
// follow the nodes, and carry the control points with them through the displacement refit.
#pragma once

#include <memory>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// How far the surface stays behind what it should follow: the displacement of the samples that the control
// net cannot take, in metres, and where the largest of it is.
struct MappingResidual {
  double largest_m = 0.0;
  double root_mean_square_m = 0.0;
  double u = 0.0, v = 0.0;
};

// One owner, the simulation; update() and measure_residual() allocate nothing.
class BodyMapping {
 public:
  // `rest` is the surface that the lattice's rest shape was filled from, `current` the surface as it is now,
  // with the same knots; the lattice's present displacements belong to `current`. Behind each plane the part
  // of the surface that lies wholly there stays exactly: knots are inserted at its edge (which changes no
  // shape), and the control points that reach into it are held. Only along v, and where v is open: a sheet
  // that is fixed across u is so as its nodes are.
  static Result<BodyMapping> make(const Surface& rest, const Surface& current, const SpringLattice& lattice,
                                  const std::vector<FixingPlane>& planes, InstructionSet set);

  const Surface& rest() const { return rest_; }
  const Surface& current() const { return current_; }
  const NestedGrid& nested() const { return *nested_; }

  // Moves current() by what the nodes moved since make().
  void update(const SpringLattice& lattice);

  // Of the displacements since make(), as last measured.
  const MappingResidual& residual() const { return residual_; }
  void measure_residual();

  // The same with a knot in the middle of the elements, one in each direction, that hold this place: more
  // control points there, and the same shape to rounding. Refused at the most control points.
  Result<BodyMapping> refined_at(double u, double v, const SpringLattice& lattice,
                                 const std::vector<FixingPlane>& planes) const;

  // The embedding of a grid sample, and of any point by blending the samples around it.
  const EmbeddedPoint& sample(int index) const { return embedding_[index]; }
  EmbeddedPoint at(double u, double v) const;

  // The control points of v (columns) that are held, for tests and the panel.
  const std::vector<std::uint8_t>& fixed_columns() const { return held_columns_; }

 private:
  BodyMapping(Surface rest, Surface current, InstructionSet set)
      : set_(set), rest_(std::move(rest)), base_(current), current_(std::move(current)) {}
  // Of a sample, the one with whose place it is one: over a seam, or at a pole. Itself of most.
  int twin_of(int row, int column) const;
  void embed(const SpringLattice& lattice);
  // The embedding of one sample without gaps, as the tick reads it: a place that is not used has weight 0.
  struct CellWeights {
    int node[8];
    float weight[8];
  };
  // What each sample moved since make().
  void sample_displacements(const SpringLattice& lattice);

  InstructionSet set_;
  Surface rest_, base_, current_;
  // By pointer, because the collider keeps the grid's address when the mapping moves.
  std::shared_ptr<NestedGrid> nested_;
  std::vector<EmbeddedPoint> embedding_;
  std::vector<CellWeights> cell_weights_;  // the same
  AlignedVector<float> node_moves_;        // x, y, z, 0 of each node
  AlignedVector<float> base_moves_;        // the same of each sample, at make()
  AlignedVector<float> sample_[3];         // as the refit takes them
  std::vector<float> control_[3];
  std::vector<std::uint8_t> held_columns_;
  bool first_pole_ = true, last_pole_ = true;    // of v
  std::vector<DisplacementRefit> refit_;         // one, once made
  std::vector<GridEvaluator<float>> evaluator_;  // the same
  GridSamples<float> followed_;                  // what the surface moved at the samples
  MappingResidual residual_;
};

}  // namespace spoonbill
