// Tests which cases a study runs and what it says of their results, with results from a formula; its file of
// cases; and the errors of wrong study files.
#include "app/study/study_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "app/study/case_crew.h"
#include "app/study/case_file.h"
#include "app/study/next_cases.h"
#include "app/study/spoon_measures.h"
#include "app/study/study_page.h"
#include "app/study/study_parts.h"
#include "app/study/study_summary.h"
#include "app/study/study_tables.h"
#include "engine/exchange/document.h"
#include "tests/app/workplace.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

const std::string models = std::string(SPOONBILL_ASSETS) + "/models/";

StudyPlan plan_of(const Workplace& place, const std::string& study) {
  auto plan = make_study_plan({models + "spoon-original.json"}, place.write("study.json", study));
  EXPECT_TRUE(plan.ok()) << plan.error().message;
  return std::move(plan).value();
}

// Food that overhangs beyond 12.3 degrees to either side and leaves beyond 20 degrees, at any friction.
CaseResult formula(const StudyCase& one) {
  CaseResult result;
  const double away_deg = std::abs(one.tilt_deg);
  result.verdict = away_deg < 12.3 ? Verdict::holds : away_deg < 20.0 ? Verdict::overhangs : Verdict::leaves;
  result.food_kg = 0.01;
  result.outside_kg = result.verdict == Verdict::holds ? 0.0 : 0.001;
  if (result.verdict == Verdict::leaves) {
    result.first_spill_s = 2.0;
    result.side = one.tilt_deg < 0.0 ? RimSide::front : RimSide::back;
  }
  return result;
}

// Runs all rounds of a study, with `result_of` in place of trials.
template <class ResultOf>
CaseResults run_rounds(const StudyPlan& plan, const ResultOf& result_of) {
  CaseResults results;
  for (int round = 0; round < 20; ++round) {
    const std::vector<StudyCase> cases = find_next_cases(plan, results);
    if (cases.empty()) return results;
    for (const StudyCase& one : cases) {
      EXPECT_FALSE(results.contains(case_key(one))) << case_key(one);
      results[case_key(one)] = {one, result_of(one)};
    }
  }
  ADD_FAILURE() << "the study does not end";
  return results;
}

constexpr const char* small_study =
    R"({"spoonbill_study": 1, "tilts_deg": [-30, 0, 10, 20, 30], "frictions": [0.1], "vary": {}, "claim": false, "frames_deg": [],
        "foods": [{"name": "gelatin", "material": "gelatin-20-1", "size_mm": [28, 14, 22]}]})";

TEST(StudyCases, CloseInOnEachChangeOfVerdict) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const CaseResults results = run_rounds(plan, formula);
  const StudySummary summary = summarise(plan, results);
  ASSERT_EQ(summary.series.size(), 1u);
  const SeriesSummary& series = summary.series[0];
  ASSERT_EQ(series.changes.size(), 4u);
  for (const VerdictChange& change : series.changes) {
    EXPECT_LE(change.high_deg - change.low_deg, finest_tilt_deg);
  }
  ASSERT_TRUE(series.holds_deg);
  EXPECT_NEAR(series.holds_deg->low, -12.3, 0.5);
  EXPECT_NEAR(series.holds_deg->high, 12.3, 0.5);
  EXPECT_NEAR(series.best_deg, 0.0, series.uncertainty_deg);
  EXPECT_LE(series.uncertainty_deg, 0.5);
  EXPECT_EQ(summary.trust.repeats, 16);
  EXPECT_TRUE(summary.trust.disagreements.empty());
  // All 61 whole degrees would be 61 cases.
  EXPECT_LT(results.size(), 16u + 30u);
}

// A verdict that differs on the finer lattice, and again on the finest, is undecided, and the range that
// holds is known less well.
TEST(StudyCases, AreUndecidedWhereARepeatDisagrees) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const CaseResults results = run_rounds(plan, [](const StudyCase& one) {
    CaseResult result = formula(one);
    if (one.refinement == 1 && one.tilt_deg == 12.0) result.verdict = Verdict::overhangs;
    if (one.step_division == 2 && one.tilt_deg == 20.0) result.first_spill_s = 2.1;
    return result;
  });
  const StudySummary summary = summarise(plan, results);
  ASSERT_EQ(summary.trust.disagreements.size(), 1u);
  EXPECT_EQ(summary.trust.disagreements[0].repeat.refinement, 2);
  EXPECT_EQ(summary.trust.disagreements[0].usual, Verdict::overhangs);
  EXPECT_EQ(summary.trust.disagreements[0].repeated, Verdict::holds);
  EXPECT_NEAR(summary.trust.largest_time_change, 0.05, 1e-9);
  const SeriesSummary& series = summary.series[0];
  for (const JudgedTilt& tilt : series.tilts) {
    if (tilt.tilt_deg == 12.0) {
      EXPECT_EQ(tilt.verdict, Verdict::undecided);
    }
  }
  ASSERT_TRUE(series.holds_deg);
  EXPECT_LE(series.holds_deg->high, 12.0);
  EXPECT_GT(series.uncertainty_deg, 0.5);
}

