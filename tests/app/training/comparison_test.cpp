// Tests the comparison of spoons by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "app/program.h"
#include "app/report/comparison_page.h"
#include "app/session/task_comparison.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

const std::filesystem::path assets = SPOONBILL_ASSETS;

// A carry over 15 mm, and its script of half a second.
struct ShortCarry {
  ShortCarry() {
    std::ifstream file(assets / "tasks/carry.json");
    Json json = Json::parse(file);
    json["spoon"] = (assets / "models/spoon-original.json").string();
    json["mouth_mm"] = {9, 12, 0};
    json["reach_mm"] = 3;
    task = place.write("carry.json", json.dump());
    const Json moved = {
        {"spoonbill_script", 1},
        {"model", (assets / "models/spoon-original.json").string()},
        {"steps",
         {{{"start_mm", {0, 0, 0}}}, {{"move_to_mm", {9, 12, 0}}, {"over_s", 0.4}}, {{"hold_s", 0.4}}}}};
    script = place.write("carry.script.json", moved.dump());
  }
  ComparisonPlan plan() const {
    ComparisonPlan made;
    made.task = task;
    made.script = read_script(script).value();
    made.spoons = {assets / "models/spoon-original.json"};
    return made;
  }

  Workplace place;
  std::string task, script;
};

std::vector<ComparedCell> run_plan(const ComparisonPlan& plan, int workers) {
  auto cells = run_comparison(
      plan, workers, [] { return false; }, [](std::size_t, std::size_t) {});
  EXPECT_TRUE(cells) << cells.error().message;
  return std::move(cells).value();
}

TEST(RateInterval, IsThatOfWilson) {
  // Wilson 1927; for 20 runs as tables of the interval have it.
  const auto expect = [](int successes, double low, double high) {
    const Range<double> rate = find_rate_interval(successes, 20);
    EXPECT_NEAR(rate.low, low, 5e-4);
    EXPECT_NEAR(rate.high, high, 5e-4);
  };
  expect(0, 0.0, 0.1611);
  expect(10, 0.2993, 0.7007);
  expect(20, 0.8389, 1.0);
  EXPECT_EQ(find_rate_interval(0, 0).high, 1.0);
}

ComparedCell make_cell(const std::string& spoon, const std::string& hand, int successes, int runs) {
  ComparedCell cell;
  cell.spoon = spoon;
  cell.hand = hand;
  cell.is_random = runs > 1;
  for (int k = 0; k < runs; ++k) {
    ComparedRun run;
    run.seed = static_cast<std::uint32_t>(k + 1);
    run.result.end = k < successes ? TaskEnd::success : TaskEnd::lost;
    run.score = k < successes ? 80.0 : 0.0;
    cell.runs.push_back(run);
  }
  return cell;
}

TEST(ComparedCells, VerdictNeedsAnIntervalOnOneSideOfAHalf) {
  EXPECT_EQ(judge(make_cell("a", "b", 1, 1)), CellVerdict::succeeds);
  EXPECT_EQ(judge(make_cell("a", "b", 0, 1)), CellVerdict::fails);
  EXPECT_EQ(judge(make_cell("a", "b", 20, 20)), CellVerdict::succeeds);
  EXPECT_EQ(judge(make_cell("a", "b", 12, 20)), CellVerdict::undecided);
  EXPECT_EQ(judge(make_cell("a", "b", 2, 20)), CellVerdict::fails);
  EXPECT_EQ(judge(make_cell("a", "b", 0, 0)), CellVerdict::unusable);
  const MeanOfRuns score =
      find_mean(make_cell("a", "b", 1, 2), [](const ComparedRun& run) { return run.score; });
  EXPECT_DOUBLE_EQ(score.mean, 40.0);
  EXPECT_NEAR(score.deviation, 56.57, 0.01);
}

