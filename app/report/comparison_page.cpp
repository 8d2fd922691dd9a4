#include "app/report/comparison_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/csv_text.h"
#include "app/report/quantity_text.h"
#include "app/study/page_parts.h"
#include "app/training/exact_angles.h"
#include "app/version.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

constexpr const char* limited_wrist = "limited wrist";  // name of the bundled hand

const char* name_verdict(CellVerdict verdict) {
  return cell_verdict_names[static_cast<std::size_t>(verdict)];
}

// Class of the page's style for a verdict.
const char* style_verdict(CellVerdict verdict) {
  constexpr std::array<const char*, 4> classes = {"holds", "leaves", "undecided", "overhangs"};
  return classes[static_cast<std::size_t>(verdict)];
}

std::string rate_text(const ComparedCell& cell) {
  if (cell.result_count() == 0) return cell.failure();
  if (!cell.is_random) return std::to_string(cell.success_count()) + " of 1";
  const int runs = static_cast<int>(cell.runs.size()), given_up = runs - cell.result_count();
  const Range<double> rate = find_rate_interval(cell);
  return std::to_string(cell.success_count()) + " of " + std::to_string(runs) + ", " +
         percent_text(rate.low) + " to " + percent_text(rate.high) +
         (given_up > 0 ? "; " + std::to_string(given_up) + " given up: " + cell.failure() : "");
}

std::size_t count_ends(const ComparedCell& cell, std::size_t end) {
  return static_cast<std::size_t>(std::count_if(cell.runs.begin(), cell.runs.end(), [&](const auto& run) {
    return run.failure.empty() && static_cast<std::size_t>(run.result.end) == end;
  }));
}

// Returns how the runs have ended: "food lost 18, too late 2". Food that has just left the bowl is lost
// before it is below the rim, where its lost part is measured.
std::string ends_text(const ComparedCell& cell) {
  constexpr std::array<const char*, 4> words = {"script too short", "success", "food lost", "too late"};
  static_assert(words.size() == std::size(task_end_names));
  std::string text;
  for (std::size_t end = 0; end < words.size(); ++end) {
    const std::size_t count = count_ends(cell, end);
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(words[end]);
    if (cell.runs.size() > 1) text += " " + std::to_string(count);
  }
  return text;
}

// A measure of a run: its heading and digits on the page, and its name in JSON, where it is in SI units.
struct ComparedMeasure {
  const char* heading;
  const char* field;
  double (*measure)(const ComparedRun&);
  double factor;  // from SI to the unit of the heading
  int decimals;
};

constexpr auto compared_measures = std::to_array<ComparedMeasure>({
    {"score", "score", [](const ComparedRun& run) { return run.score; }, 1.0, 0},
    {"time, s", "time_s", [](const ComparedRun& run) { return run.result.time_s; }, 1.0, 1},
    {"food lost, %", "food_lost_fraction",
     [](const ComparedRun& run) { return run.result.food_lost_fraction; }, 100.0, 1},
    {"largest tilt, °", "largest_tilt_rad",
     [](const ComparedRun& run) { return run.result.largest_tilt_rad; }, 1.0 / degree_rad, 1},
    {"tremor, mm", "tremor_m", [](const ComparedRun& run) { return run.result.tremor_m; }, 1e3, 2},
    {"wrist used, %", "wrist_used", [](const ComparedRun& run) { return run.wrist_used; }, 100.0, 0},
    {"grip used, %", "grip_used", [](const ComparedRun& run) { return run.result.grip_used; }, 100.0, 0},
});

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
    return cell.spoon == spoon && name_of_hand(cell.hand) == hand;
  });
  return found == cells.end() ? nullptr : &*found;
}