// The finest lattice decides where it gives the verdict of the finer one. It is tried only where those before
// differ: in the verdict, or in the time of first spill by more than a tenth.
TEST(StudyCases, AreDecidedByTheFinestLattice) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const CaseResults results = run_rounds(plan, [](const StudyCase& one) {
    CaseResult result = formula(one);
    if (one.refinement > 0 && one.tilt_deg == 12.0) result.verdict = Verdict::overhangs;
    if (one.refinement > 0 && one.tilt_deg == 20.0) result.first_spill_s = 3.0;
    return result;
  });
  const StudySummary summary = summarise(plan, results);
  EXPECT_TRUE(summary.trust.disagreements.empty());
  EXPECT_LT(summary.trust.largest_time_change, 0.1);
  std::vector<double> finest;
  for (const auto& [key, done] : results) {
    if (done.study_case.refinement == 2) finest.push_back(done.study_case.tilt_deg);
  }
  std::sort(finest.begin(), finest.end());
  EXPECT_EQ(finest, (std::vector<double>{12.0, 20.0}));
  for (const JudgedTilt& tilt : summary.series[0].tilts) {
    if (tilt.tilt_deg == 12.0) {
      EXPECT_EQ(tilt.verdict, Verdict::overhangs);
    }
    if (tilt.tilt_deg == 20.0) {
      EXPECT_EQ(tilt.result->first_spill_s, 3.0);
    }
  }
}

TEST(StudyCases, ThatCannotBeJudgedAreListed) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const CaseResults results = run_rounds(plan, [](const StudyCase& one) {
    CaseResult result;
    result.failure = "the food's lattice is tangled";
    return one.tilt_deg == 0.0 ? formula(one) : result;
  });
  const StudySummary summary = summarise(plan, results);
  EXPECT_EQ(summary.failures.size(), results.size() - 1);
  // The tilts close in on the one that was judged; its range is open to both sides.
  const SeriesSummary& series = summary.series[0];
  EXPECT_TRUE(std::any_of(series.tilts.begin(), series.tilts.end(),
                          [](const JudgedTilt& tilt) { return tilt.tilt_deg == 1.0; }));
  EXPECT_TRUE(series.holds_deg && series.is_open_low && series.is_open_high);
  EXPECT_TRUE(series.changes.empty());
  EXPECT_EQ(read_claim(summary.series[0]), ClaimReading::untried);
}

TEST(StudyCases, CanReproduceTheClaimOfThePaper) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const auto shifted = [](const StudyCase& one) {
    StudyCase as_if = one;
    as_if.tilt_deg = 2.5 * (one.tilt_deg - 10.0);
    return formula(as_if);
  };
  EXPECT_EQ(read_claim(summarise(plan, run_rounds(plan, shifted)).series[0]), ClaimReading::reproduced);
  EXPECT_EQ(read_claim(summarise(plan, run_rounds(plan, formula)).series[0]), ClaimReading::not_reproduced);
}

TEST(StudySeries, VaryOneThingAtATime) {
  const Workplace place;
  const StudyPlan plan =
      make_study_plan({models + "spoon-original.json", models + "spoon-bent.json"}, {}).value();
  const std::vector<StudySeries> all = list_series(plan);
  // Two spoons, two foods, three frictions; two values of six factors; and both foods for the claim.
  ASSERT_EQ(all.size(), 12u + 12u + 2u);
  for (const StudySeries& series : all) {
    if (series.is_for_claim) continue;
    const StudyCase& base = series.base;
    const int changes = (base.helping != 1.0) + (base.stiffness != 1.0) + (base.bowl.depth != 1.0) +
                        (base.bowl.width != 1.0) + (base.bowl.curvature != 1.0) + (base.pitch_deg != 0.0);
    EXPECT_EQ(changes, series.varied ? 1 : 0);
    EXPECT_EQ(variation_text(base).empty(), !series.varied);
  }
}

