// The inverse of a tall matrix in the sense of least squares, with the same bits on every machine.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace spoonbill {

// (A^T A)^-1 A^T by QR, never by that formula, which squares the condition number. None where the columns of
// A depend on each other or outnumber the rows.
std::optional<Eigen::MatrixXd> least_squares_inverse(const Eigen::MatrixXd& matrix);

}  // namespace spoonbill
