// The pseudo-inverse of one direction's blending matrix under constraints: control points that stay where
// they are, and ends that are met exactly.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// What a fit must keep, besides fitting.
struct RefitConstraints {
  std::vector<std::uint8_t> held_columns;  // one a control column: 1 = never moves; empty = none
  // The first or the last sample is met exactly, so that a pole stays a pole; needs clamped knots.
  bool keep_first = false, keep_last = false;
};

// Control points (rows) from samples (columns): held rows are zero, kept ends copy their sample, and the free
// rows are A_free^+ (1 - A_ends S), S picking the end samples. Without constraints, pseudo_inverse(). Refused
// where the samples do not determine the control points.
Result<Eigen::MatrixXd> constrained_inverse(const KnotVector& knots, std::span<const double> parameters,
                                            const RefitConstraints& constraints);

}  // namespace spoonbill
