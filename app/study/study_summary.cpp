#include "app/study/study_summary.h"

#include <algorithm>
#include <cmath>

#include "app/study/sampled_cases.h"

namespace spoonbill {
namespace {

// Judges the case of a series at a tilt by its own verdict and those of its repeats.
JudgedTilt judge_tilt(const StudySeries& series, double tilt_deg, const CaseResults& results) {
  const StudyCase at = case_at(series, tilt_deg);
  JudgedTilt judged{tilt_deg, find_result(at, results)};
  if (!is_judged(*judged.result)) return judged;
  bool is_decided = true;
  for (const StudyCase& repeat : list_repeats(at)) {
    const CaseResult* const again = find_result(repeat, results);
    if (!again) continue;
    judged.is_repeated = true;
    const bool agrees = is_judged(*again) && again->verdict == judged.result->verdict;
    is_decided &= agrees || (repeat.refinement > 0 && find_confirmed_refinement(at, results));
  }
  if (!is_decided) return judged;
  if (const CaseResult* const refined = find_confirmed_refinement(at, results)) judged.result = refined;
  judged.verdict = judged.result->verdict;
  return judged;
}

// Finds the longest run of tilts that hold. `is_holding` tells what holds.
template <class IsHolding>
std::optional<std::pair<std::size_t, std::size_t>> find_longest_run(const std::vector<JudgedTilt>& tilts,
                                                                    const IsHolding& is_holding) {
  std::optional<std::pair<std::size_t, std::size_t>> longest;
  double length = -1.0;
  for (std::size_t first = 0; first < tilts.size(); ++first) {
    if (!is_holding(tilts[first])) continue;
    std::size_t last = first;
    while (last + 1 < tilts.size() && is_holding(tilts[last + 1])) ++last;
    if (tilts[last].tilt_deg - tilts[first].tilt_deg > length) {
      length = tilts[last].tilt_deg - tilts[first].tilt_deg;
      longest = {first, last};
    }
    first = last;
  }
  return longest;
}

void find_holding_range(SeriesSummary& summary) {
  const auto run =
      find_longest_run(summary.tilts, [](const JudgedTilt& tilt) { return tilt.verdict == Verdict::holds; });
  if (!run) return;
  const auto& [first, last] = *run;
  const std::vector<JudgedTilt>& tilts = summary.tilts;
  // An end is halfway between the last tilt that holds and the next that is decided and does not. Without
  // such a tilt, the range is open.
  const auto find_decided = [&](std::size_t from, int step) -> std::optional<double> {
    for (auto at = static_cast<std::ptrdiff_t>(from) + step;
         at >= 0 && at < static_cast<std::ptrdiff_t>(tilts.size()); at += step) {
      const JudgedTilt& tilt = tilts[static_cast<std::size_t>(at)];
      if (tilt.verdict != Verdict::undecided) return tilt.tilt_deg;
    }
    return std::nullopt;
  };
  double low = tilts[first].tilt_deg, high = tilts[last].tilt_deg, low_open = 0.0, high_open = 0.0;
  const std::optional<double> below = find_decided(first, -1), above = find_decided(last, 1);
  summary.is_open_low = !below;
  summary.is_open_high = !above;
  if (below) {
    low_open = 0.5 * (low - *below);
    low = 0.5 * (low + *below);
  }
  if (above) {
    high_open = 0.5 * (*above - high);
    high = 0.5 * (high + *above);
  }
  summary.holds_deg = Range<double>{low, high};
  summary.best_deg = 0.5 * (low + high);
  summary.uncertainty_deg = 0.5 * (low_open + high_open);
}

void compare_repeat(const StudyPlan& plan, const DoneCase& repeat, const CaseResult& usual,
                    TrustSummary& trust) {
  ++trust.repeats;
  const CaseDifference difference = compare_cases(plan, repeat.study_case, usual, repeat.result);
  if (difference.is_other_verdict && is_judged(usual) && is_judged(repeat.result)) {
    trust.disagreements.push_back({repeat.study_case, usual.verdict, repeat.result.verdict});
  }
  trust.largest_time_change = std::max(trust.largest_time_change, difference.time);
  trust.largest_mass_change = std::max(trust.largest_mass_change, difference.mass);
}

// The margin of a case; at most zero where the food has left, also over a rim behind its centre of mass.
double lasting_margin_m(const CaseResult& result) {
  return result.verdict == Verdict::leaves ? std::min(result.margin_m, 0.0) : result.margin_m;
}

SensitivitySummary summarise_sensitivity(const StudyPlan& plan, const CaseResults& results) {
  const SensitivityCases cases = list_sensitivity_cases(plan);
  SensitivitySummary summary;
  summary.ranges = plan.sensitivity.ranges;
  SensitivityValues& margins_m = summary.margins_m;
  margins_m.mixed.resize(summary.ranges.size());
  for (std::size_t row = 0; row < cases.a.size(); ++row) {
    std::vector<const CaseResult*> of_row{find_result(cases.a[row], results),
                                          find_result(cases.b[row], results)};
    for (const std::vector<StudyCase>& mixed : cases.mixed)
      of_row.push_back(find_result(mixed[row], results));
    if (!std::all_of(of_row.begin(), of_row.end(),
                     [](const CaseResult* result) { return result && is_judged(*result); })) {
      ++summary.dropped;
      continue;
    }
    margins_m.a.push_back(lasting_margin_m(*of_row[0]));
    margins_m.b.push_back(lasting_margin_m(*of_row[1]));
    for (std::size_t k = 0; k < cases.mixed.size(); ++k) {
      margins_m.mixed[k].push_back(lasting_margin_m(*of_row[k + 2]));
    }
  }
  if (margins_m.a.size() >= 2) summary.indices = find_sobol_indices(margins_m);
  return summary;
}

}  // namespace

StudySummary summarise(const StudyPlan& plan, const CaseResults& results) {
  StudySummary summary;
  for (const StudySeries& series : list_series(plan)) {
    SeriesSummary one;
    one.series = series;
    for (const double tilt : list_known_tilts(series, results)) {
      one.tilts.push_back(judge_tilt(series, tilt, results));
    }
    one.changes = find_changes(series, results);
    if (!one.tilts.empty()) find_holding_range(one);
    summary.series.push_back(std::move(one));
  }
  if (plan.sensitivity.count > 0) summary.sensitivity = summarise_sensitivity(plan, results);
  for (const auto& [key, done] : results) {
    if (!is_judged(done.result)) summary.failures.push_back(&done);
    const StudyCase& one = done.study_case;
    StudyCase usual = one;
    usual.step_division = 1;
    usual.refinement = one.refinement == 2 ? 1 : 0;
    if (usual == one) continue;
    // The finer lattice is compared with the finest one instead of the usual one, where that was tried.
    if (one.refinement == 1 && find_result(with_refinement(one, 2), results)) continue;
    if (const CaseResult* const result = find_result(usual, results)) {
      compare_repeat(plan, done, *result, summary.trust);
    }
  }
  return summary;
}

}  // namespace spoonbill
