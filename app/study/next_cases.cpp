#include "app/study/next_cases.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "app/study/sampled_cases.h"

namespace spoonbill {
namespace {

constexpr double least_time_change_s = 0.01;
// Changes by a finer lattice that ask for the finest one.
constexpr double time_change_limit = 0.1, mass_change_limit = 0.03;
constexpr double claim_bowl_depth = 0.5, claim_pitch_deg = -10.0, claim_friction = 0.02;

StudyCase varied_case(StudyCase base, StudyFactor factor, double value) {
  factor_of(base, factor) = value;
  return base;
}

// Adds a series for each value of each variation, with all else as usual.
void add_single_variations(const StudyPlan& plan, const StudyCase& base, std::vector<StudySeries>& all) {
  for (const StudyVariation& variation : plan.variations) {
    for (const double value : variation.values) {
      const StudyCase varied = varied_case(base, variation.factor, value);
      if (varied != base) all.push_back({varied, variation.factor, false});
    }
  }
}

// Adds a series for each combination of the values of all variations, each of them also as usual, but for the
// one with everything as usual.
void add_combinations(const StudyPlan& plan, const StudyCase& base, std::vector<StudySeries>& all) {
  std::vector<StudySeries> combined{{base, {}, false}};
  for (const StudyVariation& variation : plan.variations) {
    const std::size_t before = combined.size();
    for (const double value : variation.values) {
      for (std::size_t k = 0; k < before; ++k) {
        const StudyCase varied = varied_case(combined[k].base, variation.factor, value);
        if (varied != combined[k].base) combined.push_back({varied, variation.factor, false});
      }
    }
  }
  all.insert(all.end(), combined.begin() + 1, combined.end());
}

// Returns whether the verdicts differ, or only one of the cases was judged.
bool differ(const CaseResult& a, const CaseResult& b) {
  return is_judged(a) != is_judged(b) || (is_judged(a) && a.verdict != b.verdict);
}

// Calls `visit(low, high)` for neighbouring known tilts with different verdicts.
template <class Visit>
void for_each_change(const StudySeries& series, const CaseResults& results, const Visit& visit) {
  const std::vector<double> tilts = list_known_tilts(series, results);
  for (std::size_t k = 1; k < tilts.size(); ++k) {
    const CaseResult *const low = find_result(case_at(series, tilts[k - 1]), results),
                            *const high = find_result(case_at(series, tilts[k]), results);
    if (low && high && differ(*low, *high)) visit(tilts[k - 1], tilts[k]);
  }
}

}  // namespace

std::vector<StudySeries> list_series(const StudyPlan& plan) {
  std::vector<StudySeries> all;
  StudyCase base;
  for (const StudySpoon& spoon : plan.spoons) {
    for (const StudyFood& food : plan.foods) {
      for (const double friction : plan.frictions) {
        base.spoon = spoon.name;
        base.food = food.name;
        base.friction = friction;
        all.push_back({base, {}, false});
        if (plan.is_full_grid) add_combinations(plan, base, all);
      }
    }
  }
  base.spoon = plan.spoons.front().name;
  base.food = plan.foods.front().name;
  base.friction = plan.usual_friction;
  const bool has_usual =
      std::find(plan.frictions.begin(), plan.frictions.end(), plan.usual_friction) != plan.frictions.end();
  if (!plan.is_full_grid) {
    if (!plan.variations.empty() && !has_usual) all.push_back({base, {}, false});
    add_single_variations(plan, base, all);
  }
  if (plan.tries_claim) {
    // Straight, the bowl of the paper's pictures dips at its front. It has to be shallow and slippery for
    // food to leave it within ten degrees, and the food must be laid in after the tilt, because straight it
    // leaves.
    base.friction = claim_friction;
    base.bowl.depth = claim_bowl_depth;
    base.pitch_deg = claim_pitch_deg;
    base.is_laid_after = true;
    for (const StudyFood& food : plan.foods) {
      base.food = food.name;
      all.push_back({base, {}, true});
    }
  }
  return all;
}

StudyCase case_at(const StudySeries& series, double tilt_deg) {
  StudyCase at = series.base;
  at.tilt_deg = tilt_deg;
  return at;
}

std::vector<StudyCase> list_repeats(const StudyCase& study_case) {
  StudyCase half_step = study_case;
  half_step.step_division = 2;
  return {half_step, with_refinement(study_case, 1)};
}

StudyCase with_refinement(const StudyCase& study_case, int refinement) {
  StudyCase refined = study_case;
  refined.refinement = refinement;
  return refined;
}

std::vector<double> list_known_tilts(const StudySeries& series, const CaseResults& results) {
  std::vector<double> tilts;
  StudyCase any = series.base;
  for (const auto& [key, done] : results) {
    any.tilt_deg = done.study_case.tilt_deg;
    if (done.study_case == any) tilts.push_back(any.tilt_deg);
  }
  std::sort(tilts.begin(), tilts.end());
  return tilts;
}

std::vector<VerdictChange> find_changes(const StudySeries& series, const CaseResults& results) {
  std::vector<VerdictChange> changes;
  for_each_change(series, results, [&](double low, double high) {
    const bool are_judged = is_judged(*find_result(case_at(series, low), results)) &&
                            is_judged(*find_result(case_at(series, high), results));
    if (are_judged && high - low <= finest_tilt_deg) changes.push_back({low, high});
  });
  return changes;
}

const CaseResult* find_result(const StudyCase& study_case, const CaseResults& results) {
  const auto found = results.find(case_key(study_case));
  return found == results.end() ? nullptr : &found->second.result;
}

CaseDifference compare_cases(const StudyPlan& plan, const StudyCase& repeat, const CaseResult& usual,
                             const CaseResult& again) {
  CaseDifference difference;
  difference.is_other_verdict = differ(usual, again);
  if (difference.is_other_verdict || !is_judged(usual)) return difference;
  if (usual.first_spill_s && again.first_spill_s && std::abs(*usual.first_spill_s) > 0.0) {
    const double change_s = std::abs(*again.first_spill_s - *usual.first_spill_s);
    if (change_s > least_time_change_s) difference.time = change_s / std::abs(*usual.first_spill_s);
  }
  const auto food = std::find_if(plan.foods.begin(), plan.foods.end(),
                                 [&](const StudyFood& named) { return named.name == repeat.food; });
  if (usual.verdict == Verdict::overhangs && food != plan.foods.end() && !food->body.material.plastic) {
    difference.mass = std::abs(again.outside_kg / again.food_kg - usual.outside_kg / usual.food_kg);
  }
  return difference;
}

const CaseResult* find_confirmed_refinement(const StudyCase& usual, const CaseResults& results) {
  const CaseResult *const fine = find_result(with_refinement(usual, 1), results), *const finest = find_result(
                                                                                      with_refinement(usual,
                                                                                                      2),
                                                                                      results);
  return fine && finest && is_judged(*fine) && !differ(*fine, *finest) ? fine : nullptr;
}

namespace {

bool needs_finest(const StudyPlan& plan, const StudyCase& usual, const CaseResults& results) {
  const StudyCase finer = with_refinement(usual, 1);
  const CaseResult* const fine = find_result(finer, results);
  if (!fine) return false;
  const CaseDifference difference = compare_cases(plan, finer, *find_result(usual, results), *fine);
  return difference.is_other_verdict || difference.time > time_change_limit ||
         difference.mass > mass_change_limit;
}

}  // namespace

std::vector<StudyCase> find_next_cases(const StudyPlan& plan, const CaseResults& results) {
  std::vector<StudyCase> next;
  std::set<std::string> keys;
  const auto need = [&](const StudyCase& study_case) {
    const std::string key = case_key(study_case);
    if (!results.contains(key) && keys.insert(key).second) next.push_back(study_case);
  };
  for (const StudyCase& sampled : list_sampled_cases(plan)) need(sampled);
  for (const StudySeries& series : list_series(plan)) {
    const std::size_t before = next.size();
    for (const double tilt : plan.tilts_deg) need(case_at(series, tilt));
    if (next.size() > before) continue;
    for_each_change(series, results, [&](double low, double high) {
      if (high - low > finest_tilt_deg) need(case_at(series, std::round(0.5 * (low + high))));
    });
    if (next.size() > before || !plan.repeats) continue;
    for (const VerdictChange& change : find_changes(series, results)) {
      for (const double tilt : {change.low_deg, change.high_deg}) {
        const StudyCase usual = case_at(series, tilt);
        for (const StudyCase& repeat : list_repeats(usual)) need(repeat);
        if (needs_finest(plan, usual, results)) need(with_refinement(usual, 2));
      }
    }
  }
  return next;
}

}  // namespace spoonbill