// A liquid is refused at once, so that the cases take no time.
constexpr const char* liquid_study =
    R"({"spoonbill_study": 1, "tilts_deg": [-20, -10, 0, 10, 20], "frictions": [0.1, 0.2, 0.3], "vary": {},
        "claim": false, "frames_deg": [],
        "foods": [{"name": "soup", "material": "gelatin-20-1", "size_mm": [28, 14, 22], "yield_strain": 0.0005}]})";

TEST(CaseCrew, RunsEachCaseOnceWhateverTheNumberOfWorkers) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, liquid_study);
  const std::vector<StudyCase> cases = find_next_cases(plan, {});
  ASSERT_EQ(cases.size(), 15u);
  std::vector<std::string> texts;
  for (const int workers : {1, 3, 40}) {
    CaseResults results;
    const auto receive = [&](const StudyCase& one, const CaseResult& result) -> Status {
      EXPECT_TRUE(results.insert({case_key(one), {one, result}}).second);
      return {};
    };
    EXPECT_TRUE(run_cases(plan, cases, workers, receive, [] { return false; }).ok());
    texts.push_back(cases_text(plan_to_json(plan), results));
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_EQ(texts[0], texts[2]);
}

// The rough spoon has the shape of the original, whose result it shares. The other has a shape of its own.
TEST(CaseCrew, SpoonsOfOneShapeShareTheirResults) {
  const Workplace place;
  const auto file = [](const char* name) { return models + name + ".json"; };
  const StudyPlan plan =
      make_study_plan({file("spoon-original"), file("spoon-rough"), file("spoon-grip-dent")},
                      place.write("study.json", liquid_study))
          .value();
  EXPECT_EQ(find_first_of_shape(plan, "spoon-rough"), "spoon-original");
  EXPECT_EQ(find_first_of_shape(plan, "spoon-original"), "spoon-original");
  EXPECT_EQ(find_first_of_shape(plan, "spoon-grip-dent"), "spoon-grip-dent");
  std::vector<StudyCase> cases(2);
  cases[0].spoon = "spoon-rough";
  cases[1].spoon = "spoon-original";
  for (StudyCase& one : cases) {
    one.food = plan.foods.front().name;
  }
  std::map<std::string, std::string> results;
  const auto receive = [&](const StudyCase& one, const CaseResult& result) -> Status {
    results[one.spoon] = result_to_json(result).dump();
    return {};
  };
  ASSERT_TRUE(run_cases(plan, cases, 1, receive, [] { return false; }));
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results["spoon-rough"], results["spoon-original"]);
}

TEST(CaseCrew, StopsWhenAskedAndWhenAResultCannotBeKept) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, liquid_study);
  const std::vector<StudyCase> cases = find_next_cases(plan, {});
  const auto accept = [](const StudyCase&, const CaseResult&) -> Status { return {}; };
  EXPECT_EQ(run_cases(plan, cases, 2, accept, [] { return true; }).error().code, ErrorCode::cancelled);
  const auto refuse = [](const StudyCase&, const CaseResult&) -> Status {
    return Error{ErrorCode::unwritable, "full"};
  };
  EXPECT_EQ(run_cases(plan, cases, 2, refuse, [] { return false; }).error().code, ErrorCode::unwritable);
}

// Parts are merged into what a run of all cases gives, also if a part is run twice.
TEST(StudyParts, AreTogetherAllCases) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, liquid_study);
  const Json identity = plan_to_json(plan);
  const auto never = [] { return false; };
  std::filesystem::create_directories(place.path("parts"));
  for (const int number : {1, 3, 2, 4, 1}) {
    EXPECT_TRUE(run_part(place.path("parts"), plan, {number, 4}, 1, never).ok());
  }
  auto file = CaseFile::open(place.path("parts"), identity, false);
  ASSERT_TRUE(file.ok());
  const auto merged = merge_parts(place.path("parts"), plan, file.value());
  ASSERT_TRUE(merged.ok());
  EXPECT_EQ(merged.value(), 15u);
  EXPECT_TRUE(find_next_cases(plan, file->results()).empty());
  EXPECT_FALSE(std::filesystem::exists(place.path("parts") / "parts"));
  EXPECT_EQ(merge_parts(place.path("parts"), plan, file.value()).value(), 0u);
}

