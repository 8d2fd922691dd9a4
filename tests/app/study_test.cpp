// Tests trials of single cases of a study, and the command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "app/program.h"
#include "app/study/case_trial.h"
#include "app/study/next_cases.h"
#include "app/study/study_plan.h"
#include "engine/base/file.h"
#include "engine/exchange/document.h"
#include "tests/app/process.h"
#include "tests/app/workplace.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::string spoon_folder = std::string(SPOONBILL_ASSETS) + "/models/";

StudyPlan plan_of(const std::string& spoon) {
  auto plan = make_study_plan({spoon}, {});
  EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().message);
  return std::move(plan).value();
}

StudyCase usual_case(const StudyPlan& plan, double friction, double tilt_deg) {
  StudyCase one;
  one.spoon = plan.spoons[0].name;
  one.food = plan.foods[0].name;
  one.friction = friction;
  one.tilt_deg = tilt_deg;
  return one;
}

CaseResult judged(const StudyPlan& plan, const StudyCase& one) {
  const auto result = run_case(plan, one);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result->failure, "") << case_key(one);
  return result.value();
}

// Jelly slips from a surface steeper than the angle of friction until the bowl's wall holds it. With
// friction, it stays at tilts at which it leaves without.
TEST(StudyCase, IsJudgedByTheTilt) {
  const StudyPlan plan = plan_of(spoon_folder + "spoon-original.json");
  EXPECT_EQ(judged(plan, usual_case(plan, 0.02, 0.0)).verdict, Verdict::holds);
  const CaseResult front = judged(plan, usual_case(plan, 0.02, -28.0));
  EXPECT_EQ(front.verdict, Verdict::leaves);
  EXPECT_EQ(front.side, RimSide::front);
  EXPECT_TRUE(front.first_spill_s && *front.first_spill_s > 0.0);
  const CaseResult back = judged(plan, usual_case(plan, 0.02, 28.0));
  EXPECT_EQ(back.verdict, Verdict::leaves);
  EXPECT_EQ(back.side, RimSide::back);
  const CaseResult rough = judged(plan, usual_case(plan, 0.3, 28.0));
  EXPECT_EQ(rough.verdict, Verdict::holds);
  EXPECT_GT(rough.margin_m, 0.01);
  // The weight of the food, and a little more when it lands.
  EXPECT_GT(rough.largest_contact_n, rough.food_kg * standard_gravity_m_per_s2);
  EXPECT_LT(rough.largest_contact_n, 3.0 * rough.food_kg * standard_gravity_m_per_s2);
}

// A spoon that lies across gets the food along its bowl, and the result of the same spoon that lies along x.
TEST(StudyCase, LaysTheFoodAlongTheBowl) {
  const StudyPlan along = plan_of(spoon_folder + "spoon-bowl.json");
  const Workplace place;
  ASSERT_EQ(run({"change", spoon_folder + "spoon-bowl.json", "rotate", "y", "90deg", "--about", "0,0,0",
                 "--out", place.text("across.json")})
                .code,
            exit_done);
  const StudyPlan across = plan_of(place.text("across.json"));
  EXPECT_GT(std::abs(across.spoons[0].bowl.front.z()), 0.99);
  StudyCase one = usual_case(along, 0.1, 0.0);
  const auto size_of = [&](const StudyPlan& plan) {
    one.spoon = plan.spoons[0].name;
    const auto scene = make_case_scene(plan, one);
    EXPECT_TRUE(scene.ok());
    return bounding_box(scene->bodies[0].surface.net).extent();
  };
  const Vector3 lying = size_of(along), turned = size_of(across);
  EXPECT_NEAR(lying.x(), turned.z(), 1e-4);
  EXPECT_NEAR(lying.z(), turned.x(), 1e-4);
}

TEST(StudyCase, HasTheSameResultEachTime) {
  const StudyPlan plan = plan_of(spoon_folder + "spoon-original.json");
  const StudyCase one = usual_case(plan, 0.1, 5.0);
  EXPECT_EQ(result_to_json(judged(plan, one)).dump(), result_to_json(judged(plan, one)).dump());
}

