#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "app/assets_folder.h"
#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/train_log.h"
#include "app/frames/session_frames.h"
#include "app/panel/task_rows.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "app/report/task_facts.h"
#include "app/session/lockstep.h"
#include "app/session/task_goal.h"
#include "app/session/training_session.h"
#include "app/trainer/trainer.h"
#include "engine/exchange/field_reader.h"
#include "haptic/recording_lines.h"
#include "haptic/script.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

struct TrainOptions {
  std::filesystem::path task, spoon, hand, recording, script, rerecord, out, log, page;
  std::string person, forgotten, shown_person;
  FrameOptions frames;
  std::optional<double> severity, guidance;
  std::optional<int> seed;
  InstructionSet instruction_set = best_instruction_set();
  OutputOptions how;
  bool json = false;
};

inline constexpr Range<int> seed_range{0, 1'000'000'000};
constexpr const char* no_hand = "none";

// Performance of a task by a person or a script: the motion of the device.
struct Performance {
  std::optional<Script> script;
  std::optional<Recording> recording;
  std::unique_ptr<Device> device;
  LockstepInput input;
};

Result<Performance> read_script_of_task(const TrainOptions& options) {
  Performance performance;
  auto script = read_task_script(options.script);
  if (!script) return script.error();
  performance.script = std::move(script).value();
  return performance;
}

Result<Performance> read_recording_of_task(const TrainOptions& options) {
  Performance performance;
  auto recording = read_recording(options.recording);
  if (!recording) return recording.error();
  if (!recording->header.training) {
    return Error{ErrorCode::unsupported,
                 options.recording.string() +
                     ": is not of a task; `spoonbill train` makes recordings of tasks "
                     "with --script and --rerecord"};
  }
  performance.recording = std::move(recording).value();
  return performance;
}

// Makes the device that plays the performance. The performance must not move afterwards.
Status start_device(const TrainOptions& options, const Json& identity, Performance& performance) {
  if (performance.script) {
    auto device = ScriptedDevice::make(*performance.script);
    if (!device) return device.error().in(options.script.string());
    performance.device = std::make_unique<ScriptedDevice>(std::move(device).value());
    performance.input.tick_count = performance.script->tick_count();
    performance.input.source = options.script.string();
  } else {
    const Recording& recording = *performance.recording;
    performance.device = std::make_unique<PlaybackDevice>(recording.header.device, recording.readings);
    performance.input.tick_count = recording.readings.size();
    performance.input.commands = recording.commands;
    performance.input.source = options.recording.string();
    // With another spoon or hand, the recording is only what the person asks for.
    if (*recording.header.training == identity) {
      performance.input.expected = recording.checkpoints;
      performance.input.expected_end = recording.end;
    }
  }
  performance.input.device = performance.device.get();
  return {};
}

// Returns the bundled hand of this name; an empty path if the program has no such hand.
std::filesystem::path find_bundled_hand(const std::string& name) {
  std::error_code ignored;
  const auto folder = std::filesystem::path(assets_folder) / "hands";
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const auto hand = read_hand(entry.path());
    if (hand && hand->name == name) return entry.path();
  }
  return {};
}

// Completes a choice with the spoon, the hand, the seed and the guidance with which a recording was made. A
// hand that does not come with the program must be named.
Status complete_by_recording(const TrainOptions& options, const Json& identity, TrainingChoice& choice) {
  FieldReader reader(identity, options.recording.string() + ": training");
  const std::string hand = reader.text("hand"), spoon = reader.text("spoon");
  const double severity = reader.number("severity", severity_range);
  const int seed = reader.integer("seed", seed_range);
  const double guidance = reader.number("guidance", guidance_range);
  if (!reader.status().ok()) return reader.status();
  if (!options.seed) choice.seed = static_cast<std::uint32_t>(seed);
  if (!options.guidance) choice.guidance = guidance;
  const auto file = std::filesystem::path(assets_folder) / "models" / (spoon + ".json");
  const bool is_plain_name = !spoon.empty() && spoon.find('/') == std::string::npos;
  std::error_code ignored;
  if (options.spoon.empty() && is_plain_name && std::filesystem::exists(file, ignored)) choice.spoon = file;
  if (!options.hand.empty() || hand.empty()) return {};
  choice.hand = find_bundled_hand(hand);
  if (!options.severity) choice.severity = severity;
  if (!choice.hand.empty()) return {};
  return Error{ErrorCode::missing,
               options.recording.string() + ": was made with the hand \"" + hand +
                   "\", which does not come with the program; name its file, or none, with --hand",
               "--hand"};
}

