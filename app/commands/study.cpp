#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "app/study/case_crew.h"
#include "app/study/case_file.h"
#include "app/study/case_trial.h"
#include "app/study/next_cases.h"
#include "app/study/sampled_cases.h"
#include "app/study/slurm.h"
#include "app/study/study_page.h"
#include "app/study/study_parts.h"
#include "app/study/study_pictures.h"
#include "app/study/study_plan.h"
#include "app/study/study_summary.h"
#include "app/study/study_tables.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

constexpr Range<int> worker_range{1, 256};
// A task of Slurm then takes about a minute.
constexpr std::size_t cases_a_task = 24;

struct StudyOptions {
  std::vector<std::filesystem::path> spoons;
  std::filesystem::path file, out;
  int workers = 0;  // 0: one for each processor
  StudyChoices choices;
  std::optional<StudyPart> part;
  bool on_slurm = false;
  bool merges_only = false;
  bool restarts = false;
  bool progress = false;
  bool json = false;
};

Error stopped_study(const std::filesystem::path& out, std::size_t cases) {
  return {ErrorCode::cancelled, "stopped after " + std::to_string(cases) + " cases, which are kept in " +
                                    out.string() + "; the same command goes on from there"};
}

int count_workers(const StudyOptions& options) {
  const int processors = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return options.workers > 0 ? options.workers : processors;
}

Result<StudyPart> parse_part(const std::string& text) {
  StudyPart part;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, part.number);
  if (number.ec == std::errc() && number.ptr != end && *number.ptr == '/') {
    const auto count = std::from_chars(number.ptr + 1, end, part.count);
    if (count.ec == std::errc() && count.ptr == end && part_count_range.contains(part.count) &&
        Range<int>{1, part.count}.contains(part.number)) {
      return part;
    }
  }
  return Error{ErrorCode::malformed, "must be NUMBER/COUNT, such as 3/40"};
}

// Returns the program with the arguments of this study, as a task on another machine runs it.
std::vector<std::string> task_command(const StudyOptions& options) {
  std::error_code ignored;
  std::vector<std::string> command{std::filesystem::read_symlink("/proc/self/exe", ignored).string(),
                                   "study"};
  for (const std::filesystem::path& spoon : options.spoons) {
    command.push_back(std::filesystem::absolute(spoon).string());
  }
  if (!options.file.empty()) {
    command.insert(command.end(), {"--file", std::filesystem::absolute(options.file).string()});
  }
  if (options.choices.is_full_grid) {
    command.insert(command.end(), {"--grid", *options.choices.is_full_grid ? "full" : "one_at_a_time"});
  }
  if (options.choices.sensitivity_count > 0) {
    command.insert(command.end(), {"--sensitivity", std::to_string(options.choices.sensitivity_count)});
  }
  command.insert(command.end(), {"--out", std::filesystem::absolute(options.out).string(), "--workers", "1"});
  return command;
}

// Runs rounds of cases as tasks of Slurm until none is needed.
Status run_all_on_slurm(const StudyOptions& options, const StudyPlan& plan, CaseFile& file,
                        const InterruptWatch& interrupt, Console& console) {
  for (int round = 1;; ++round) {
    // Parts that an earlier run of this command has left.
    if (auto merged = merge_parts(options.out, plan, file); !merged) return merged.error();
    const std::vector<StudyCase> cases = find_next_cases(plan, file.results());
    if (cases.empty()) return {};
    SlurmJob job{task_command(options), options.out, 1};
    job.count = static_cast<int>((cases.size() + cases_a_task - 1) / cases_a_task);
    ProgressBar bar(console,
                    "Round " + std::to_string(round) + ", " + std::to_string(cases.size()) + " cases",
                    options.progress);
    const auto show = [&](int done) {
      bar.show(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(job.count));
    };
    if (Status ran = run_on_slurm(job, show, [&] { return interrupt.requested(); }); !ran) return ran;
    const auto merged = merge_parts(options.out, plan, file);
    if (!merged) return merged.error();
    if (merged.value() == 0) {
      return Error{ErrorCode::internal, "the tasks did none of the cases that are needed; use --restart"};
    }
  }
}

