// The equations of a body at rest: forces and stiffness by its free coordinates.
#pragma once

#include <Eigen/SparseCore>

#include "engine/material/statics/static_body.h"

namespace spoonbill {

// Coordinates are displacements from the rest shape, m; 3 n + axis belongs to node n. One owner; the body
// must outlive it.
class StaticSystem {
 public:
  // Each coordinate is held at most once.
  StaticSystem(const StaticBody& body, const std::vector<HeldAxis>& held);

  using Coordinates = Eigen::VectorXd;
  // The lower half, by free coordinates.
  using Stiffness = Eigen::SparseMatrix<double>;

  const StaticBody& body() const { return *body_; }

  Coordinates rest() const { return Coordinates::Zero(static_cast<Eigen::Index>(free_.size())); }
  // With the held coordinates at this share of their displacement.
  void hold(double share, Coordinates& at) const;
  void move(const Coordinates& free_step, double share, Coordinates& at) const;

  double energy_j(const Coordinates& at) const;
  // What the cells need to be held so, by all coordinates; their size is the root of the sum of squares of
  // what each cell alone needs.
  struct Forces {
    Coordinates held_so;
    double size = 0.0;
  };
  // Also takes the tangent, for stiffness().
  Forces respond(const Coordinates& at, Tangent tangent);
  const Stiffness& stiffness() const { return stiffness_; }
  Coordinates loads(const StaticLoads& loads, const Coordinates& at) const;
  Coordinates free_of(const Coordinates& all) const;

 private:
  CellMoves moves_of(std::size_t cell, const Coordinates& at) const;
  void lay_out();
  void add(std::size_t cell, const CellMatrix& tangent);

  const StaticBody* body_;
  std::vector<HeldAxis> held_;      // on both nodes of a place
  std::vector<Eigen::Index> free_;  // by coordinate: which free one it is; -1 where held
  Eigen::Index free_count_ = 0;
  Stiffness stiffness_;
  // By cell, 300 each: where the lower half of its tangent goes in the values of the stiffness; -1 nowhere.
  std::vector<Eigen::Index> places_;
};

}  // namespace spoonbill
