#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/frames/session_frames.h"
#include "app/report/fact_sheet.h"
#include "app/report/task_facts.h"
#include "app/session/lockstep.h"
#include "app/session/training_session.h"
#include "haptic/recording_lines.h"
#include "haptic/script.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

struct TrainOptions {
  std::filesystem::path task, spoon, hand, recording, script, rerecord, out;
  FrameOptions frames;
  std::optional<double> severity;
  int seed = 1;
  InstructionSet instruction_set = best_instruction_set();
  OutputOptions how;
  bool json = false;
};

inline constexpr Range<int> seed_range{0, 1'000'000'000};

// Performance of a task by a person or a script: the motion of the device.
struct Performance {
  std::optional<Script> script;
  std::optional<Recording> recording;
  std::unique_ptr<Device> device;
  LockstepInput input;
};

Result<Performance> read_script_of_task(const TrainOptions& options) {
  Performance performance;
  auto script = read_script(options.script);
  if (!script) return script.error();
  if (!script->commands.empty()) {
    return Error{ErrorCode::unsupported,
                 script->commands.front().origin + ": a task has no commands; only motions steer it"};
  }
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

// Returns the document of the spoon: the one that is named, or the model of a script; empty for that of the
// task.
std::filesystem::path find_spoon(const TrainOptions& options, const Performance& performance) {
  if (!options.spoon.empty() || !performance.script) return options.spoon;
  return performance.script->model_file;
}

// Returns frames in which the spoon is seen at the start and at the mouth.
std::unique_ptr<SessionFrames> make_frames(const TrainOptions& options, const Task& task,
                                           const Session& session) {
  Snapshot start;
  write_snapshot(session, start);
  Framing framing = find_framing(session.simulation.scene(), start);
  const Box box = framing.box;
  for (const int c : {0, 7}) framing.box.include(box.corner(c) + task.mouth_m);
  return std::make_unique<SessionFrames>(options.out, options.frames.picture_size(), options.frames.every,
                                         framing, session);
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

Status train(const TrainOptions& options, Console& console) {
  for (const auto& source : {options.task, options.recording, options.script}) {
    if (Status checked = check_is_not_source(options.rerecord, source, "--rerecord"); !checked)
      return checked;
  }
  auto performance = options.script.empty() ? read_recording_of_task(options) : read_script_of_task(options);
  if (!performance) return performance.error();
  auto setting = read_training_setting({options.task, find_spoon(options, performance.value()), options.hand,
                                        options.severity, static_cast<std::uint32_t>(options.seed)});
  if (!setting) return setting.error();
  if (Status started = start_device(options, setting->identity, performance.value()); !started)
    return started;

  const DeviceSpecification device = performance->device->specification();
  auto session =
      make_training_session(setting.value(), options.task.string(), device, options.instruction_set);
  if (!session) return session.error();
  const TaskWatch& watch = *session->watch;
  std::unique_ptr<SessionFrames> frames;
  if (!options.out.empty()) {
    if (Status prepared = prepare_frame_folder(options.out, options.how.replaces_read_only); !prepared)
      return prepared;
    frames = make_frames(options, setting->task, session.value());
    if (Status drawn = frames->draw(session.value()); !drawn) return drawn;
  }
  bool had_ended = false;
  performance->input.after_tick = [&]() -> Status {
    if (!frames || had_ended) return {};
    had_ended = watch.has_ended();
    return had_ended ? frames->draw_end(session.value()) : frames->draw(session.value());
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
    if (Status drawn = watch.has_ended() ? Status() : frames->draw_end(session.value()); !drawn) return drawn;
    if (Status finished = frames->finish(); !finished) return finished;
  }
  FactSheet facts;
  facts.add("Task", setting->task.name, "task", setting->task.name);
  facts.add("Spoon", setting->identity["spoon"].get<std::string>(), "spoon", setting->identity["spoon"]);
  facts.add("Hand", setting->hand.name.empty() ? "not modelled" : setting->hand.name, "hand",
            setting->hand.name);
  add_task_result(setting->task, setting->hand, watch.result(), facts);
  if (frames) {
    facts.add("Frames", std::to_string(frames->count()), "frames", frames->count());
    facts.add("Folder", options.out.string(), "out", options.out.string());
  }
  if (writer) facts.add("Recording", options.rerecord.string(), "rerecord", options.rerecord.string());
  const std::string hash = hash_text(state_hash(session.value()));
  facts.add("State hash", hash, "state_hash", hash);
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_train(OptionSet root) {
  auto options = std::make_shared<TrainOptions>();
  const OptionSet parser =
      root.add_command("train", "Do a task with a spoon and a modelled hand, and score it");
  parser.set_footer(
      "Food lies on a spoon in a hand, or in a dish. A recording or a script says where the bowl shall go;\n"
      "the hand follows as its model lets it: within the range of its wrist, as fast as it can, trembling,\n"
      "with its grip. The same recording can be tried with any spoon and any hand. With those it was made\n"
      "with, its states are verified up to its end; otherwise the run ends with the task.\n"
      "A task succeeds when the food is lifted out of the dish (scoop), the bowl reaches the mouth (carry),\n"
      "is held level (level), or the food has slid off inside the mouth (eat), and nothing was lost over "
      "the\n"
      "rim. Exit code 0, also if it fails.\n"
      "Example: spoonbill train assets/tasks/carry.json --hand assets/hands/limited-wrist.json\n"
      "             --recording assets/recordings/carry.recording.jsonl");
  parser.add_option("TASK", options->task, "Task (.json)").require();
  parser.add_option("--spoon", options->spoon,
                    "Document of the spoon (.json); default: the script's model, or that of the task");
  const CommandOption hand =
      parser.add_option("--hand", options->hand, "Hand (.json); default: one that does all that is asked");
  parser.add_option("--severity", options->severity, "Severity of the hand; default: that of its file")
      .limit(severity_range)
      .need(hand);
  parser.add_option("--seed", options->seed, "Number that selects the tremor; default: 1").limit(seed_range);
  const CommandOption recording =
      parser.add_option("--recording", options->recording, "Recording of a task (.recording.jsonl)");
  const CommandOption script =
      parser.add_option("--script", options->script, "Script of a task (.script.json)");
  recording.exclude(script);
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
    if (!options->recording.empty() || !options->script.empty()) return {};
    return Error{ErrorCode::missing, "give --recording or --script", "--recording"};
  });
  return {parser, [options](Console& console) { return train(*options, console); }};
}

}  // namespace spoonbill