// Runs rounds of cases until none is needed.
Status run_all_cases(const StudyOptions& options, const StudyPlan& plan, CaseFile& file,
                     const InterruptWatch& interrupt, Console& console) {
  // Parts that tasks have done by this command's --part.
  if (auto merged = merge_parts(options.out, plan, file); !merged) return merged.error();
  const int workers = count_workers(options);
  for (int round = 1;; ++round) {
    const std::vector<StudyCase> cases = find_next_cases(plan, file.results());
    if (cases.empty()) return {};
    ProgressBar bar(console,
                    "Round " + std::to_string(round) + ", " + std::to_string(cases.size()) + " cases",
                    options.progress);
    std::uint64_t done = 0;
    const auto receive = [&](const StudyCase& study_case, const CaseResult& result) {
      bar.show(++done, cases.size());
      if (Status added = file.add(study_case, result); !added) return added;
      return file.flush();
    };
    if (Status ran = run_cases(plan, cases, workers, receive, [&] { return interrupt.requested(); }); !ran) {
      return ran;
    }
  }
}

// Prints how many cases the sensitivity analysis has and about how long they take, from the time of one in
// the centre of its ranges. Prints nothing once they are done.
Status announce_sensitivity(const StudyOptions& options, const StudyPlan& plan, const CaseFile& file,
                            const InterruptWatch& interrupt, Console& console) {
  const std::size_t count = plan.sensitivity.count, factors = plan.sensitivity.ranges.size();
  const SensitivityCases cases = list_sensitivity_cases(plan);
  if (find_result(cases.mixed.back().back(), file.results())) return {};
  StudyCase usual = cases.a.front();
  for (const FactorRange& one : plan.sensitivity.ranges) {
    factor_of(usual, one.factor) = 0.5 * (one.range.low + one.range.high);
  }
  const auto start = std::chrono::steady_clock::now();
  const auto result =
      run_case(plan, usual, [&](const Trial&, const Simulation&) { return !interrupt.requested(); });
  if (!result) return result.error();
  const double case_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::size_t all = count * (factors + 2);
  const int workers = options.on_slurm ? 1 : count_workers(options);
  const double minutes = case_s * static_cast<double>(all) / (60.0 * workers);
  console.err << "spoonbill: the sensitivity analysis has " << count << " x (" << factors << " + 2) = " << all
              << " cases, about " << decimals_text(minutes, minutes < 10.0 ? 1 : 0) << " min"
              << (options.on_slurm ? " on one processor" : "") << '\n';
  return {};
}

Result<std::vector<StudyPicture>> make_pictures(const StudyOptions& options, const StudyPlan& plan,
                                                const InterruptWatch& interrupt, Console& console) {
  std::vector<StudyPicture> pictures;
  const std::vector<StudyCase> cases = list_pictured_cases(plan);
  ProgressBar bar(console, "Drawing", options.progress);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const std::filesystem::path video = options.out / ("video-" + std::to_string(k + 1) + ".mp4");
    auto picture = make_study_picture(plan, cases[k], video, [&] { return interrupt.requested(); });
    bar.show(k + 1, cases.size());
    if (!picture) return picture.error();
    pictures.push_back(std::move(picture).value());
  }
  return pictures;
}

Status write_report(const std::filesystem::path& out, const std::string& page, const Json& content,
                    const std::string& csv, const std::vector<StudyPicture>& pictures) {
  const OutputOptions how{NamedBy::program, false};
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"study.html", page},
                                   {"study.json", content.dump(1) + "\n"},
                                   {"cases.csv", csv}}) {
    if (Status written = write_file(out / name, text, Durability::later, how); !written) return written;
  }
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (pictures[k].png.empty()) continue;
    const std::filesystem::path file = out / ("picture-" + std::to_string(k + 1) + ".png");
    if (Status written = write_file(file, pictures[k].png, Durability::later, how); !written) return written;
  }
  return flush_to_disk(out);
}