// A change of verdict is where it is with half the step and with finer cells, for food that yields as well.
// The last tilt before the change, and food that yields, are tried in the full run only.
TEST(StudyCase, IsConfirmedByItsRepeats) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  StudyPlan plan = plan_of(spoon_folder + "spoon-original.json");
  for (const StudyFood& food : plan.foods) {
    for (const double tilt_deg : {22.0, 17.0}) {
      if ((tilt_deg == 17.0 || food.body.material.plastic) && !is_full_run()) continue;
      StudyCase one = usual_case(plan, 0.02, tilt_deg);
      one.food = food.name;
      const CaseResult usual = judged(plan, one);
      for (const StudyCase& repeat : list_repeats(one)) {
        const CaseResult again = judged(plan, repeat);
        EXPECT_EQ(again.verdict, usual.verdict) << case_key(repeat);
        if (usual.first_spill_s && again.first_spill_s) {
          EXPECT_NEAR(*again.first_spill_s / *usual.first_spill_s, 1.0, 0.1) << case_key(repeat);
        }
        if (!food.body.material.plastic) {
          EXPECT_NEAR(again.outside_kg / again.food_kg,
                      usual.verdict == Verdict::leaves ? again.outside_kg / again.food_kg
                                                       : usual.outside_kg / usual.food_kg,
                      0.03)
              << case_key(repeat);
        }
      }
    }
  }
}

// The wall of this bowl is half a millimetre thick, under a fifth of a cell of the food (2.8 mm). It holds
// the food as a thicker wall does.
TEST(StudyCase, HoldsFoodOnARimThinnerThanAFifthOfACell) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Workplace place;
  std::vector<CaseResult> results;
  for (const char* const rim : {"0.5mm", "2mm"}) {
    ASSERT_EQ(run({"new", "bowl", "--length", "60mm", "--width", "40mm", "--depth", "8mm", "--rim", rim,
                   "--out", place.text("bowl.json"), "--force"})
                  .code,
              exit_done);
    const StudyPlan plan = plan_of(place.text("bowl.json"));
    for (const double tilt_deg : {20.0, 28.0}) {
      results.push_back(judged(plan, usual_case(plan, 0.1, tilt_deg)));
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(results[k].verdict, results[k + 2].verdict) << k;
    if (results[k].verdict == Verdict::leaves) continue;
    EXPECT_NEAR(results[k].margin_m, results[k + 2].margin_m, 0.002) << k;
  }
  EXPECT_EQ(results[0].verdict, Verdict::holds);
  EXPECT_EQ(results[1].verdict, Verdict::leaves);
}

// A shallow, slippery bowl that dips at its front when the spoon is straight, with food laid in after the
// tilt.
TEST(StudyCase, ReproducesTheClaimOfThePaper) {
  const StudyPlan plan = plan_of(spoon_folder + "spoon-original.json");
  const std::vector<StudySeries> all = list_series(plan);
  const auto claim =
      std::find_if(all.begin(), all.end(), [](const StudySeries& one) { return one.is_for_claim; });
  ASSERT_NE(claim, all.end());
  const CaseResult straight = judged(plan, case_at(*claim, 0.0)),
                   lifted = judged(plan, case_at(*claim, 10.0)), steep = judged(plan, case_at(*claim, 20.0));
  EXPECT_EQ(straight.verdict, Verdict::leaves);
  EXPECT_EQ(straight.side, RimSide::front);
  EXPECT_EQ(lifted.verdict, Verdict::holds);
  EXPECT_EQ(steep.verdict, Verdict::leaves);
  EXPECT_EQ(steep.side, RimSide::back);
}

TEST(StudyCase, IsNotJudgedIfTheFoodIsALiquid) {
  StudyPlan plan = plan_of(spoon_folder + "spoon-original.json");
  plan.foods[1].body.material.yield_strain = 0.001;
  StudyCase one = usual_case(plan, 0.1, 0.0);
  one.food = plan.foods[1].name;
  EXPECT_NE(run_case(plan, one)->failure, "");
}

std::string content(const std::filesystem::path& file) {
  auto text = read_file(file, std::size_t{1} << 26);
  EXPECT_TRUE(text.ok()) << file;
  return text.ok() ? text.value() : "";
}