// Returns the files and settings of the session. A recording and the model of a script are defaults.
Result<TrainingChoice> choose_setting(const TrainOptions& options, const Performance& performance) {
  TrainingChoice choice;
  choice.task = options.task;
  choice.spoon = options.spoon;
  if (options.hand != no_hand) choice.hand = options.hand;
  choice.severity = options.severity;
  choice.seed = static_cast<std::uint32_t>(options.seed.value_or(1));
  choice.guidance = options.guidance.value_or(0.0);
  if (performance.script) {
    // The script of a palpation names the block.
    const auto task = read_task(options.task);
    if (options.spoon.empty() && task && task->has_spoon()) choice.spoon = performance.script->model_file;
    return choice;
  }
  if (Status completed = complete_by_recording(options, *performance.recording->header.training, choice);
      !completed) {
    return completed.error();
  }
  return choice;
}

void add_names(const TrainingSetting& setting, FactSheet& facts) {
  facts.add("Task", setting.task.name, "task", setting.task.name);
  if (setting.task.has_spoon()) {
    facts.add("Spoon", setting.identity["spoon"].get<std::string>(), "spoon", setting.identity["spoon"]);
  }
  facts.add("Hand", name_of_hand(setting.hand.name), "hand", setting.hand.name);
  facts.add("Guidance", percent_text(setting.guidance), "guidance", setting.guidance);
}

// Shows in the scene what the end of the task reveals.
void show_end(const TrainingSetting& setting, Session& session) {
  SessionFacts facts;
  write_facts(session, facts);
  session.view.goal =
      std::make_shared<const GoalMarks>(make_goal(setting.task, setting.scene, *facts.training));
}

// Runs all ticks; only until the task has ended if `may_stop` is true.
Status run(Lockstep& lockstep, const TaskWatch& watch, bool may_stop, Console& console) {
  InterruptWatch interrupt;
  ProgressBar progress(console, "Training", false);
  while (lockstep.tick() < lockstep.tick_count()) {
    constexpr std::uint64_t ticks_between_checks = 10;
    if (may_stop && watch.has_ended()) return {};
    if (Status ran = lockstep.run_to(lockstep.tick() + ticks_between_checks); !ran) return ran;
    progress.show(lockstep.tick(), lockstep.tick_count());
    if (!interrupt.requested()) continue;
    interrupt.answer();
    return Error{ErrorCode::cancelled, "stopped after " + std::to_string(lockstep.tick()) + " ticks"};
  }
  return lockstep.finish();
}

// Returns the log of the person who trains; empty without one.
Result<std::optional<PersonLog>> find_log(const TrainOptions& options) {
  if (options.person.empty()) return std::optional<PersonLog>();
  auto log = find_person_log(options.person);
  if (!log) return log.error();
  return std::optional(std::move(log).value());
}

