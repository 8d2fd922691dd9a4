// Tests the designs of a study: points of Latin hypercubes and Sobol sequences, the full grid, and Sobol
// indices against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "app/program.h"
#include "app/study/next_cases.h"
#include "app/study/sampled_cases.h"
#include "app/study/sobol_indices.h"
#include "app/study/study_page.h"
#include "app/study/study_plan.h"
#include "app/study/study_summary.h"
#include "app/study/study_tables.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

const std::string spoon_file = std::string(SPOONBILL_ASSETS) + "/models/spoon-original.json";

StudyPlan design_of(const Workplace& place, const std::string& fields, const StudyChoices& choices = {}) {
  auto plan = make_study_plan(
      {spoon_file},
      place.write("design.json", R"({"spoonbill_study": 1, "claim": false, "repeats": false, "frames_deg": [],
        "tilts_deg": [-20, 0, 20], "frictions": [0.1], "vary": {"helping": [0.8, 1.2], "bowl_depth": [0.7, 1.4]},
        "foods": [{"name": "gelatin", "material": "gelatin-20-1", "size_mm": [28, 14, 22]}])" +
                                     fields + "}"),
      choices);
  EXPECT_TRUE(plan.ok()) << plan.error().message;
  return std::move(plan).value();
}

CaseResult holding(double margin_m) {
  CaseResult result;
  result.verdict = Verdict::holds;
  result.food_kg = 0.01;
  result.margin_m = margin_m;
  return result;
}

TEST(LatinHypercube, HasOnePointInEachPartOfEachCoordinate) {
  constexpr int count = 17, dimensions = 5;
  const std::vector<SamplePoint> points = draw_latin_hypercube(count, dimensions, 3);
  ASSERT_EQ(points.size(), 17u);
  for (std::size_t k = 0; k < dimensions; ++k) {
    std::set<int> parts;
    for (const SamplePoint& point : points) parts.insert(static_cast<int>(point[k] * count));
    EXPECT_EQ(parts.size(), 17u);
    EXPECT_EQ(*parts.begin(), 0);
    EXPECT_EQ(*parts.rbegin(), 16);
  }
  EXPECT_EQ(points, draw_latin_hypercube(count, dimensions, 3));
  EXPECT_NE(points, draw_latin_hypercube(count, dimensions, 4));
}

// The first points by the direction numbers of Joe and Kuo (2008), as scipy.stats.qmc.Sobol(4,
// scramble=False) gives them after the origin.
TEST(SobolSequence, BeginsAsPublished) {
  const std::vector<SamplePoint> expected{{0.5, 0.5, 0.5, 0.5},         {0.75, 0.25, 0.25, 0.25},
                                          {0.25, 0.75, 0.75, 0.75},     {0.375, 0.375, 0.625, 0.875},
                                          {0.875, 0.875, 0.125, 0.375}, {0.625, 0.125, 0.875, 0.625},
                                          {0.125, 0.625, 0.375, 0.125}};
  EXPECT_EQ(list_sobol_points(7, 4), expected);
}

// Ishigami and Homma (1990): sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 with each x from -pi to pi. Its indices
// have closed forms. An error of four standard errors is exceeded once in ten thousand.
TEST(SobolIndices, AreThoseOfIshigamisFunction) {
  constexpr int count = 4096;
  const auto ishigami = [](const double* unit) {
    double x[3];
    for (int k = 0; k < 3; ++k) x[k] = std::numbers::pi * (2.0 * unit[k] - 1.0);
    return std::sin(x[0]) + 7.0 * std::pow(std::sin(x[1]), 2.0) + 0.1 * std::pow(x[2], 4.0) * std::sin(x[0]);
  };
  SensitivityValues values;
  values.mixed.resize(3);
  for (const SamplePoint& point : list_sobol_points(count, 6)) {
    values.a.push_back(ishigami(point.data()));
    values.b.push_back(ishigami(point.data() + 3));
    for (std::size_t k = 0; k < 3; ++k) {
      double mixed[3] = {point[0], point[1], point[2]};
      mixed[k] = point[3 + k];
      values.mixed[k].push_back(ishigami(mixed));
    }
  }
  const double pi4 = std::pow(std::numbers::pi, 4.0);
  const double of_1 = 0.5 * std::pow(1.0 + 0.1 * pi4 / 5.0, 2.0), of_2 = 49.0 / 8.0,
               of_13 = 0.01 * pi4 * pi4 * (1.0 / 18.0 - 1.0 / 50.0), all = of_1 + of_2 + of_13;
  const std::vector<SobolIndex> indices = find_sobol_indices(values);
  const double first[] = {of_1 / all, of_2 / all, 0.0};
  const double total[] = {(of_1 + of_13) / all, of_2 / all, of_13 / all};
  ASSERT_EQ(indices.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(indices[k].first, first[k], 4.0 * indices[k].first_error) << k;
    EXPECT_NEAR(indices[k].total, total[k], 4.0 * indices[k].total_error) << k;
    EXPECT_LT(indices[k].first_error, 0.05) << k;
    EXPECT_LT(indices[k].total_error, 0.05) << k;
  }
}

