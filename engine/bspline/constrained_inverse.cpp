#include "engine/bspline/constrained_inverse.h"

#include <optional>

#include "engine/base/assert.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/least_squares.h"

namespace spoonbill {

Result<Eigen::MatrixXd> constrained_inverse(const KnotVector& knots, std::span<const double> parameters,
                                            const RefitConstraints& constraints) {
  SPOONBILL_ASSERT(constraints.held_columns.empty() ||
                   constraints.held_columns.size() == static_cast<std::size_t>(knots.control_point_count()));
  SPOONBILL_ASSERT(!(constraints.keep_first || constraints.keep_last) || !knots.is_periodic());
  SPOONBILL_ASSERT(!(constraints.keep_first || constraints.keep_last) || !parameters.empty());
  const bool constrained =
      constraints.keep_first || constraints.keep_last || !constraints.held_columns.empty();
  if (!constrained) return pseudo_inverse(knots, parameters);
  const Eigen::MatrixXd a = blending_matrix(knots, parameters, 0).dense();
  const Eigen::Index samples = a.rows(), controls = a.cols();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(controls, samples);
  std::vector<Eigen::Index> free, kept;
  for (Eigen::Index c = 0; c < controls; ++c) {
    const bool held =
        !constraints.held_columns.empty() && constraints.held_columns[static_cast<std::size_t>(c)] != 0;
    if (held) continue;
    if ((constraints.keep_first && c == 0) || (constraints.keep_last && c == controls - 1)) {
      inverse(c, c == 0 ? 0 : samples - 1) = 1.0;
      kept.push_back(c);
    } else {
      free.push_back(c);
    }
  }
  if (free.empty()) return inverse;
  Eigen::MatrixXd free_columns(samples, static_cast<Eigen::Index>(free.size()));
  for (std::size_t f = 0; f < free.size(); ++f) {
    free_columns.col(static_cast<Eigen::Index>(f)) = a.col(free[f]);
  }
  const std::optional<Eigen::MatrixXd> fit = least_squares_inverse(free_columns);
  if (!fit) return Error{"the samples do not determine the free control points; take more samples"};
  for (std::size_t f = 0; f < free.size(); ++f) inverse.row(free[f]) = fit->row(static_cast<Eigen::Index>(f));
  // A kept end follows its sample; what it takes of the others that way is not left to be fitted.
  for (const Eigen::Index c : kept) {
    const Eigen::Index sample = c == 0 ? 0 : samples - 1;
    for (std::size_t f = 0; f < free.size(); ++f) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < samples; ++k) {
        sum += (*fit)(static_cast<Eigen::Index>(f), k) * ((k == sample ? 1.0 : 0.0) - a(k, c));
      }
      inverse(free[f], sample) = sum;
    }
  }
  return inverse;
}

}  // namespace spoonbill
