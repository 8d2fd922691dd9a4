#include "engine/bspline/blending_matrix.h"

#include "engine/base/assert.h"
#include "engine/bspline/basis.h"

namespace spoonbill {

Eigen::MatrixXd BlendingMatrix::dense() const {
  SPOONBILL_ASSERT(first.size() == static_cast<std::size_t>(rows) &&
                   values.size() == first.size() * bandwidth);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < bandwidth; ++k) matrix(row, column(row, k)) += values[row * bandwidth + k];
  }
  return matrix;
}

BlendingMatrix blending_matrix(const KnotVector& knots, std::span<const double> parameters,
                               int derivative_order) {
  SPOONBILL_ASSERT(derivative_order >= 0 && derivative_order <= max_basis_derivative);
  SPOONBILL_ASSERT(knots.control_point_count() > 0);
  BlendingMatrix matrix;
  matrix.rows = static_cast<int>(parameters.size());
  matrix.columns = knots.control_point_count();
  matrix.bandwidth = knots.degree() + 1;
  matrix.first.reserve(parameters.size());
  matrix.values.reserve(parameters.size() * static_cast<std::size_t>(matrix.bandwidth));
  for (const double parameter : parameters) {
    const BasisFunctions basis = basis_functions(knots, knots.into_domain(parameter));
    matrix.first.push_back(knots.control_index(basis.span, 0));
    const auto& values = basis.values[derivative_order];
    matrix.values.insert(matrix.values.end(), values.begin(), values.begin() + matrix.bandwidth);
  }
  return matrix;
}

}  // namespace spoonbill
