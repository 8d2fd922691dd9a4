#include "engine/shapes/shape_knots.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Spans side by side differ by no more: the control net stays even, and least squares well conditioned.
constexpr double largest_step = 3.0;
// Of the largest error, what a fit may carry over into cells beside it: their own shows once that is gone.
constexpr double ringing_share = 0.1;
// At once, so that an error far from its asymptote does not ask for far too many.
constexpr int most_cut_at_once = 3;

}  // namespace

ShapeKnots::ShapeKnots(const ShapeDirection& direction, int degree)
    : periodic_(direction.periodic),
      degree_(degree),
      ends_(direction.breaks),
      jumps_(ends_.size(), degree > 2),
      spans_(ends_.size() - 1, 1) {
  SPOONBILL_ASSERT(direction.breaks.size() >= 2);
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(direction.breaks.begin(), direction.breaks.end()));
  SPOONBILL_ASSERT(degree >= 1 && degree <= max_degree);
  jumps_.front() = jumps_.back() = false;
}

ShapeKnots::ShapeKnots(const ShapeDirection& direction, int degree, int least_spans)
    : ShapeKnots(direction, degree) {
  SPOONBILL_ASSERT(least_spans >= 1);
  const double longest = (direction.end() - direction.start()) / least_spans;
  for (std::size_t k = spans_.size(); k-- > 0;) {
    const double length = ends_[k + 1] - ends_[k];
    const int cells = std::max(1, static_cast<int>(std::ceil(length / longest - 1e-9)));
    for (int cell = cells - 1; cell > 0; --cell) split(k, length * cell / cells, true);
  }
  grade();
}

void ShapeKnots::split(std::size_t cell, double length, bool from_start) {
  const double end = from_start ? ends_[cell] + length : ends_[cell + 1] - length;
  const auto after = static_cast<std::ptrdiff_t>(cell) + 1;
  ends_.insert(ends_.begin() + after, end);
  jumps_.insert(jumps_.begin() + after, false);
  spans_.insert(spans_.begin() + after, 1);
}

void ShapeKnots::grade() {
  const auto length = [&](std::size_t k) { return ends_[k + 1] - ends_[k]; };
  const auto split_beside = [&](std::size_t k, std::size_t beside, bool from_start) {
    const double most = largest_step * length(beside);
    if (!(length(k) > most * (1.0 + 1e-6))) return false;
    split(k, std::min(most, 0.5 * length(k)), from_start);
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 0; k < spans_.size(); ++k) {
      const std::size_t last = spans_.size() - 1;
      if (k > 0 || periodic_) changed |= split_beside(k, k > 0 ? k - 1 : last, true);
    }
    for (std::size_t k = spans_.size(); k-- > 0;) {
      const std::size_t last = spans_.size() - 1;
      if (k < last || periodic_) changed |= split_beside(k, k < last ? k + 1 : 0, false);
    }
  }
}

Result<ShapeKnots> ShapeKnots::counted(const ShapeDirection& direction, int degree, int control_count) {
  if (control_count < degree + 1) {
    return Error{std::to_string(control_count) + " control points are too few for degree " +
                 std::to_string(degree) + ", which needs " + std::to_string(degree + 1)};
  }
  ShapeKnots knots(direction, degree);
  const int cells = static_cast<int>(knots.spans_.size());
  const int spare = control_count - knots.control_count();
  // Breaks that leave less to spare are not worth it.
  if (cells > 1 && spare < cells / 2) {
    knots.ends_ = {direction.start(), direction.end()};
    knots.jumps_ = {false, false};
    knots.spans_ = {direction.periodic ? control_count : control_count - degree};
    return knots;
  }
  // A third goes where the shape asks for it, the others so that no part of it is left without.
  for (int left = spare - (cells > 1 ? spare / 3 : 0); left > 0; --left) {
    std::size_t longest = 0;
    for (std::size_t k = 1; k < knots.spans_.size(); ++k) {
      const auto length = [&](std::size_t c) {
        return (knots.ends_[c + 1] - knots.ends_[c]) / knots.spans_[c];
      };
      if (length(k) > length(longest) * (1.0 + 1e-9)) longest = k;
    }
    ++knots.spans_[longest];
  }
  return knots;
}