TEST(SobolIndices, AreZeroIfNothingVaries) {
  const SensitivityValues values{{2.0, 2.0}, {2.0, 2.0}, {{2.0, 2.0}}};
  const std::vector<SobolIndex> indices = find_sobol_indices(values);
  EXPECT_EQ(indices[0].first, 0.0);
  EXPECT_EQ(indices[0].total_error, 0.0);
}

// Three values of each of two factors, in all combinations.
TEST(StudyGrid, HasAllCombinations) {
  const Workplace place;
  EXPECT_EQ(list_series(design_of(place, "")).size(), 1u + 2u + 2u);
  const StudyPlan full = design_of(place, R"(, "grid": "full")");
  const std::vector<StudySeries> all = list_series(full);
  ASSERT_EQ(all.size(), 9u);
  std::set<std::string> keys;
  for (const StudySeries& series : all) keys.insert(case_key(series.base));
  EXPECT_EQ(keys.size(), 9u);
  StudyChoices choices;
  choices.is_full_grid = false;
  EXPECT_FALSE(design_of(place, R"(, "grid": "full")", choices).is_full_grid);
  EXPECT_NE(plan_to_json(full).dump(), plan_to_json(design_of(place, "")).dump());
}

TEST(StudySample, IsDrawnFromItsRanges) {
  const Workplace place;
  for (const char* const method : {"sobol", "latin_hypercube"}) {
    const StudyPlan plan = design_of(place, R"(, "sample": {"method": ")" + std::string(method) +
                                                R"(", "count": 12, "ranges": {"friction": [0.02, 0.3],
                                                "tilt_deg": [-25, 5], "bowl_width": [0.9, 1.1]}})");
    const std::vector<StudyCase> cases = list_design_cases(plan);
    ASSERT_EQ(cases.size(), 12u);
    for (const StudyCase& one : cases) {
      EXPECT_TRUE(Range<double>(0.02, 0.3).contains(one.friction));
      EXPECT_TRUE(Range<double>(-25.0, 5.0).contains(one.tilt_deg));
      EXPECT_TRUE(Range<double>(0.9, 1.1).contains(one.bowl.width));
      EXPECT_EQ(one.helping, 1.0);
    }
    // The series of the plan are run as well.
    EXPECT_EQ(find_next_cases(plan, {}).size(), 12u + 5u * 3u);
  }
}

// The margin depends on the depth alone. Rows with a case that is not judged are left out.
TEST(Sensitivity, FindsTheFactorThatMatters) {
  const Workplace place;
  StudyChoices choices;
  choices.sensitivity_count = 64;
  const StudyPlan plan = design_of(place, "", choices);
  ASSERT_EQ(plan.sensitivity.ranges.size(), 3u);  // helping, depth and tilt; only one friction
  CaseResults results;
  const std::vector<StudyCase> cases = list_sampled_cases(plan);
  EXPECT_EQ(cases.size(), 64u * 5u);
  for (const StudyCase& one : cases) results[case_key(one)] = {one, holding(0.01 * one.bowl.depth)};
  const StudyCase lost = list_sensitivity_cases(plan).b[5];
  results[case_key(lost)].result.failure = "the food's lattice is tangled";
  const StudySummary summary = summarise(plan, results);
  ASSERT_TRUE(summary.sensitivity);
  EXPECT_EQ(summary.sensitivity->dropped, 1u);
  for (std::size_t k = 0; k < 3; ++k) {
    const double expected = summary.sensitivity->ranges[k].factor == StudyFactor::depth ? 1.0 : 0.0;
    EXPECT_NEAR(summary.sensitivity->indices[k].total, expected, 0.1);
    EXPECT_NEAR(summary.sensitivity->indices[k].first, expected, 0.1);
  }
  const auto json = study_json(plan, results, summary, {});
  ASSERT_TRUE(json.ok());
  EXPECT_EQ(json.value()["sensitivity"]["margins_m"]["a"].size(), 63u);
}

