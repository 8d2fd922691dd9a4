// Cholesky factors of a stiffness matrix, whose computation can be stopped.
#pragma once

#include <Eigen/SparseCholesky>
#include <functional>

#include "engine/material/statics/static_system.h"

namespace spoonbill {

// Factors L D L^T of the lower half of a sparse symmetric matrix. Call analyzePattern() once, then factor()
// for each matrix of that pattern, then solve(). Has one owner.
class StiffnessFactors : public Eigen::SimplicialLDLT<StaticSystem::Stiffness> {
 public:
  // Returns the number of multiplications of a factorisation. Valid after analyzePattern().
  double work() const { return m_nonZerosPerCol.cast<double>().squaredNorm(); }

  // Factors the matrix, as factorize() does, and calls may_continue() several times a second. If
  // may_continue() returns false, stops without factors and returns false.
  bool factor(const StaticSystem::Stiffness& matrix, const std::function<bool()>& may_continue);

  // Returns whether the last matrix has factors and all pivots are larger than this fraction of the largest
  // one.
  bool has_pivots_above(double fraction) const {
    return info() == Eigen::Success && vectorD().minCoeff() > fraction * vectorD().maxCoeff();
  }

 private:
  struct Workspace;
  void find_row_pattern(const StaticSystem::Stiffness& upper, int row, Workspace& work) const;
  double eliminate_row(int row, Workspace& work);
};

}  // namespace spoonbill