int ShapeKnots::control_count() const {
  const int spans = std::accumulate(spans_.begin(), spans_.end(), 0);
  const int repeated = (degree_ - 2) * static_cast<int>(std::count(jumps_.begin(), jumps_.end(), true));
  return spans + repeated + (periodic_ ? 0 : degree_);
}

std::vector<double> ShapeKnots::breakpoints() const {
  std::vector<double> points;
  for (std::size_t k = 0; k < spans_.size(); ++k) {
    for (int s = 0; s < spans_[k]; ++s) {
      points.push_back(ends_[k] + (ends_[k + 1] - ends_[k]) * s / spans_[k]);
    }
  }
  points.push_back(ends_.back());
  return points;
}

KnotVector ShapeKnots::knots() const {
  std::vector<double> knots = breakpoints();
  for (std::size_t k = 0; k < ends_.size(); ++k) {
    if (!jumps_[k]) continue;
    const auto place = std::lower_bound(knots.begin(), knots.end(), ends_[k]);
    knots.insert(place, static_cast<std::size_t>(degree_ - 2), ends_[k]);
  }
  if (periodic_) return KnotVector::periodic(degree_, std::move(knots)).value();
  knots.insert(knots.begin(), static_cast<std::size_t>(degree_), ends_.front());
  knots.insert(knots.end(), static_cast<std::size_t>(degree_), ends_.back());
  return KnotVector::open(degree_, std::move(knots)).value();
}

std::vector<double> ShapeKnots::parameters(int in_each_span) const {
  SPOONBILL_ASSERT(in_each_span >= 1);
  const std::vector<double> points = breakpoints();
  std::vector<double> parameters;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    for (int s = 0; s < in_each_span; ++s) {
      parameters.push_back(points[k] + (points[k + 1] - points[k]) * s / in_each_span);
    }
  }
  if (!periodic_) parameters.push_back(points.back());
  return parameters;
}

std::vector<double> ShapeKnots::largest_in_cells(const std::vector<double>& at,
                                                 const std::vector<double>& error_m) const {
  std::vector<double> largest(spans_.size(), 0.0);
  for (std::size_t p = 0; p < at.size(); ++p) {
    // A parameter on the border of two cells counts for both.
    for (std::size_t k = 0; k < spans_.size(); ++k) {
      if (at[p] >= ends_[k] && at[p] <= ends_[k + 1]) largest[k] = std::max(largest[k], error_m[p]);
    }
  }
  return largest;
}

bool ShapeKnots::refine(const std::vector<double>& at, const std::vector<double>& error_m, double allowed_m) {
  SPOONBILL_ASSERT(at.size() == error_m.size());
  SPOONBILL_ASSERT(allowed_m > 0.0);
  const std::vector<double> largest = largest_in_cells(at, error_m);
  const double least = ringing_share * *std::max_element(largest.begin(), largest.end());
  bool refined = false;
  for (std::size_t k = 0; k < spans_.size(); ++k) {
    if (!(largest[k] > allowed_m && largest[k] > least)) continue;
    const double cut = std::ceil(spans_[k] * std::pow(largest[k] / allowed_m, 1.0 / (degree_ + 1)));
    spans_[k] = std::clamp(static_cast<int>(std::min(cut, 1e6)), spans_[k] + 1, most_cut_at_once * spans_[k]);
    refined = true;
  }
  even_out();
  return refined;
}

void ShapeKnots::refine_worst(const std::vector<double>& at, const std::vector<double>& error_m) {
  SPOONBILL_ASSERT(at.size() == error_m.size() && !at.empty());
  const std::vector<double> largest = largest_in_cells(at, error_m);
  ++spans_[static_cast<std::size_t>(std::max_element(largest.begin(), largest.end()) - largest.begin())];
}

void ShapeKnots::even_out() {
  const std::size_t count = spans_.size();
  const auto cut_beside = [&](std::size_t k, std::size_t beside) {
    const double most = largest_step * (ends_[beside + 1] - ends_[beside]) / spans_[beside];
    const double length = ends_[k + 1] - ends_[k];
    if (!(length / spans_[k] > most * (1.0 + 1e-6))) return false;
    ++spans_[k];
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 0; k < count; ++k) {
      if (k > 0 || periodic_) changed |= cut_beside(k, (k + count - 1) % count);
      if (k + 1 < count || periodic_) changed |= cut_beside(k, (k + 1) % count);
    }
  }
}

}  // namespace spoonbill
