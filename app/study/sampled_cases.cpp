#include "app/study/sampled_cases.h"

#include <boost/random/sobol.hpp>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

namespace spoonbill {
namespace {

// Rounds a value, so that tables can show it as it is.
double rounded(double value) {
  constexpr double steps = 1e4;
  return std::round(steps * value) / steps + 0.0;
}

// Returns the case with the values of a point, from its coordinate `first` on.
StudyCase make_sampled_case(const StudyPlan& plan, const std::vector<FactorRange>& ranges,
                            const SamplePoint& point, std::size_t first) {
  StudyCase sampled;
  sampled.spoon = plan.spoons.front().name;
  sampled.food = plan.foods.front().name;
  sampled.friction = plan.usual_friction;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Range<double>& range = ranges[k].range;
    factor_of(sampled, ranges[k].factor) = rounded(range.low + point[first + k] * (range.high - range.low));
  }
  return sampled;
}

}  // namespace

std::vector<SamplePoint> draw_latin_hypercube(int count, int dimensions, std::uint32_t seed) {
  // Distributions of the standard library differ between implementations; this generator does not.
  std::mt19937 generator(seed);
  const auto rows = static_cast<std::size_t>(count), columns = static_cast<std::size_t>(dimensions);
  std::vector<SamplePoint> points(rows, SamplePoint(columns));
  std::vector<std::size_t> strata(rows);
  for (std::size_t column = 0; column < columns; ++column) {
    std::iota(strata.begin(), strata.end(), std::size_t{0});
    for (std::size_t k = rows; k > 1; --k) std::swap(strata[k - 1], strata[generator() % k]);
    for (std::size_t row = 0; row < rows; ++row) {
      const double within = generator() / 4294967296.0;
      points[row][column] = (static_cast<double>(strata[row]) + within) / count;
    }
  }
  return points;
}

std::vector<SamplePoint> list_sobol_points(int count, int dimensions) {
  boost::random::sobol sequence(static_cast<std::size_t>(dimensions));
  std::vector<SamplePoint> points(static_cast<std::size_t>(count),
                                  SamplePoint(static_cast<std::size_t>(dimensions)));
  const double scale = std::ldexp(1.0, -64);
  for (SamplePoint& point : points) {
    for (double& coordinate : point) coordinate = scale * static_cast<double>(sequence());
  }
  return points;
}

std::vector<StudyCase> list_design_cases(const StudyPlan& plan) {
  const StudySample& sample = plan.sample;
  std::vector<StudyCase> cases;
  if (sample.count == 0) return cases;
  const int dimensions = static_cast<int>(sample.ranges.size());
  const std::vector<SamplePoint> points = sample.method == SampleMethod::sobol
                                              ? list_sobol_points(sample.count, dimensions)
                                              : draw_latin_hypercube(sample.count, dimensions, sample.seed);
  for (const SamplePoint& point : points) cases.push_back(make_sampled_case(plan, sample.ranges, point, 0));
  return cases;
}

SensitivityCases list_sensitivity_cases(const StudyPlan& plan) {
  SensitivityCases cases;
  if (plan.sensitivity.count == 0) return cases;
  const std::vector<FactorRange>& ranges = plan.sensitivity.ranges;
  const std::size_t factors = ranges.size();
  // The columns of one sequence are independent: the first half makes A, the second B.
  for (const SamplePoint& point : list_sobol_points(plan.sensitivity.count, static_cast<int>(2 * factors))) {
    cases.a.push_back(make_sampled_case(plan, ranges, point, 0));
    cases.b.push_back(make_sampled_case(plan, ranges, point, factors));
  }
  for (const FactorRange& range : ranges) {
    std::vector<StudyCase> mixed = cases.a;
    for (std::size_t row = 0; row < mixed.size(); ++row) {
      factor_of(mixed[row], range.factor) = factor_of(cases.b[row], range.factor);
    }
    cases.mixed.push_back(std::move(mixed));
  }
  return cases;
}

std::vector<StudyCase> list_sampled_cases(const StudyPlan& plan) {
  std::vector<StudyCase> all = list_design_cases(plan);
  const SensitivityCases sensitivity = list_sensitivity_cases(plan);
  all.insert(all.end(), sensitivity.a.begin(), sensitivity.a.end());
  all.insert(all.end(), sensitivity.b.begin(), sensitivity.b.end());
  for (const std::vector<StudyCase>& mixed : sensitivity.mixed) {
    all.insert(all.end(), mixed.begin(), mixed.end());
  }
  return all;
}

}  // namespace spoonbill
