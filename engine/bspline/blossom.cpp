#include "engine/bspline/blossom.h"

#include <bit>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

BlossomWeights blossom_of_own_degree(const KnotVector& knots, int span, std::span<const double> arguments) {
  const int degree = knots.degree();
  const auto& t = knots.extended_knots();
  std::array<BlossomWeights, max_degree + 1> points{};
  for (int j = 0; j <= degree; ++j) points[j][j] = 1.0;
  for (int r = 1; r <= degree; ++r) {
    for (int j = degree; j >= r; --j) {
      const double low = t[span - degree + j], high = t[span + 1 + j - r];
      const double share = (arguments[r - 1] - low) / (high - low);
      for (int k = 0; k <= degree; ++k) {
        points[j][k] = (1.0 - share) * points[j - 1][k] + share * points[j][k];
      }
    }
  }
  return points[degree];
}

}  // namespace

BlossomWeights blossom(const KnotVector& knots, int span, std::span<const double> arguments) {
  const int degree = knots.degree(), count = static_cast<int>(arguments.size());
  SPOONBILL_ASSERT(count >= degree && count <= max_degree);
  SPOONBILL_ASSERT(span >= degree && span + degree + 1 < static_cast<int>(knots.extended_knots().size()));
  SPOONBILL_ASSERT_DEBUG(knots.extended_knots()[span] < knots.extended_knots()[span + 1]);
  if (count == degree) return blossom_of_own_degree(knots, span, arguments);
  BlossomWeights mean{};
  int choices = 0;
  for (unsigned choice = 0; choice < 1u << count; ++choice) {
    if (std::popcount(choice) != degree) continue;
    std::array<double, max_degree> chosen{};
    int next = 0;
    for (int k = 0; k < count; ++k) {
      if ((choice >> k & 1u) != 0) chosen[next++] = arguments[k];
    }
    const BlossomWeights weights = blossom_of_own_degree(knots, span, std::span(chosen).first(degree));
    for (int j = 0; j <= degree; ++j) mean[j] += weights[j];
    ++choices;
  }
  for (double& weight : mean) weight /= choices;
  return mean;
}

}  // namespace spoonbill
