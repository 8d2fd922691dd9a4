// Lattice cells that keep the stiffness of their rest shape while they rotate with the body.
#pragma once

#include <Eigen/Core>

#include "engine/material/cells/cell_elasticity.h"
#include "engine/material/cells/hexahedron.h"

namespace spoonbill {

// Returns R - 1 for the rotation R closest to the deformation gradient F = 1 + H, where H is `change`. This
// form keeps the digits of small rotations. F = R S with S symmetric. If F contains a reflection, R is still
// a rotation.
Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& change);

// A cell that keeps the stiffness of its rest shape and rotates with the body, for large rotations and small
// strains. A plain value type.
class CorotatedCell {
 public:
  CorotatedCell() = default;
  CorotatedCell(const CellCorners& rest, const CellMatrix& stiffness);

  const CellMatrix& stiffness() const { return stiffness_; }
  // Returns R - 1 for the rotation R of the whole cell.
  Eigen::Matrix3d turn(const CellMoves& moves) const;

  // Computes energy, forces and tangent.
  //
  // X are the corners at rest, x the deformed corners, and K is the stiffness. R is the rotation closest to
  // the deformation gradient F = R S at the centre of the cell. With x~ = R^T x and u = x~ - X, the energy is
  // 1/2 u^T K u. The rotation changes by R^T dR = [w], the cross-product matrix of
  // w = (tr S - S)^-1 sum g_i x dx~_i = G dx~, where g_i are the gradients of the shape functions. Therefore
  // du = (1 + [x~] G) dx~ = P dx~.
  //
  // The force is R P^T K u; it exerts no torque on a free body. The tangent is
  // R (P^T K P - [f~] G + G^T [n] P) R^T with n = K u and f~ = P^T n, made symmetric (Felippa and Haugen
  // 2005). It neglects the effect of stretch on w. Tangent::plain selects R P^T K P R^T.
  CellResponse respond(const CellMoves& moves, Tangent tangent) const;
  double energy_j(const CellMoves& moves) const;

 private:
  // Returns u = R^T (X + d) - X: the deformation without the rotation, in the axes of the rest shape, for the
  // corners X and displacements d.
  CellVector strained(const CellMoves& moves, const Eigen::Matrix3d& turn) const;

  CellVector rest_ = CellVector::Zero();  // corners relative to their mean
  CellMatrix stiffness_ = CellMatrix::Zero();
  CellGradients gradients_ = CellGradients::Zero();
};

}  // namespace spoonbill
