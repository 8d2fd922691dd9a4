#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "app/assets_folder.h"
#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/report/comparison_page.h"
#include "app/report/fact_sheet.h"
#include "app/session/task_comparison.h"
#include "engine/base/file.h"
#include "haptic/script.h"

namespace spoonbill {
namespace {

constexpr const char* comparison_page_name = "comparison.html";
constexpr const char* comparison_table_name = "comparison.csv";

struct CompareOptions {
  std::filesystem::path task, script, out;
  std::vector<std::filesystem::path> spoons, hands;
  int seeds = 20;
  int workers = 0;  // 0: one for each processor
  InstructionSet instruction_set = best_instruction_set();
  OutputOptions how{NamedBy::program, false};
  bool json = false;

  std::vector<std::filesystem::path> outputs() const {
    return {out / comparison_page_name, out / comparison_table_name};
  }
};

// Returns the spoons of the founding paper that come with the program.
std::vector<std::filesystem::path> list_bundled_concepts() {
  std::vector<std::filesystem::path> files;
  for (const char* name : {"original", "bent", "rough", "thick", "grip-bulge", "grip-dent"}) {
    files.push_back(std::filesystem::path(assets_folder) / "models" /
                    ("spoon-" + std::string(name) + ".json"));
  }
  return files;
}

// Returns the hand that is not modelled, then those that come with the program, by name.
std::vector<std::filesystem::path> list_bundled_hands() {
  std::vector<std::filesystem::path> files = {{}};
  std::error_code ignored;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(assets_folder) / "hands", ignored)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<ComparisonPlan> make_comparison_plan(const CompareOptions& options) {
  ComparisonPlan plan;
  auto script = read_task_script(options.script);
  if (!script) return script.error();
  plan.script_file = options.script;
  plan.script = std::move(script).value();
  plan.task = options.task;
  plan.spoons = options.spoons.empty() ? list_bundled_concepts() : options.spoons;
  plan.hands = options.hands.empty() ? list_bundled_hands() : options.hands;
  plan.seeds = options.seeds;
  plan.instruction_set = options.instruction_set;
  return plan;
}

// Refuses outputs that would replace a source, and those that cannot be replaced.
Status check_outputs(const CompareOptions& options) {
  std::vector<std::filesystem::path> sources = {options.task, options.script};
  sources.insert(sources.end(), options.spoons.begin(), options.spoons.end());
  sources.insert(sources.end(), options.hands.begin(), options.hands.end());
  for (const std::filesystem::path& output : options.outputs()) {
    for (const std::filesystem::path& source : sources) {
      if (Status checked = check_is_not_source(output, source, "--out"); !checked) return checked;
    }
    if (Status checked = check_output(output, options.how); !checked) return checked;
  }
  return {};
}

Status compare(const CompareOptions& options, Console& console) {
  if (Status checked = check_outputs(options); !checked) return checked;
  const auto task = read_task(options.task);
  if (!task) return task.error();
  if (!task->has_spoon()) {
    return Error{ErrorCode::unsupported, options.task.string() + ": the task has no spoon to compare",
                 "kind"};
  }
  const auto plan = make_comparison_plan(options);
  if (!plan) return plan.error();
  if (Status made = make_folder(options.out); !made) return made;
  const int processors = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  InterruptWatch interrupt;
  ProgressBar progress(console, "Comparing", false);
  const auto cells = run_comparison(
      plan.value(), options.workers > 0 ? options.workers : processors, [&] { return interrupt.requested(); },
      [&](std::size_t done, std::size_t all) { progress.show(done, all); });
  if (!cells && cells.error().code == ErrorCode::cancelled) {
    interrupt.answer();
    return stopped_before_writing(options.outputs().front());
  }
  if (!cells) return cells.error();
  const auto page = make_comparison_page(task.value(), plan.value(), cells.value());
  if (!page) return page.error();
  const std::filesystem::path page_file = options.out / comparison_page_name;
  if (Status written = write_file(page_file, page.value(), Durability::later, options.how); !written)
    return written;
  if (Status written = write_file(options.out / comparison_table_name, make_comparison_csv(cells.value()),
                                  Durability::later, options.how);
      !written) {
    return written;
  }
  if (Status flushed = flush_to_disk(options.out); !flushed) return flushed;
  const WristAnswer answer = find_wrist_answer(task->spoon.stem().string(), cells.value());
  FactSheet facts;
  facts.add("Task", task->name, "task", task->name);
  for (const ComparedCell& cell : cells.value()) {
    facts.add(cell.spoon + ", " + name_of_hand(cell.hand),
              cell_verdict_names[static_cast<std::size_t>(judge(cell))], "", nullptr);
  }
  facts.add("", "", "cells", comparison_to_json(cells.value()));
  facts.add("Limited wrist", answer.text, "limited_wrist",
            {{"is_known", answer.is_known},
             {"is_true", answer.is_true ? Json(*answer.is_true) : Json()},
             {"straight", cell_verdict_names[static_cast<std::size_t>(answer.straight)]},
             {"succeeds_with", answer.better},
             {"text", answer.text}});
  facts.add("Page", page_file.string(), "out", page_file.string());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_compare(OptionSet root) {
  auto options = std::make_shared<CompareOptions>();
  const OptionSet parser =
      root.add_command("compare", "Do a task with several spoons and hands, and compare them on a page");
  parser.set_footer(
      "Every spoon and every hand get the same wishes from one script. A hand that trembles is tried with\n"
      "several seeds. The page says which spoon does the task in which hand, with the uncertainty of its "
      "rate\n"
      "of successes, and whether a limited wrist does it with the straight spoon and with the others.\n"
      "Example: spoonbill compare assets/tasks/carry.json --script assets/recordings/carry.script.json\n"
      "             --out output/carry");
  parser.add_option("TASK", options->task, "Task (.json)").require();
  parser.add_option("--script", options->script, "Script of the task (.script.json)").require();
  parser.add_option("--spoon", options->spoons,
                    "Documents of spoons (.json); default: the concepts that come with the program");
  parser.add_option("--hand", options->hands,
                    "Hands (.json); default: one that is not modelled, and those that come with the program");
  parser.add_option("--seeds", options->seeds, "Number of runs with a hand that trembles; default: 20")
      .limit(Range<int>{1, 1000});
  parser.add_option("--out", options->out, "Folder for comparison.html and comparison.csv")
      .show_as("DIR")
      .require();
  parser.add_option("--workers", options->workers, "Number of threads; default: that of the processors")
      .limit(Range<int>{1, 256});
  add_force_option(parser, options->how);
  add_instruction_set_option(parser, options->instruction_set);
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return compare(*options, console); }};
}

}  // namespace spoonbill