Status train(const TrainOptions& options, Console& console) {
  for (const auto& source : {options.task, options.recording, options.script}) {
    if (Status checked = check_is_not_source(options.rerecord, source, "--rerecord"); !checked) {
      return checked;
    }
  }
  const auto log = find_log(options);
  if (!log) return log.error();
  auto performance = options.script.empty() ? read_recording_of_task(options) : read_script_of_task(options);
  if (!performance) return performance.error();
  const auto choice = choose_setting(options, performance.value());
  if (!choice) return choice.error();
  auto setting = read_training_setting(choice.value());
  if (!setting) return setting.error();
  if (Status started = start_device(options, setting->identity, performance.value()); !started) {
    return started;
  }

  const DeviceSpecification device = performance->device->specification();
  auto session =
      make_training_session(setting.value(), options.task.string(), device, options.instruction_set);
  if (!session) return session.error();
  const TaskWatch& watch = *session->watch;
  const auto fill_panel = [&](PanelModel& panel) {
    SessionFacts facts;
    write_facts(session.value(), facts);
    panel.time_s = facts.training->progress.time_s;
    panel.task = make_task_rows(setting->task, setting->hand, *facts.training);
  };
  std::unique_ptr<SessionFrames> frames;
  if (!options.out.empty()) {
    if (Status prepared = prepare_frame_folder(options.out, options.how.replaces_read_only); !prepared) {
      return prepared;
    }
    frames =
        std::make_unique<SessionFrames>(options.out, options.frames.picture_size(), options.frames.every,
                                        find_task_framing(setting->task, session.value()), session.value());
    if (Status drawn = frames->draw(session.value(), fill_panel); !drawn) return drawn;
  }
  bool had_ended = false;
  performance->input.after_tick = [&]() -> Status {
    if (!frames || had_ended) return {};
    had_ended = watch.has_ended();
    if (!had_ended) return frames->draw(session.value(), fill_panel);
    show_end(setting.value(), session.value());
    return frames->draw_end(session.value(), fill_panel);
  };
  std::optional<RecordingWriter> writer;
  if (!options.rerecord.empty()) {
    auto created = RecordingWriter::create(options.rerecord, {device, setting->document(), setting->identity},
                                           options.how);
    if (!created) return created.error();
    writer.emplace(std::move(created).value());
  }
  const bool may_stop = !writer && performance->input.expected.empty();
  Lockstep lockstep(session.value(), std::move(performance->input), writer ? &*writer : nullptr);
  if (Status ran = run(lockstep, watch, may_stop, console); !ran) return ran;
  if (writer) {
    if (Status committed = writer->commit(); !committed) return committed;
  }
  if (frames) {
    if (Status drawn = watch.has_ended() ? Status() : frames->draw_end(session.value(), fill_panel); !drawn) {
      return drawn;
    }
    if (Status finished = frames->finish(); !finished) return finished;
  }
  FactSheet facts;
  add_names(setting.value(), facts);
  add_task_result(setting->task, setting->hand, watch.result(), facts);
  if (frames) {
    facts.add("Frames", std::to_string(frames->count()), "frames", frames->count());
    facts.add("Folder", options.out.string(), "out", options.out.string());
  }
  if (writer) facts.add("Recording", options.rerecord.string(), "rerecord", options.rerecord.string());
  const std::string hash = hash_text(state_hash(session.value()));
  facts.add("State hash", hash, "state_hash", hash);
  facts.print(console.out, options.json);
  if (!log.value()) return {};
  return log_attempt(*log.value(), setting.value(), watch.result(), state_hash(session.value()));
}