std::string matrix_part(const std::vector<ComparedCell>& cells) {
  const auto spoons = list_names(cells, [](const ComparedCell& cell) { return cell.spoon; });
  const auto hands = list_names(cells, [](const ComparedCell& cell) { return name_of_hand(cell.hand); });
  std::string text =
      section("matrix", "Which spoon does the task in which hand") +
      "<p>The rate of successes is that of runs with different tremor, with its 95 % interval "
      "(Wilson 1927). A spoon succeeds or fails if the interval is above or below a half. A run that is "
      "given up might have failed or succeeded; the interval is wide enough for both.</p>\n"
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
      const bool is_certain = !cell->is_random && verdict != CellVerdict::unusable;
      const std::string note = is_certain ? "1 run: nothing in this hand is random" : rate_text(*cell);
      text += std::string("<td class=long><span class=\"badge ") + style_verdict(verdict) + "\">" +
              name_verdict(verdict) + "</span><br><span class=note>" + html(note) + "</span></td>";
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

void add_means(const ComparedCell& cell, PageTable& table) {
  for (const ComparedMeasure& one : compared_measures) {
    if (cell.result_count() == 0) {
      table.text("");
      continue;
    }
    const MeanOfRuns mean = find_mean(cell, one.measure);
    table.number(mean.mean, plus_minus(mean, one.factor, one.decimals));
  }
}

std::vector<std::string> with_measures(std::vector<std::string> headings) {
  for (const ComparedMeasure& one : compared_measures) headings.emplace_back(one.heading);
  return headings;
}

std::string numbers_part(const std::vector<ComparedCell>& cells) {
  PageTable table("cells", with_measures({"spoon", "hand", "verdict", "successes", "ends"}));
  for (const ComparedCell& cell : cells) {
    table.row().text(cell.spoon).text(name_of_hand(cell.hand)).text(name_verdict(judge(cell)));
    table.long_text(rate_text(cell)).long_text(ends_text(cell));
    add_means(cell, table);
  }
  return section("numbers", "Numbers") +
         "<p>Means over the runs, with their standard deviation. The wrist used is the largest turn as a "
         "part of the wrist's range, and more than 100 % where it presses against its stops. The grip used "
         "is the largest torque as a part of what the grip holds, and more than 100 % where the spoon turns "
         "in the hand. Both are 0 without a limit. The food lost is what is outside the rim and below it "
         "when the run ends; food that has just left the bowl ends the run before that.</p>\n" +
         table.finish() + "</section>\n";
}

std::string wrist_part(const WristAnswer& answer, const std::vector<ComparedCell>& cells) {
  PageTable table("wrist-numbers", with_measures({"spoon", "verdict", "successes", "ends"}));
  bool has_cells = false;
  for (const ComparedCell& cell : cells) {
    if (cell.hand != limited_wrist) continue;
    has_cells = true;
    table.row().text(cell.spoon).text(name_verdict(judge(cell)));
    table.long_text(rate_text(cell)).long_text(ends_text(cell));
    add_means(cell, table);
  }
  return section("wrist", "Does a limited wrist fail with the straight spoon and succeed with another?") +
         "<p>" + html(answer.text) + "</p>\n" + (has_cells ? table.finish() : "") + "</section>\n";
}

std::string method_part_of_comparison(const Task& task, const ComparisonPlan& plan) {
  return section("method", "How it was run") + "<p>Spoonbill " + version_number +
         ". Task: " + html(plan.task.string()) + ", at most " + number_text(task.time_limit_s) +
         " s. Script: " + html(plan.script_file.string()) + ", " +
         decimals_text(1e-3 * static_cast<double>(plan.script.tick_count()), 1) +
         " s. The same target is asked for with every spoon and every hand: where the centre of the rim "
         "shall be, and how the spoon shall be turned since the start, when the bowl is level. A run ends "
         "with the task. A hand that trembles is tried with the seeds 1 to " +
         std::to_string(plan.seeds) +
         "; any other does the same in every run, and is tried once. The score is that of "
         "<code>spoonbill train</code>.</p></section>\n";
}

}  // namespace