// One run that is given up may count for or against the spoon, and does not count in the means.
TEST(ComparedCells, RunThatIsGivenUpWidensTheInterval) {
  ComparedCell cell = make_cell("a", "b", 15, 20);
  EXPECT_EQ(judge(cell), CellVerdict::succeeds);
  cell.runs[0].failure = "the food broke, \"badly\"";
  const Range<double> rate = find_rate_interval(cell);
  EXPECT_DOUBLE_EQ(rate.low, find_rate_interval(14, 20).low);
  EXPECT_DOUBLE_EQ(rate.high, find_rate_interval(15, 20).high);
  EXPECT_EQ(judge(cell), CellVerdict::undecided);
  EXPECT_EQ(cell.result_count(), 19);
  EXPECT_NEAR(find_mean(cell, [](const ComparedRun& run) { return run.score; }).mean, 80.0 * 14 / 19, 1e-9);
  const std::string csv = make_comparison_csv({cell});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 21);
  EXPECT_NE(csv.find("\na,b,0,1,,,,,,,,,,,,\"the food broke, \"\"badly\"\"\"\n"), std::string::npos);
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  // The failure itself has a comma.
  std::istringstream lines(csv);
  std::string head, failed, ended;
  std::getline(lines, head);
  std::getline(lines, failed);
  std::getline(lines, ended);
  EXPECT_EQ(commas(failed), commas(head) + 1);
  EXPECT_EQ(commas(ended), commas(head));
  for (ComparedRun& run : cell.runs) run.failure = "broken";
  EXPECT_EQ(judge(cell), CellVerdict::unusable);
}

TEST(ComparisonPage, StatesTheAnswerEitherWay) {
  std::vector<ComparedCell> cells = {make_cell("straight", "limited wrist", 0, 1),
                                     make_cell("bent", "limited wrist", 1, 1),
                                     make_cell("<b>", "limited wrist", 0, 1)};
  WristAnswer answer = find_wrist_answer("straight", cells);
  EXPECT_TRUE(answer.is_known);
  EXPECT_EQ(answer.straight, CellVerdict::fails);
  EXPECT_EQ(answer.better, std::vector<std::string>{"bent"});
  EXPECT_EQ(answer.is_true, true);
  cells[0] = make_cell("straight", "limited wrist", 1, 1);
  EXPECT_EQ(find_wrist_answer("straight", cells).is_true, false);
  EXPECT_FALSE(find_wrist_answer("other", cells).is_known);
  // A limited wrist that also trembles can leave it open.
  cells[0] = make_cell("straight", "limited wrist", 10, 20);
  EXPECT_EQ(find_wrist_answer("straight", cells).is_true, std::nullopt);
  cells[0] = make_cell("straight", "limited wrist", 0, 20);
  EXPECT_EQ(find_wrist_answer("straight", cells).is_true, true);
  cells[1] = make_cell("bent", "limited wrist", 10, 20);
  EXPECT_EQ(find_wrist_answer("straight", cells).is_true, std::nullopt);
  cells[1] = make_cell("bent", "limited wrist", 2, 20);
  EXPECT_EQ(find_wrist_answer("straight", cells).is_true, false);
  EXPECT_EQ(find_wrist_answer("straight", {cells[0]}).is_true, std::nullopt);
  Task task;
  task.spoon = "straight.json";
  const std::string page = make_comparison_page(task, ComparisonPlan(), cells).value();
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;b&gt;"), std::string::npos);
  for (const char* const foreign : {"<link", " src=", "url("})
    EXPECT_EQ(page.find(foreign), std::string::npos);
}

// Two seeds of a tremor, a spoon without a handle, and the same with one thread and with two.
TEST(Comparison, RunsDependOnTheirSeedsOnly) {
  const ShortCarry carry;
  ComparisonPlan plan = carry.plan();
  plan.spoons.push_back(assets / "models/spoon-bowl.json");
  plan.hands = {assets / "hands/aged.json"};
  plan.seeds = 2;
  const std::vector<ComparedCell> cells = run_plan(plan, 1);
  ASSERT_EQ(cells.size(), 2u);
  ASSERT_EQ(cells[0].runs.size(), 2u);
  EXPECT_NE(cells[0].runs[0].result.path_m, cells[0].runs[1].result.path_m);
  EXPECT_EQ(cells[0].success_count(), 2);
  EXPECT_FALSE(cells[1].failure().empty());
  EXPECT_EQ(judge(cells[1]), CellVerdict::unusable);
  EXPECT_EQ(make_comparison_csv(run_plan(plan, 2)), make_comparison_csv(cells));
}