// Trains in the window. The result printed at the end is that of the last attempt that ended.
Status train_live(const TrainOptions& options, Console& console) {
  TrainerSettings settings;
  settings.choice = {options.task,
                     options.spoon,
                     options.hand == no_hand ? std::filesystem::path() : options.hand,
                     options.severity,
                     static_cast<std::uint32_t>(options.seed.value_or(1)),
                     options.guidance.value_or(0.0)};
  settings.recording = options.rerecord;
  settings.output = options.how;
  settings.log = options.log;
  settings.instruction_set = options.instruction_set;
  const auto log = find_log(options);
  if (!log) return log.error();
  if (log.value()) {
    settings.log_attempt = [&](const TrainedAttempt& attempt) {
      return log_attempt(*log.value(), attempt.setting, attempt.result, attempt.state_hash);
    };
    // A log that cannot be read leaves the guidance on.
    if (!options.guidance) {
      settings.choose_guidance = [&] {
        const auto strength = choose_guidance(*log.value(), options.task);
        return strength ? strength.value() : 1.0;
      };
    }
  }
  auto trainer = Trainer::make(settings);
  if (!trainer) return trainer.error();
  if (Status ran = trainer.value()->run(); !ran) return ran;
  FactSheet facts;
  facts.add("Attempts", std::to_string(trainer.value()->attempt_count()), "attempts",
            trainer.value()->attempt_count());
  if (const auto& last = trainer.value()->last_attempt()) {
    add_names(last->setting, facts);
    add_task_result(last->setting.task, last->setting.hand, last->result, facts);
    const std::string hash = hash_text(last->state_hash);
    facts.add("State hash", hash, "state_hash", hash);
  }
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_train(OptionSet root) {
  auto options = std::make_shared<TrainOptions>();
  // Tests that control the window from another process set this variable.
  if (const char* log = std::getenv("SPOONBILL_FRAME_LOG")) options->log = log;
  const OptionSet parser =
      root.add_command("train", "Do a task with a spoon and a modelled hand, and score it");
  parser.set_footer(
      "Food lies on a spoon in a hand, or in a dish. Without a recording or a script, a window opens in "
      "which\n"
      "the mouse moves the spoon; F1 shows the keys. Otherwise these say where the bowl shall go;\n"
      "the hand follows as its model lets it: within the range of its wrist, as fast as it can, trembling,\n"
      "with its grip. The same recording can be tried with any spoon and any hand. With those it was made\n"
      "with, its states are verified up to its end; otherwise the run ends with the task.\n"
      "A task succeeds when the food is lifted out of the dish (scoop), the bowl reaches the mouth (carry),\n"
      "is held level (level), or the food has slid off inside the mouth (eat), and nothing was lost over "
      "the\n"
      "rim; or when a finger has marked a lump under the skin of a soft block (palpate). Exit code 0, also "
      "if "
      "it fails.\n"
      "Example: spoonbill train assets/tasks/carry.json --hand assets/hands/limited-wrist.json\n"
      "             --recording assets/recordings/carry.recording.jsonl");
  parser.add_option("TASK", options->task, "Task (.json)");
  parser.add_option("--spoon", options->spoon,
                    "Document of the spoon (.json); default: the script's model, or that of the task");
  const CommandOption hand = parser.add_option(
      "--hand", options->hand,
      "Hand (.json), or none; default: that of the recording, or one that does all that is asked");
  parser.add_option("--severity", options->severity, "Severity of the hand; default: that of its file")
      .limit(severity_range)
      .need(hand);
  parser
      .add_option(
          "--seed", options->seed,
          "Number that selects the tremor and the place of a lump; default: that of the recording, or 1")
      .limit(seed_range);
  parser
      .add_option(
          "--guidance", options->guidance,
          "Strength of a force toward the task's path, from 0 to 1; default: that of the recording, or 0")
      .limit(guidance_range);
  const CommandOption recording =
      parser.add_option("--recording", options->recording, "Recording of a task (.recording.jsonl)");
  const CommandOption script =
      parser.add_option("--script", options->script, "Script of a task (.script.json)");
  recording.exclude(script);
  parser
      .add_option("--person", options->person,
                  "Person in whose log the attempts are kept; in the window, guidance fades with that "
                  "person's scores")
      .show_as("NAME");
  const CommandOption forget =
      parser.add_option("--forget", options->forgotten, "Delete the log of this person").show_as("NAME");
  parser.add_option("--progress", options->shown_person, "List the attempts in the log of this person")
      .show_as("NAME")
      .exclude(forget);
  parser.add_option("--page", options->page, "Page (.html) for the scores of --progress; default: none")
      .show_as("FILE");
  parser.add_option("--rerecord", options->rerecord, "File for a recording of this session; default: none");
  parser
      .add_option("--out", options->out,
                  "Folder for frame-####.png, the last of which shows the end; default: none")
      .show_as("DIR");
  add_frame_options(parser, options->frames);
  add_force_option(parser, options->how);
  add_instruction_set_option(parser, options->instruction_set);
  add_json_option(parser, options->json);
  parser.set_final_check([options]() -> Status {
    const bool has_task = !options->task.empty();
    if (!options->forgotten.empty() || !options->shown_person.empty()) {
      if (!has_task && (options->page.empty() || !options->shown_person.empty())) return {};
      return Error{ErrorCode::inconsistent,
                   "give --forget or --progress without a task; --page goes with --progress", "TASK"};
    }
    if (!has_task) return Error{ErrorCode::missing, "TASK is required", "TASK"};
    if (!options->page.empty()) return Error{ErrorCode::missing, "--page needs --progress", "--page"};
    const bool is_live = options->recording.empty() && options->script.empty();
    if (!is_live || options->out.empty()) return {};
    return Error{ErrorCode::missing, "--out needs --recording or --script", "--out"};
  });
  return {parser, [options](Console& console) {
            if (!options->forgotten.empty()) return forget_person(options->forgotten, options->json, console);
            if (!options->shown_person.empty()) {
              return show_progress(options->shown_person, options->page, options->how, options->json,
                                   console);
            }
            const bool is_live = options->recording.empty() && options->script.empty();
            return is_live ? train_live(*options, console) : train(*options, console);
          }};
}

}  // namespace spoonbill