TEST(CaseFile, GoesOnAfterATornLine) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const Json identity = plan_to_json(plan);
  const CaseResults results = run_rounds(plan, formula);
  const auto write_all = [&](const std::string& folder, std::size_t first_part) {
    std::filesystem::create_directories(place.path(folder));
    std::size_t count = 0;
    {
      auto file = CaseFile::open(place.path(folder), identity, false);
      ASSERT_TRUE(file.ok()) << file.error().message;
      for (const auto& [key, done] : results) {
        if (count++ < first_part) {
          EXPECT_TRUE(file->add(done.study_case, done.result).ok());
        }
      }
      if (first_part >= results.size()) {
        EXPECT_TRUE(file->finish().ok());
        return;
      }
    }
    std::ofstream(place.path(folder) / "cases.jsonl.part", std::ios::app) << R"({"case": {"spo)";
    auto file = CaseFile::open(place.path(folder), identity, false);
    ASSERT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file->results().size(), first_part);
    for (const auto& [key, done] : results) {
      if (!file->results().contains(key)) {
        EXPECT_TRUE(file->add(done.study_case, done.result).ok());
      }
    }
    EXPECT_TRUE(file->finish().ok());
  };
  write_all("whole", results.size());
  write_all("stopped", 7);
  const auto content = [&](const std::string& folder) {
    return read_file(place.path(folder) / "cases.jsonl", 1 << 20).value();
  };
  EXPECT_EQ(content("whole"), content("stopped"));
  EXPECT_FALSE(std::filesystem::exists(place.path("stopped") / "cases.jsonl.part"));
}

TEST(CaseFile, RefusesTheCasesOfAnotherStudyAndTwoWriters) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const std::filesystem::path folder = place.path("study");
  std::filesystem::create_directories(folder);
  {
    const auto file = CaseFile::open(folder, plan_to_json(plan), false);
    ASSERT_TRUE(file.ok());
    EXPECT_EQ(CaseFile::open(folder, plan_to_json(plan), false).error().code, ErrorCode::in_use);
  }
  StudyPlan other = plan;
  other.frictions = {0.2};
  EXPECT_EQ(CaseFile::open(folder, plan_to_json(other), false).error().code, ErrorCode::mismatch);
  // Restarting removes what is there, also parts of another study.
  std::filesystem::create_directories(folder / "parts");
  place.write("study/parts/part-1-of-2.jsonl", cases_text(plan_to_json(plan), {}));
  {
    auto file = CaseFile::open(folder, plan_to_json(other), true);
    ASSERT_TRUE(file.ok());
    EXPECT_EQ(merge_parts(folder, other, file.value()).value(), 0u);
  }
  EXPECT_TRUE(CaseFile::open(folder, plan_to_json(other), false).ok());
}

// A crash between the renaming of an unfinished file and the writing of the new one loses nothing.
TEST(CaseFile, ReadsFilesThatWerePutAside) {
  const Workplace place;
  const StudyPlan plan = plan_of(place, small_study);
  const Json identity = plan_to_json(plan);
  const CaseResults results = run_rounds(plan, formula);
  std::filesystem::create_directories(place.path("study"));
  place.write("study/cases.jsonl.part.1", cases_text(identity, results));
  place.write("study/cases.jsonl.part", "");
  const auto file = CaseFile::open(place.path("study"), identity, false);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->results().size(), results.size());
}

TEST(StudyPlan, RefusesWrongFiles) {
  const Workplace place;
  const std::string spoon = models + "spoon-original.json";
  const auto error_of = [&](const std::string& study) {
    const auto plan = make_study_plan({spoon}, place.write("wrong.json", study));
    EXPECT_FALSE(plan.ok()) << study;
    return plan.ok() ? Error{ErrorCode::internal, ""} : plan.error();
  };
  EXPECT_EQ(error_of("{").code, ErrorCode::malformed);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 2})").field, "spoonbill_study");
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "tilt": [1]})").code, ErrorCode::unknown);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "tilts_deg": []})").field, "tilts_deg");
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "tilts_deg": [5, 0]})").code, ErrorCode::inconsistent);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "tilts_deg": [0, 90]})").code, ErrorCode::out_of_range);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "frictions": ["a"]})").code, ErrorCode::wrong_type);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "vary": {"length": [1]}})").code, ErrorCode::unknown);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "vary": {"helping": [0]}})").field, "vary.helping");
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "materials": ["butter"]})").code, ErrorCode::missing);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "ratings": [{"spoon": "spoon-original", "rating": 8}]})").code,
            ErrorCode::out_of_range);
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "ratings": [{"spoon": "ladle", "rating": 7}]})").code,
            ErrorCode::unknown);
  const std::string food = R"({"name": "a", "material": "gelatin-20-1", "size_mm": [28, 14, 22]})";
  EXPECT_EQ(error_of(R"({"spoonbill_study": 1, "foods": [)" + food + "," + food + "]}").code,
            ErrorCode::duplicate);
  EXPECT_EQ(
      error_of(R"({"spoonbill_study": 1, "foods": [{"name": "a", "material": "x", "size_mm": [1, 1, 1]}]})")
          .code,
      ErrorCode::missing);
}