void add_facts(FactSheet& facts, const StudyOptions& options, const CaseResults& results,
               const StudySummary& summary, const Json& content) {
  facts.add("Cases", std::to_string(results.size()), "cases", results.size());
  facts.add("", "", "needed", 0);
  facts.add("Not judged", std::to_string(summary.failures.size()), "not_judged", summary.failures.size());
  facts.add("Repeats",
            std::to_string(summary.trust.repeats) + ", " +
                std::to_string(summary.trust.disagreements.size()) + " with another verdict",
            "", nullptr);
  facts.add("", "", "trust", content["trust"]);
  facts.add("", "", "series", content["series"]);
  facts.add("Report", (options.out / "study.html").string(), "report", (options.out / "study.html").string());
}

// Runs the part that --part names.
Status run_own_part(const StudyOptions& options, const StudyPlan& plan, Console& console) {
  InterruptWatch interrupt;
  Status ran = run_part(options.out, plan, *options.part, count_workers(options),
                        [&] { return interrupt.requested(); });
  if (!ran && ran.error().code == ErrorCode::cancelled) interrupt.answer();
  if (!ran) return ran;
  FactSheet facts;
  const std::string file = part_file(options.out, *options.part).string();
  facts.add("Part", file, "part", file);
  facts.print(console.out, options.json);
  return {};
}

// Merges the parts and says how many cases are needed next. Returns true if none is.
Result<bool> merge_and_count(const StudyOptions& options, const StudyPlan& plan, CaseFile& file,
                             Console& console) {
  if (auto merged = merge_parts(options.out, plan, file); !merged) return merged.error();
  const std::size_t needed = find_next_cases(plan, file.results()).size();
  if (needed == 0) return true;
  FactSheet facts;
  facts.add("Cases", std::to_string(file.results().size()), "cases", file.results().size());
  facts.add("Needed next", std::to_string(needed), "needed", needed);
  facts.print(console.out, options.json);
  return false;
}

// Writes the report of all cases.
Status finish(const StudyOptions& options, const StudyPlan& plan, CaseFile& file,
              const std::vector<StudyPicture>& pictures, Console& console) {
  const StudySummary summary = summarise(plan, file.results());
  const Bendings bendings = bend_all(plan, count_workers(options));
  const auto content = study_json(plan, file.results(), summary, bendings);
  if (!content) return content.error();
  const auto page = make_study_page(plan, file.results(), summary, bendings, pictures);
  if (!page) return page.error();
  if (Status written =
          write_report(options.out, page.value(), content.value(), cases_csv(file.results()), pictures);
      !written) {
    return written;
  }
  if (Status finished = file.finish(); !finished) return finished;
  FactSheet facts;
  add_facts(facts, options, file.results(), summary, content.value());
  facts.print(console.out, options.json);
  return {};
}

// Refuses a study that would write over what it reads.
Status check_sources(const StudyOptions& options) {
  std::vector<std::filesystem::path> sources = options.spoons;
  if (!options.file.empty()) sources.push_back(options.file);
  for (const std::filesystem::path& source : sources) {
    for (const char* const name : {"study.html", "study.json", "cases.csv", "cases.jsonl", "slurm-task.sh"}) {
      if (Status checked = check_is_not_source(options.out / name, source, "--out"); !checked) return checked;
    }
  }
  return {};
}

