// A cell that keeps the stiffness of its rest shape while it turns with the body: large rotations, small
// strains.
#pragma once

#include "engine/material/cells/cell_response.h"

namespace spoonbill {

// How far the rotation R nearest to the deformation F = 1 + H is from none: R - 1, of which small turns keep
// their digits. F = R S with S symmetric; a reflection gives the nearest rotation all the same.
Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& change);

// Plain data; a value.
class CorotatedCell {
 public:
  CorotatedCell() = default;
  CorotatedCell(const CellCorners& rest, const CellMatrix& stiffness);

  const CellMatrix& stiffness() const { return stiffness_; }
  // The turn of the whole cell, R - 1.
  Eigen::Matrix3d turn(const CellMoves& moves) const;

  // With R the rotation nearest to the deformation F = R S in the middle of the cell, x~ = R^T x and
  // u = x~ - X, the energy is 1/2 u^T K u. R^T dR = [w] with w = (tr S - S)^-1 sum g_i x dx~_i = G dx~ for
  // the gradients g_i of the shape functions there, so du = (1 + [x~] G) dx~ = P dx~, and the force is
  // R P^T K u: it turns no free body. The tangent is R (P^T K P - [f~] G + G^T [n] P) R^T, n = K u,
  // f~ = P^T n, made symmetric (Felippa and Haugen 2005), but for how the stretch changes w; plain, it is
  // R P^T K P R^T.
  CellResponse respond(const CellMoves& moves, Tangent tangent) const;
  double energy_j(const CellMoves& moves) const;

 private:
  // u.
  CellVector strained(const CellMoves& moves, const Eigen::Matrix3d& turn) const;

  CellVector rest_ = CellVector::Zero();  // from the middle of the corners
  CellMatrix stiffness_ = CellMatrix::Zero();
  CellGradients gradients_ = CellGradients::Zero();
};

}  // namespace spoonbill
