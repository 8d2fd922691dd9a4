#include "app/report/comparison_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/csv_text.h"
#include "app/report/quantity_text.h"
#include "app/study/page_parts.h"
#include "app/training/exact_angles.h"

namespace spoonbill {
namespace {

constexpr const char* limited_wrist = "limited wrist";  // name of the bundled hand

std::string name_hand(const ComparedCell& cell) {
  return cell.hand.empty() ? "not modelled" : cell.hand;
}

const char* name_verdict(CellVerdict verdict) {
  return cell_verdict_names[static_cast<std::size_t>(verdict)];
}

// Class of the page's style for a verdict.
const char* style_verdict(CellVerdict verdict) {
  constexpr std::array<const char*, 4> classes = {"holds", "leaves", "undecided", "overhangs"};
  return classes[static_cast<std::size_t>(verdict)];
}

std::string rate_text(const ComparedCell& cell) {
  if (!cell.failure.empty()) return cell.failure;
  if (!cell.is_random) return "1 run: nothing in this hand is random";
  const int runs = static_cast<int>(cell.runs.size());
  const Range<double> rate = find_rate_interval(cell.success_count(), runs);
  return std::to_string(cell.success_count()) + " of " + std::to_string(runs) + ", " +
         percent_text(rate.low) + " to " + percent_text(rate.high);
}

std::vector<std::string> list_names(const std::vector<ComparedCell>& cells,
                                    const std::function<std::string(const ComparedCell&)>& name) {
  std::vector<std::string> names;
  for (const ComparedCell& cell : cells) {
    if (std::find(names.begin(), names.end(), name(cell)) == names.end()) names.push_back(name(cell));
  }
  return names;
}

const ComparedCell* find_cell(const std::vector<ComparedCell>& cells, const std::string& spoon,
                              const std::string& hand) {
  const auto found = std::find_if(cells.begin(), cells.end(), [&](const ComparedCell& cell) {
    return cell.spoon == spoon && name_hand(cell) == hand;
  });
  return found == cells.end() ? nullptr : &*found;
}

std::string matrix_part(const std::vector<ComparedCell>& cells) {
  const auto spoons = list_names(cells, [](const ComparedCell& cell) { return cell.spoon; });
  const auto hands = list_names(cells, name_hand);
  std::string text =
      section("matrix", "Which spoon does the task in which hand") +
      "<p>The rate of successes is that of runs with different tremor, with its 95 % interval "
      "(Wilson 1927). A spoon succeeds or fails if the interval is above or below a half.</p>\n"
      "<div class=scroll><table><thead><tr><th>hand</th>";
  for (const std::string& spoon : spoons) text += "<th>" + html(spoon) + "</th>";
  text += "</tr></thead><tbody>";
  for (const std::string& hand : hands) {
    text += "<tr><th>" + html(hand) + "</th>";
    for (const std::string& spoon : spoons) {
      const ComparedCell* const cell = find_cell(cells, spoon, hand);
      if (cell == nullptr) {
        text += "<td></td>";
        continue;
      }
      const CellVerdict verdict = judge(*cell);
      text += std::string("<td class=long><span class=\"badge ") + style_verdict(verdict) + "\">" +
              name_verdict(verdict) + "</span><br><span class=note>" + html(rate_text(*cell)) +
              "</span></td>";
    }
    text += "</tr>";
  }
  return text + "</tbody></table></div></section>\n";
}

std::string plus_minus(const MeanOfRuns& mean, double factor, int decimals) {
  std::string text = decimals_text(factor * mean.mean, decimals);
  if (mean.deviation > 0.0) text += " ± " + decimals_text(factor * mean.deviation, decimals);
  return text;
}

std::string numbers_part(const std::vector<ComparedCell>& cells) {
  PageTable table("cells", {"spoon", "hand", "verdict", "successes", "score", "time, s", "food lost, %",
                            "largest tilt, °", "tremor, mm", "wrist used, %", "grip used, %"});
  struct Column {
    double (*measure)(const ComparedRun&);
    double factor;
    int decimals;
  };
  constexpr auto columns = std::to_array<Column>({
      {[](const ComparedRun& run) { return run.score; }, 1.0, 0},
      {[](const ComparedRun& run) { return run.result.time_s; }, 1.0, 1},
      {[](const ComparedRun& run) { return run.result.food_lost_fraction; }, 100.0, 1},
      {[](const ComparedRun& run) { return run.result.largest_tilt_rad; }, 1.0 / degree_rad, 1},
      {[](const ComparedRun& run) { return run.result.tremor_m; }, 1e3, 2},
      {[](const ComparedRun& run) { return run.wrist_used; }, 100.0, 0},
      {[](const ComparedRun& run) { return run.result.grip_used; }, 100.0, 0},
  });
  for (const ComparedCell& cell : cells) {
    table.row().text(cell.spoon).text(name_hand(cell)).text(name_verdict(judge(cell)));
    table.long_text(rate_text(cell));
    for (const Column& column : columns) {
      const MeanOfRuns mean = find_mean(cell, column.measure);
      table.number(mean.mean, cell.runs.empty() ? "" : plus_minus(mean, column.factor, column.decimals));
    }
  }
  return section("numbers", "Numbers") + "<p>Means over the runs, with their standard deviation.</p>\n" +
         table.finish() + "</section>\n";
}

std::string method_part_of_comparison(const Task& task, const ComparisonPlan& plan) {
  return section("method", "How it was run") + "<p>Task: " + html(task.name) + ". " + html(task.note) +
         "</p><p>Every spoon and every hand get the same wishes from one script, of " +
         decimals_text(1e-3 * static_cast<double>(plan.script.tick_count()), 1) +
         " s: where the centre of the rim shall be, and how the spoon shall be turned since the start, when "
         "the "
         "bowl is level. A hand that trembles is tried with the seeds 1 to " +
         std::to_string(plan.seeds) + ".</p></section>\n";
}

}  // namespace

WristAnswer find_wrist_answer(const std::string& straight, const std::vector<ComparedCell>& cells) {
  WristAnswer answer;
  const ComparedCell* const cell = find_cell(cells, straight, limited_wrist);
  if (cell == nullptr || judge(*cell) == CellVerdict::unusable) {
    answer.text = "The comparison has no limited wrist with the straight spoon.";
    return answer;
  }
  answer.is_known = true;
  answer.straight = judge(*cell);
  std::string worse;
  for (const ComparedCell& other : cells) {
    if (other.hand != limited_wrist || other.spoon == straight) continue;
    if (judge(other) == CellVerdict::succeeds) {
      answer.better.push_back(other.spoon);
    } else {
      worse += (worse.empty() ? "" : ", ") + other.spoon + " (" + name_verdict(judge(other)) + ")";
    }
  }
  std::string better;
  for (const std::string& name : answer.better) better += (better.empty() ? "" : ", ") + name;
  const bool is_true = answer.straight == CellVerdict::fails && !answer.better.empty();
  answer.text = std::string(is_true ? "Yes" : "No") + ": with the straight spoon " + straight +
                ", the limited wrist " + name_verdict(answer.straight) + ". It succeeds with " +
                (better.empty() ? "none of the others" : better) +
                (worse.empty() ? "." : "; not with " + worse + ".");
  return answer;
}

Result<std::string> make_comparison_page(const Task& task, const ComparisonPlan& plan,
                                         const std::vector<ComparedCell>& cells) {
  const std::string straight = task.spoon.stem().string();
  const WristAnswer answer = find_wrist_answer(straight, cells);
  std::string body = matrix_part(cells);
  body += section("wrist", "Does a limited wrist fail with the straight spoon and succeed with another?");
  body += "<p>" + html(answer.text) + "</p>\n";
  PageTable table("wrist-numbers", {"spoon", "verdict", "largest tilt, °", "food lost, %", "score"});
  for (const ComparedCell& cell : cells) {
    if (cell.hand != limited_wrist || cell.runs.empty()) continue;
    const ComparedRun& run = cell.runs.front();
    table.row().text(cell.spoon).text(name_verdict(judge(cell)));
    table.number(run.result.largest_tilt_rad / degree_rad, 1)
        .number(100.0 * run.result.food_lost_fraction, 1);
    table.number(run.score, 0);
  }
  body += table.finish() + "</section>\n" + numbers_part(cells) + method_part_of_comparison(task, plan);
  return make_page("Spoons by hand: " + task.name, "Which spoon for which hand: " + task.name, body);
}

std::string make_comparison_csv(const std::vector<ComparedCell>& cells) {
  std::string text =
      "spoon,hand,seed,end,score,time_s,food_lost_fraction,largest_tilt_rad,path_m,smoothness,tremor_m,wrist_"
      "used,"
      "grip_used,largest_force_n,failure\n";
  for (const ComparedCell& cell : cells) {
    const std::string begin = csv_field(cell.spoon) + "," + csv_field(cell.hand);
    if (!cell.failure.empty()) text += begin + ",,,,,,,,,,,,," + csv_field(cell.failure) + "\n";
    for (const ComparedRun& run : cell.runs) {
      const TaskResult& result = run.result;
      std::string line =
          begin + "," + std::to_string(run.seed) + "," + task_end_names[static_cast<std::size_t>(result.end)];
      for (const double number :
           {run.score, result.time_s, result.food_lost_fraction, result.largest_tilt_rad, result.path_m,
            result.smoothness, result.tremor_m, run.wrist_used, result.grip_used, result.largest_force_n}) {
        append_csv_number(line, number);
      }
      text += line + ",\n";
    }
  }
  return text;
}

Json comparison_to_json(const std::vector<ComparedCell>& cells) {
  Json all = Json::array();
  for (const ComparedCell& cell : cells) {
    const int runs = static_cast<int>(cell.runs.size()), successes = cell.success_count();
    const Range<double> rate = find_rate_interval(successes, runs);
    const MeanOfRuns score = find_mean(cell, [](const ComparedRun& run) { return run.score; });
    Json json = {{"spoon", cell.spoon},
                 {"hand", cell.hand},
                 {"severity", cell.severity},
                 {"verdict", name_verdict(judge(cell))},
                 {"runs", runs},
                 {"successes", successes},
                 {"success_rate", runs > 0 ? static_cast<double>(successes) / runs : 0.0},
                 {"score_mean", score.mean},
                 {"score_deviation", score.deviation}};
    if (cell.is_random) json["interval"] = {rate.low, rate.high};
    if (!cell.failure.empty()) json["failure"] = cell.failure;
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace spoonbill