TEST(StudyPlan, RefusesSpoonsWithoutABowl) {
  const auto code_of = [](const std::vector<std::filesystem::path>& spoons) {
    const auto plan = make_study_plan(spoons, {});
    return plan.ok() ? ErrorCode::internal : plan.error().code;
  };
  EXPECT_EQ(code_of({models + "spoon-handle.json"}), ErrorCode::missing);
  EXPECT_EQ(code_of({models + "no-spoon.json"}), ErrorCode::missing);
  EXPECT_EQ(code_of({models + "jelly-on-spoon.json"}), ErrorCode::too_many);
  EXPECT_EQ(code_of({models + "spoon-bowl.json", models + "spoon-bowl.json"}), ErrorCode::duplicate);
  EXPECT_EQ(code_of({models + "bowl.json"}), ErrorCode::unsupported);  // a shell
}

// A ball has a known volume, and its balance point is its centre.
TEST(SpoonMeasures, AreThoseOfABall) {
  StudySpoon spoon;
  spoon.body = stock_body("ball", SphereSize{0.02}, {0.05, 0.0, 0.0}, bundled_material("abs"), 300);
  spoon.bowl.centre_m = {0.05, 0.0, 0.0};
  spoon.bowl.length_m = 0.01;
  Material material;
  material.density_kg_per_m3 = 1000.0;
  const auto measures = measure_spoon(spoon, material, 0.0);
  ASSERT_TRUE(measures.ok());
  // The surface of a stock shape is fitted to about a thousandth of its size.
  EXPECT_NEAR(measures->mass_kg, 1000.0 * 4.18879 * std::pow(0.02, 3.0), 1e-4);
  EXPECT_NEAR(measures->balance_m, 0.02, 1e-4);
  EXPECT_NEAR(measures->length_m, 0.04, 2e-4);
}

TEST(SpoonMeasures, AreThoseOfALever) {
  StudySpoon spoon;
  spoon.name = "bar";
  spoon.body = read_document(models + "spoon-original.json")->scene.bodies.front();
  spoon.bowl = find_bowl(spoon.body, Vector3::UnitY()).value();
  Material material;
  material.density_kg_per_m3 = 1000.0;
  const auto measures = measure_spoon(spoon, material, 0.006);
  ASSERT_TRUE(measures.ok());
  ASSERT_GE(measures->grips.size(), 4u);
  // Two hands, 20 mm apart: the torques differ by the weight times that distance.
  const double weight_n = (measures->mass_kg + 0.006) * 9.80665;
  for (std::size_t k = 1; k < measures->grips.size(); ++k) {
    EXPECT_NEAR(measures->grips[k - 1].torque_nm - measures->grips[k].torque_nm, 0.02 * weight_n, 1e-12);
  }
  // Held at the balance point, an empty spoon has no torque.
  const auto empty = measure_spoon(spoon, material, 0.0);
  EXPECT_NEAR(empty->grips[0].torque_nm, empty->mass_kg * 9.80665 * (empty->balance_m - 0.02), 1e-12);
  EXPECT_NEAR(measures->grips[1].width_m, 0.012, 1e-4);
  EXPECT_NEAR(measures->grips[1].force_n,
              measures->grips[1].torque_nm / (skin_friction * measures->grips[1].width_m), 1e-12);
}

TEST(StudyPage, NeedsNoOtherFile) {
  const Workplace place;
  StudyPlan plan = plan_of(place, small_study);
  plan.spoons[0].name = "<b>\"spoon\" & </script>";
  plan.ratings = {{plan.spoons[0].name, "<b>", "</script><b>", 7}};
  StudyPlan renamed = plan;
  const CaseResults results = run_rounds(renamed, formula);
  const auto page = make_study_page(renamed, results, summarise(renamed, results), {}, {});
  ASSERT_TRUE(page.ok());
  for (const char* const word : {"<b>", "src=\"/", "src=\"http", "href", "@import", "url(", "</script>\""}) {
    EXPECT_EQ(page->find(word), std::string::npos) << word;
  }
  EXPECT_NE(page->find("&lt;b&gt;"), std::string::npos);
  for (const char* const id : {"best", "verdicts", "plot", "measures", "claims", "all", "rated"}) {
    EXPECT_NE(page->find("id=" + std::string(id)), std::string::npos) << id;
  }
}

}  // namespace
}  // namespace spoonbill