Status study(const StudyOptions& options, Console& console) {
  if (Status checked = check_sources(options); !checked) return checked;
  const auto plan = make_study_plan(options.spoons, options.file, options.choices);
  if (!plan) return plan.error();
  for (const std::string& line : find_large_foods(plan.value())) {
    console.err << "spoonbill: " << one_line(line) << '\n';
  }
  if (Status made = make_folder(options.out); !made) return made;
  if (options.part) return run_own_part(options, plan.value(), console);
  InterruptWatch interrupt;
  auto file = CaseFile::open(options.out, plan_to_json(plan.value()), options.restarts);
  if (!file) return file.error();
  const auto stopped = [&](const Error& error) -> Error {
    if (error.code != ErrorCode::cancelled) return error;
    interrupt.answer();
    return stopped_study(options.out, file->results().size());
  };
  if (options.merges_only) {
    const auto is_complete = merge_and_count(options, plan.value(), file.value(), console);
    if (!is_complete) return is_complete.error();
    if (!is_complete.value()) return {};
  }
  if (plan->sensitivity.count > 0) {
    if (Status said = announce_sensitivity(options, plan.value(), file.value(), interrupt, console); !said) {
      return stopped(said.error());
    }
  }
  const auto run_all = options.on_slurm ? run_all_on_slurm : run_all_cases;
  if (Status ran = run_all(options, plan.value(), file.value(), interrupt, console); !ran) {
    return stopped(ran.error());
  }
  const auto pictures = make_pictures(options, plan.value(), interrupt, console);
  if (!pictures) return stopped(pictures.error());
  return finish(options, plan.value(), file.value(), pictures.value(), console);
}

}  // namespace

CommandEntry add_study(OptionSet root) {
  auto options = std::make_shared<StudyOptions>();
  const OptionSet parser = root.add_command("study", "Find the tilts at which food stays on spoons");
  parser.set_footer(
      "Lays food into the bowl of each spoon, tilts the spoon, and judges: holds, overhangs, leaves, or\n"
      "undecided. Tries tilts from -30 to 30 degrees at three frictions with gelatin that is elastic and\n"
      "gelatin that yields, then halves the steps between different verdicts until they are one degree, and\n"
      "repeats the cases there with half the step and finer cells. Varies the food and the bowl of the\n"
      "first spoon, one thing at a time. A study file can change all of this.\n"
      "Writes study.html, a report that needs no other file; study.json; cases.csv; pictures; and videos\n"
      "if ffmpeg is installed. A study that was stopped goes on when the same command runs again.\n"
      "A spoon is a document with one body that opens upwards; its bowl is found by itself.\n"
      "Example: spoonbill study assets/models/spoon-original.json --out output/study");
  parser.add_option("SPOON", options->spoons, "Documents of spoons (.json)").require();
  parser.add_option("--file", options->file, "Study file (.json): foods, tilts, frictions, variations");
  add_parsed_option(
      parser, "--grid", "WHICH",
      [](const std::string& text) -> Result<bool> {
        if (text == "full" || text == "one_at_a_time") return text == "full";
        return Error{ErrorCode::unknown, "must be full or one_at_a_time"};
      },
      [options](bool is_full) { options->choices.is_full_grid = is_full; },
      "Vary one thing at a time (one_at_a_time), or try all combinations (full) on every spoon");
  parser
      .add_option("--sensitivity", options->choices.sensitivity_count,
                  "Also find what the margin depends on, by Sobol indices of N times (factors + 2) cases")
      .show_as("N")
      .limit(sensitivity_count_range);
  parser.add_option("--out", options->out, "Folder of the report").show_as("DIR").require();
  parser
      .add_option("--workers", options->workers,
                  "Cases run at the same time; default: one for each processor")
      .limit(worker_range);
  const CommandOption slurm = parser.add_flag(
      "--slurm", options->on_slurm, "Run the cases as tasks of Slurm, on machines that share the folder");
  const CommandOption part = add_parsed_option(
      parser, "--part", "NUMBER/COUNT", parse_part,
      [options](const StudyPart& part) { options->part = part; },
      "Run only this part of the cases needed next, and keep it for a run without this option to merge");
  const CommandOption merge = parser.add_flag("--merge", options->merges_only,
                                              "Merge the parts, and stop unless nothing else is needed");
  const CommandOption restart =
      parser.add_flag("--restart", options->restarts, "Remove the cases that the folder has from before");
  part.exclude(slurm).exclude(merge).exclude(restart);
  merge.exclude(slurm).exclude(restart);
  parser.add_flag("--progress", options->progress, "Show progress even if the output is not a terminal");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return study(*options, console); }};
}

}  // namespace spoonbill