// Food that has left over one side, while its centre of mass is inside, has no margin.
TEST(Sensitivity, CountsNoMarginWhereTheFoodHasLeft) {
  const Workplace place;
  StudyChoices choices;
  choices.sensitivity_count = 8;
  const StudyPlan plan = design_of(place, "", choices);
  CaseResults results;
  for (const StudyCase& one : list_sampled_cases(plan)) {
    CaseResult result = holding(0.004);
    result.verdict = Verdict::leaves;
    results[case_key(one)] = {one, result};
  }
  const StudySummary summary = summarise(plan, results);
  for (const double margin_m : summary.sensitivity->margins_m.a) EXPECT_EQ(margin_m, 0.0);
}

TEST(StudyDesigns, StandOnThePage) {
  const Workplace place;
  StudyChoices choices;
  choices.sensitivity_count = 8;
  const StudyPlan plan = design_of(
      place,
      R"(, "grid": "full", "sample": {"method": "sobol", "count": 4, "ranges": {"pitch_deg": [0, 10]}})",
      choices);
  CaseResults results;
  for (const StudyCase& one : find_next_cases(plan, {})) {
    results[case_key(one)] = {one, holding(0.01 * one.helping)};
  }
  const auto page = make_study_page(plan, results, summarise(plan, results), {}, {});
  ASSERT_TRUE(page.ok());
  for (const char* const id : {"combined", "sample-plot", "sample-data", "indices"}) {
    EXPECT_NE(page->find("id=" + std::string(id)), std::string::npos) << id;
  }
}

TEST(StudyDesigns, RefuseWrongRanges) {
  const Workplace place;
  const auto field_of = [&](const std::string& fields) {
    const auto plan =
        make_study_plan({spoon_file}, place.write("wrong.json", R"({"spoonbill_study": 1, )" + fields + "}"));
    EXPECT_FALSE(plan.ok()) << fields;
    return plan.ok() ? "" : plan.error().field;
  };
  EXPECT_EQ(field_of(R"("grid": "half")"), "grid");
  EXPECT_EQ(field_of(R"("sample": {"method": "dice", "count": 4, "ranges": {"friction": [0, 1]}})"),
            "sample.method");
  EXPECT_EQ(field_of(R"("sample": {"method": "sobol", "count": 1, "ranges": {"friction": [0, 1]}})"),
            "sample.count");
  EXPECT_EQ(field_of(R"("sample": {"method": "sobol", "count": 4, "ranges": {"friction": [1, 1]}})"),
            "sample.ranges.friction");
  EXPECT_EQ(field_of(R"("sample": {"method": "sobol", "count": 4, "ranges": {}})"), "sample.ranges");
  EXPECT_EQ(field_of(R"("sensitivity": {"count": 8, "ranges": {"helping": [0, 1]}})"),
            "sensitivity.ranges.helping");
  EXPECT_EQ(field_of(R"("vary": {"friction": [0.2]})"), "vary.friction");
  EXPECT_EQ(field_of(R"("tilts_deg": [0], "frictions": [0.1], "vary": {}, "sensitivity": {"count": 8})"),
            "sensitivity");
  EXPECT_EQ(run({"study", spoon_file, "--out", place.text("out"), "--grid", "half"}).code, exit_wrong_use);
  EXPECT_EQ(run({"study", spoon_file, "--out", place.text("out"), "--sensitivity", "2"}).code,
            exit_wrong_use);
}

// Food that is wider than the bowl is named before the study runs.
TEST(StudyPlan, NamesFoodThatIsLargerThanABowl) {
  const Workplace place;
  StudyPlan plan = design_of(place, "");
  EXPECT_TRUE(find_large_foods(plan).empty());
  plan.spoons[0].bowl.width_m = 0.025;
  EXPECT_TRUE(find_large_foods(plan).empty()) << "28 mm along the bowl, 22 mm across";
  plan.spoons[0].bowl.width_m = 0.02;
  EXPECT_EQ(find_large_foods(plan).size(), 1u);
}

}  // namespace
}  // namespace spoonbill