// A study that is killed goes on, and its files are those of a study that was not, whatever the number of
// workers.
TEST(Study, GoesOnAfterItWasKilled) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Workplace place;
  place.write("study.json", R"({"spoonbill_study": 1, "tilts_deg": [0, 12], "frictions": [0.1],
      "vary": {"helping": [0.9]}, "claim": false, "repeats": false, "frames_deg": [],
      "foods": [{"name": "gelatin", "material": "gelatin-20-1", "size_mm": [24, 12, 20]}]})");
  const auto arguments = [&](const std::string& out, const std::string& workers) {
    return std::vector<std::string>{"study",     spoon_folder + "spoon-bowl.json",
                                    "--file",    place.text("study.json"),
                                    "--out",     place.text(out),
                                    "--workers", workers};
  };
  const Outcome whole = run_process(SPOONBILL_PROGRAM, arguments("whole", "2"));
  ASSERT_EQ(whole.code, exit_done) << whole.err;
  // The line that identifies the plan has about a thousand bytes, and each case about six hundred.
  run_and_kill(SPOONBILL_PROGRAM, arguments("killed", "1"), place.path("killed") / "cases.jsonl.part", 1700);
  EXPECT_FALSE(std::filesystem::exists(place.path("killed") / "cases.jsonl"));
  const Outcome again = run_process(SPOONBILL_PROGRAM, arguments("killed", "1"));
  ASSERT_EQ(again.code, exit_done) << again.err;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(place.path("whole"))) {
    EXPECT_EQ(content(entry.path()), content(place.path("killed") / entry.path().filename())) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 4);  // study.html, study.json, cases.csv and cases.jsonl
  // Known cases are not run again: a number of nodes that no trial has stays.
  std::string known = content(place.path("whole") / "cases.jsonl");
  const std::string nodes = "\"nodes\":";
  known.replace(known.find(nodes) + nodes.size(), 1, "7");
  place.write("whole/cases.jsonl", known);
  EXPECT_EQ(run_process(SPOONBILL_PROGRAM, arguments("whole", "2")).code, exit_done);
  EXPECT_EQ(content(place.path("whole") / "cases.jsonl"), known);
  const Json report = json_of(content(place.path("whole") / "study.json"));
  EXPECT_EQ(report["cases"], 4);
  EXPECT_TRUE(report["failures"].empty());
}

// The regions, the hand and the motion of a spoon's document play no part in a study.
TEST(StudyCase, TakesASpoonWithRegionsAndAHand) {
  const Workplace place;
  Document document = read_document(spoon_folder + "spoon-rough.json").value();
  ASSERT_FALSE(document.scene.bodies[0].regions.empty());
  const StudyPlan rough = plan_of(spoon_folder + "spoon-rough.json");
  EXPECT_EQ(judged(rough, usual_case(rough, 0.1, 0.0)).verdict, Verdict::holds);
  document.scene.bodies[0].regions.clear();
  document.scene.bodies[0].kind = BodyKind::rigid;
  document.scene.bodies[0].hand = HandSpring();
  ASSERT_TRUE(write_document(document, place.path("held.json")).ok());
  const StudyPlan held = plan_of(place.text("held.json"));
  EXPECT_EQ(judged(held, usual_case(held, 0.1, 0.0)).verdict, Verdict::holds);
}

TEST(Study, RefusesWrongUseInOneLine) {
  const Workplace place;
  const std::string out = place.text("out");
  EXPECT_TRUE(is_clean_failure(run({"study", spoon_folder + "spoon-handle.json", "--out", out})));
  EXPECT_TRUE(is_clean_failure(run({"study", spoon_folder + "spoon-original.json"})));
  const std::filesystem::path file = place.write("study.json", R"({"spoonbill_study": 1, "tilts_deg": []})");
  EXPECT_TRUE(is_clean_failure(
      run({"study", spoon_folder + "spoon-original.json", "--file", file.string(), "--out", out})));
  EXPECT_FALSE(std::filesystem::exists(out));
  // A study file that the report would write over.
  std::filesystem::create_directories(out);
  const std::string own =
      place
          .write("out/study.json", R"({"spoonbill_study": 1, "tilts_deg": [0], "frictions": [1],
      "vary": {}, "claim": false, "frames_deg": []})")
          .string();
  EXPECT_TRUE(
      is_clean_failure(run({"study", spoon_folder + "spoon-original.json", "--file", own, "--out", out})));
  EXPECT_EQ(
      run({"study", spoon_folder + "spoon-original.json", "--out", out, "--part", "1/2", "--slurm"}).code,
      exit_wrong_use);
  EXPECT_EQ(run({"study", spoon_folder + "spoon-original.json", "--out", out, "--part", "3/2"}).code,
            exit_wrong_use);
}

}  // namespace
}  // namespace spoonbill