WristAnswer find_wrist_answer(const std::string& straight, const std::vector<ComparedCell>& cells) {
  WristAnswer answer;
  const ComparedCell* const cell = find_cell(cells, straight, limited_wrist);
  if (cell == nullptr || judge(*cell) == CellVerdict::unusable) {
    answer.text = "Not known: the comparison has no limited wrist with a straight spoon that can be used.";
    return answer;
  }
  answer.is_known = true;
  answer.straight = judge(*cell);
  std::string worse;
  bool has_failed = false, is_open = answer.straight == CellVerdict::undecided;
  for (const ComparedCell& other : cells) {
    if (other.hand != limited_wrist || other.spoon == straight) continue;
    const CellVerdict verdict = judge(other);
    if (verdict == CellVerdict::succeeds) {
      answer.better.push_back(other.spoon);
      continue;
    }
    has_failed = has_failed || verdict == CellVerdict::fails;
    is_open = is_open || verdict == CellVerdict::undecided;
    worse += (worse.empty() ? "" : ", ") + other.spoon + " (" + name_verdict(verdict) + ")";
  }
  std::string better;
  for (const std::string& name : answer.better) better += (better.empty() ? "" : ", ") + name;
  if (answer.straight == CellVerdict::succeeds) {
    answer.is_true = false;
  } else if (answer.straight == CellVerdict::fails && !answer.better.empty()) {
    answer.is_true = true;
  } else if (has_failed && !is_open) {
    answer.is_true = false;
  }
  answer.text = std::string(!answer.is_true   ? "Not settled"
                            : *answer.is_true ? "Yes"
                                              : "No") +
                ": with the straight spoon " + straight + ", the limited wrist " +
                (answer.straight == CellVerdict::undecided ? "is undecided" : name_verdict(answer.straight)) +
                ". It succeeds with " + (better.empty() ? "none of the others" : better) +
                (worse.empty() ? "." : "; not with " + worse + ".");
  return answer;
}

Result<std::string> make_comparison_page(const Task& task, const ComparisonPlan& plan,
                                         const std::vector<ComparedCell>& cells) {
  const std::string straight = task.spoon.stem().string();
  const WristAnswer answer = find_wrist_answer(straight, cells);
  const std::string body = "<p>" + html(task.note) + "</p>\n" + matrix_part(cells) +
                           wrist_part(answer, cells) + numbers_part(cells) +
                           method_part_of_comparison(task, plan);
  return make_page("Spoons by hand: " + task.name, "Which spoon for which hand: " + task.name, body);
}

std::string make_comparison_csv(const std::vector<ComparedCell>& cells) {
  std::string text =
      "spoon,hand,severity,seed,end,score,time_s,food_lost_fraction,largest_tilt_rad,path_m,smoothness,"
      "tremor_m,wrist_used,grip_used,largest_force_n,failure\n";
  for (const ComparedCell& cell : cells) {
    std::string begin = csv_field(cell.spoon) + "," + csv_field(cell.hand);
    append_csv_number(begin, cell.severity);
    for (const ComparedRun& run : cell.runs) {
      const TaskResult& result = run.result;
      std::string line = begin + "," + std::to_string(run.seed) + ",";
      if (!run.failure.empty()) {
        text += line + ",,,,,,,,,,," + csv_field(run.failure) + "\n";
        continue;
      }
      line += task_end_names[static_cast<std::size_t>(result.end)];
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
    const Range<double> rate = find_rate_interval(cell);
    Json json = {{"spoon", cell.spoon},
                 {"hand", cell.hand},
                 {"severity", cell.severity},
                 {"verdict", name_verdict(judge(cell))},
                 {"runs", runs},
                 {"successes", successes},
                 {"given_up", runs - cell.result_count()},
                 {"success_rate", runs > 0 ? static_cast<double>(successes) / runs : 0.0}};
    for (std::size_t end = 0; end < std::size(task_end_names); ++end) {
      json["ends"][task_end_names[end]] = count_ends(cell, end);
    }
    for (const ComparedMeasure& one : compared_measures) {
      if (cell.result_count() == 0) break;
      const MeanOfRuns mean = find_mean(cell, one.measure);
      json[std::string(one.field) + "_mean"] = mean.mean;
      json[std::string(one.field) + "_deviation"] = mean.deviation;
    }
    if (cell.is_random) json["interval"] = {rate.low, rate.high};
    if (const std::string failure = cell.failure(); !failure.empty()) json["failure"] = failure;
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace spoonbill
