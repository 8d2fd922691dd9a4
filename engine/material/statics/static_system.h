// Equations of a body in equilibrium: forces and stiffness by its free coordinates.
#pragma once

#include <Eigen/SparseCore>

#include "engine/material/statics/static_body.h"

namespace spoonbill {

// Equilibrium equations of a body. The coordinates are displacements from the rest shape, m; coordinate 3 n +
// axis belongs to node n. Has one owner. The body must outlive the system.
class StaticSystem {
 public:
  // Sets up the equations; `fixed` may contain a coordinate at most once.
  StaticSystem(const StaticBody& body, const std::vector<FixedAxis>& fixed);

  using Coordinates = Eigen::VectorXd;
  // Lower half of the stiffness matrix, by free coordinates.
  using Stiffness = Eigen::SparseMatrix<double>;

  const StaticBody& body() const { return *body_; }
  bool is_fixed_everywhere() const { return free_count_ == 0; }

  Coordinates rest() const { return Coordinates::Zero(static_cast<Eigen::Index>(free_.size())); }
  // Sets the fixed coordinates to this fraction of their prescribed displacements.
  void set_fixed(double fraction, Coordinates& at) const;
  void move(const Coordinates& free_step, double fraction, Coordinates& at) const;

  double energy_j(const Coordinates& at) const;
  // Elastic restoring forces by coordinate. `size` is the root of the sum of the squared forces of all cells.
  struct Forces {
    Coordinates restoring;
    double size = 0.0;
  };
  // Computes the restoring forces, and the tangent that stiffness() then returns.
  Forces respond(const Coordinates& at, Tangent tangent);
  const Stiffness& stiffness() const { return stiffness_; }
  Coordinates loads(const StaticLoads& loads, const Coordinates& at) const;
  Coordinates restrict_to_free(const Coordinates& all) const;

 private:
  CellMoves cell_moves(std::size_t cell, const Coordinates& at) const;
  void build_pattern();
  void add(std::size_t cell, const CellMatrix& tangent);

  const StaticBody* body_;
  std::vector<FixedAxis> fixed_;    // fixed axes; each axis of a joined node is listed for both nodes
  std::vector<Eigen::Index> free_;  // for each coordinate: index among the free ones, or -1 if fixed
  Eigen::Index free_count_ = 0;
  Stiffness stiffness_;
  // Positions of each cell's tangent entries (the lower half, 300 per cell) in the values of the stiffness;
  // -1 for entries of fixed coordinates.
  std::vector<Eigen::Index> value_index_;
};

}  // namespace spoonbill