// A page knows spoons and hands by their names.
TEST(Comparison, StopsWhenAskedAndRefusesTwoOfOneName) {
  const ShortCarry carry;
  const Workplace& place = carry.place;
  ComparisonPlan plan = carry.plan();
  plan.spoons = {assets / "models/spoon-bowl.json"};
  const auto error_of = [&] {
    const auto cells = run_comparison(
        plan, 1, [] { return true; }, [](std::size_t, std::size_t) {});
    return cells ? ErrorCode::internal : cells.error().code;
  };
  plan.hands = {{}};
  EXPECT_EQ(error_of(), ErrorCode::cancelled);
  plan.hands = {{}, place.write("other.json", R"({"spoonbill_hand": 1, "name": "not modelled"})")};
  EXPECT_EQ(error_of(), ErrorCode::duplicate);
  plan.hands = {{}};
  plan.spoons.push_back(place.write("spoon-bowl.json", "{}"));
  EXPECT_EQ(error_of(), ErrorCode::duplicate);
}

TEST(Comparison, CommandWritesItsPageAndItsTable) {
  const ShortCarry carry;
  const std::string out = carry.place.text("out");
  const std::string spoon = (assets / "models/spoon-original.json").string();
  std::vector<std::string> arguments = {
      "compare", carry.task, "--script", carry.script,
      "--spoon", spoon,      "--hand",   (assets / "hands/limited-wrist.json").string(),
      "--out",   out,        "--json"};
  // A table that cannot be replaced is refused before the page is written. Other files of the folder stay.
  std::filesystem::create_directory(out);
  const std::filesystem::path page = carry.place.write("out/comparison.html", "mine");
  const std::filesystem::path notes = carry.place.write("out/notes.txt", "notes");
  std::filesystem::permissions(carry.place.write("out/comparison.csv", "mine"),
                               std::filesystem::perms::owner_read);
  EXPECT_TRUE(is_clean_failure(run(arguments)));
  EXPECT_EQ(std::filesystem::file_size(page), 4u);
  arguments.emplace_back("--force");
  const Outcome outcome = run(arguments);
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json json = json_of(outcome.out);
  EXPECT_EQ(json["cells"].size(), 1u);
  EXPECT_EQ(json["cells"][0]["runs"], 1);
  EXPECT_EQ(json["limited_wrist"]["is_known"], true);
  EXPECT_GT(std::filesystem::file_size(page), 4u);
  EXPECT_EQ(std::filesystem::file_size(notes), 5u);
  EXPECT_EQ(json["cells"][0]["ends"]["success"], json["cells"][0]["successes"]);
  EXPECT_GT(std::filesystem::file_size(out + "/comparison.csv"), 4u);
  EXPECT_GT(json["cells"][0]["time_s_mean"], 0.1);
  EXPECT_GT(json["cells"][0]["wrist_used_mean"], 0.0);
  const std::string palpate = (assets / "tasks/palpate.json").string();
  EXPECT_TRUE(is_clean_failure(run({"compare", palpate, "--script", carry.script, "--out", out})));
  EXPECT_TRUE(is_clean_failure(run({"compare", carry.task, "--script", carry.task, "--out", out})));
  EXPECT_TRUE(is_clean_failure(
      run({"compare", carry.task, "--script", carry.script, "--hand", carry.task, "--out", out})));
  EXPECT_EQ(run({"compare", carry.task, "--out", out}).code, exit_wrong_use);
  EXPECT_EQ(run({"compare", carry.task, "--script", carry.script, "--out", out, "--seeds", "0"}).code,
            exit_wrong_use);
}

}  // namespace
}  // namespace spoonbill
