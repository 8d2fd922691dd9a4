#include "engine/fitting/refine_knots.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr double evenly_spread_share = 0.3;

struct Span {
  double begin, end;
  double error;
};

std::vector<Span> spans_with_errors(const KnotVector& knots, int direction, std::span<const Vector2> uv,
                                    std::span<const double> weighted_squares) {
  const std::vector<double> breaks = knots.breakpoints();
  std::vector<Span> spans;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) spans.push_back({breaks[s], breaks[s + 1], 0.0});
  for (std::size_t p = 0; p < uv.size(); ++p) {
    if (uv[p].hasNaN()) continue;
    const double at = knots.into_domain(uv[p][direction]);
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    spans[static_cast<std::size_t>(above - breaks.begin()) - 1].error += weighted_squares[p];
  }
  const double sum = std::accumulate(spans.begin(), spans.end(), 0.0,
                                     [](double total, const Span& span) { return total + span.error; });
  const double length = breaks.back() - breaks.front();
  for (Span& span : spans) span.error += evenly_spread_share * sum * (span.end - span.begin) / length;
  return spans;
}

KnotVector knots_of(const KnotVector& like, const std::vector<Span>& spans) {
  std::vector<double> knots;
  knots.reserve(spans.size() + 1);
  for (const Span& span : spans) knots.push_back(span.begin);
  knots.push_back(spans.back().end);
  if (like.is_periodic()) return KnotVector::periodic(like.degree(), std::move(knots)).value();
  const auto ends = static_cast<std::size_t>(like.degree());
  knots.insert(knots.begin(), ends, knots.front());
  knots.insert(knots.end(), ends, knots.back());
  return KnotVector::open(like.degree(), std::move(knots)).value();
}

}  // namespace

KnotVector with_knots_for_errors(const KnotVector& knots, int direction, int count,
                                 std::span<const Vector2> uv, std::span<const double> weighted_squares) {
  SPOONBILL_ASSERT(direction == 0 || direction == 1);
  SPOONBILL_ASSERT(uv.size() == weighted_squares.size());
  std::vector<Span> spans = spans_with_errors(knots, direction, uv, weighted_squares);
  const double length = knots.domain_end() - knots.domain_start();
  for (int missing = count - knots.control_point_count(); missing > 0; --missing) {
    const double shortest = length / static_cast<double>(8 * spans.size());
    const auto worth = [&](const Span& span) {
      return span.end - span.begin < 2.0 * shortest ? -1.0 : span.error;
    };
    const auto most = std::max_element(spans.begin(), spans.end(),
                                       [&](const Span& a, const Span& b) { return worth(a) < worth(b); });
    // A cubic piece of half the length has a far smaller error.
    const Span whole = *most;
    const double middle = 0.5 * (whole.begin + whole.end);
    *most = {whole.begin, middle, 0.25 * whole.error};
    spans.insert(most + 1, {middle, whole.end, 0.25 * whole.error});
  }
  return knots_of(knots, spans);
}

}  // namespace spoonbill
