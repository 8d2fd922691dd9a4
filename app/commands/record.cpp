#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/documents.h"
#include "app/live/performance.h"
#include "app/report/document_facts.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "app/session/lockstep.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"
#include "engine/scene/tool.h"
#include "haptic/recording_lines.h"
#include "haptic/script.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

struct RecordOptions {
  OutputOptions how;
  std::filesystem::path source;
  std::filesystem::path out;
  InstructionSet instruction_set = best_instruction_set();
  bool live = false;
  bool draw = false;
  bool json = false;
};

constexpr std::uint64_t ticks_between_checks = 10;  // ticks between progress updates and checks for Ctrl+C

Error stopped_recording(std::uint64_t ticks, const std::filesystem::path& file) {
  return Error{ErrorCode::cancelled, "stopped after " + std::to_string(ticks) + " ticks; the recording is " +
                                         file.string() + ", which can be replayed up to that tick"};
}

Status run_recording(Lockstep& lockstep, Session& session, const std::filesystem::path& file,
                     Console& console) {
  InterruptWatch interrupt;
  ProgressBar progress(console, "Recording", false);
  while (lockstep.tick() < lockstep.tick_count()) {
    if (Status ran = lockstep.run_to(lockstep.tick() + ticks_between_checks); !ran) return ran;
    session.marks.clear();  // discards requests for files, because only a replay writes them
    progress.show(lockstep.tick(), lockstep.tick_count());
    if (!interrupt.requested()) continue;
    interrupt.answer();
    return stopped_recording(lockstep.tick(), file);
  }
  return lockstep.finish();
}

// Records one session. `model` names the document's file in messages.
Status record_input(const RecordOptions& options, const RecordingHeader& header, const std::string& model,
                    LockstepInput input, Console& console) {
  if (Status checked = check_commands(input.commands); !checked) return checked;
  auto session = [&] {
    MapProgress maps(console);
    return Session::make(header.document, model, header.device, options.instruction_set, maps.watch());
  }();
  if (!session) return session.error();
  for (const std::string& note : session->simulation.warnings()) console.err << note << '\n';
  auto writer = RecordingWriter::create(options.out, header, options.how);
  if (!writer) return writer.error();
  if (!writer->notice().empty()) console.err << "spoonbill: " << writer->notice() << '\n';
  const std::size_t command_count = input.commands.size();
  session->keeps_documents = false;  // documents are written only by a replay
  Lockstep lockstep(session.value(), std::move(input), &writer.value());
  if (Status ran = run_recording(lockstep, session.value(), writer->written_file(), console); !ran)
    return ran;
  if (Status committed = writer->commit(); !committed) return committed;

  FactSheet facts;
  const double duration_s = tick_s * static_cast<double>(lockstep.tick());
  const std::string hash = hash_text(state_hash(session.value()));
  facts.add("Recording", options.out.string(), "out", options.out.string());
  facts.add("Ticks", std::to_string(lockstep.tick()) + " (" + number_text(duration_s) + " s)", "ticks",
            lockstep.tick());
  facts.add("", "", "duration_s", duration_s);
  facts.add("Commands", std::to_string(command_count), "commands", command_count);
  facts.add("State hash", hash, "state_hash", hash);
  facts.print(console.out, options.json);
  return {};
}

std::string microseconds_text(double seconds) {
  return number_text(std::round(1e6 * seconds)) + " us";
}

void add_loop_facts(const LoopFigures& loop, FactSheet& facts) {
  facts.add("Ticks", std::to_string(loop.ticks) + ", including those before and after the recording", "ticks",
            loop.ticks);
  facts.add("Missed", std::to_string(loop.missed), "missed", loop.missed);
  facts.add("", "", "late", loop.late);
  facts.add("Lateness",
            microseconds_text(loop.lateness_p50_s) + " median, " + microseconds_text(loop.lateness_p99_s) +
                " at 99 %, " + microseconds_text(loop.lateness_p999_s) + " at 99.9 %",
            "lateness_p99_s", loop.lateness_p99_s);
  facts.add("", "", "lateness_p50_s", loop.lateness_p50_s);
  facts.add("", "", "lateness_p999_s", loop.lateness_p999_s);
  facts.add("Work",
            microseconds_text(loop.work_mean_s) + " mean, " + microseconds_text(loop.work_p99_s) + " at 99 %",
            "work_p99_s", loop.work_p99_s);
  facts.add("", "", "work_mean_s", loop.work_mean_s);
  facts.add("Scheduling", loop.fifo ? "real-time" : "ordinary", "fifo", loop.fifo);
}

Status record_live(const RecordOptions& options, const Script& script, const Document& document,
                   Console& console) {
  if (Status checked = check_commands(script.commands); !checked) return checked;
  PerformanceSettings settings;
  settings.live.instruction_set = options.instruction_set;
  settings.draw = options.draw;
  settings.recording = options.out;
  settings.output = options.how;
  InterruptWatch interrupt;
  const auto report = perform(script, document, script.model_file.string(), settings,
                              [&interrupt] { return interrupt.requested(); });
  const bool stopped = interrupt.requested();
  if (stopped) interrupt.answer();
  if (!report) return report.error();
  for (const Notice& notice : report->notices) console.err << "spoonbill: " << notice.text << '\n';
  if (stopped) return stopped_recording(report->loop.ticks, options.out.string() + ".part");
  FactSheet facts;
  facts.add("Recording", options.out.string(), "out", options.out.string());
  facts.add("Recorded",
            std::to_string(report->recorded.ticks) + " ticks, " + std::to_string(report->recorded.missed) +
                " missed meanwhile",
            "recorded_ticks", report->recorded.ticks);
  facts.add("", "", "recorded_missed", report->recorded.missed);
  add_loop_facts(report->loop, facts);
  if (options.draw) facts.add("Frames", std::to_string(report->frames), "frames", report->frames);
  facts.print(console.out, options.json);
  return {};
}

Status record_script(const RecordOptions& options, Console& console) {
  const auto script = read_script(options.source);
  if (!script) return script.error();
  std::error_code ignored;
  if (std::filesystem::equivalent(script->model_file, options.out, ignored)) {
    return Error{ErrorCode::inconsistent,
                 options.out.string() + ": is the model of the script; choose another name", "--out"};
  }
  auto document = read_document(script->model_file);
  if (!document) return document.error();
  if (options.live) return record_live(options, script.value(), document.value(), console);
  auto device = ScriptedDevice::make(script.value());
  if (!device) return device.error().in(options.source.string());
  LockstepInput input;
  input.device = &device.value();
  input.tick_count = script->tick_count();
  input.commands = script->commands;
  input.source = options.source.string();
  input.refines = true;
  return record_input(options, {device->specification(), std::move(document).value()},
                      script->model_file.string(), std::move(input), console);
}

// Makes a new recording from the device readings of a recording. The new recording has the state hashes of
// this version of the program.
Status record_again(const RecordOptions& options, Console& console) {
  const auto recording = read_recording(options.source);
  if (!recording) return recording.error();
  if (!recording->notice.empty()) console.err << "spoonbill: " << one_line(recording->notice) << '\n';
  if (recording->header.training) {
    return Error{ErrorCode::unsupported,
                 options.source.string() +
                     ": is of a task; use `spoonbill train` with "
                     "--recording and --rerecord",
                 "training"};
  }
  PlaybackDevice device(recording->header.device, recording->readings);
  LockstepInput input;
  input.device = &device;
  input.tick_count = recording->readings.size();
  input.commands = recording->commands;
  input.missed = recording->missed;
  input.source = options.source.string();
  return record_input(options, recording->header, options.source.string(), std::move(input), console);
}

Status record_source(const RecordOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  if (Status native = check_native_name(options.source); !native) return native;
  const auto format = find_native_format(options.source);
  if (!format) return format.error();
  if (Status checked = check_is_not_source(options.out, options.source, "--out"); !checked) return checked;
  if (format.value() == FileFormat::script) return record_script(options, console);
  if (options.live) {
    return Error{ErrorCode::unsupported,
                 options.source.string() + ": only a script can be performed live; remove --live", "--live"};
  }
  if (format.value() == FileFormat::recording) return record_again(options, console);
  return Error{ErrorCode::unsupported, options.source.string() + ": is neither a script nor a recording"};
}

std::string list_tool_actions() {
  std::string lines;
  for (const ToolActionRow& row : tool_actions) {
    std::string name = row.name;
    name.resize(std::max<std::size_t>(name.size() + 1, 10), ' ');
    lines += "  " + name + row.help + "\n";
  }
  return lines;
}

}  // namespace

CommandEntry add_record(OptionSet root) {
  auto options = std::make_shared<RecordOptions>();
  const OptionSet parser =
      root.add_command("record", "Perform a script of tool motions on its model and record it");
  parser.set_footer(
      "A simulated hand of known mass and stiffness follows the script and reacts to the material's force;\n"
      "its path is recorded tick by tick, with the model. If SOURCE is a recording, its path is kept and\n"
      "its states are computed by this version: do this if `replay` reports that another version made it.\n"
      "Tool actions, the \"action\" of a script's `set_tool`:\n" +
      list_tool_actions() +
      "Example: spoonbill record assets/recordings/spoon-handle-bend.script.json --out bend.recording.jsonl");
  parser.add_option("SOURCE", options->source, "Script (.json) or recording").require();
  parser.add_option("--out", options->out, "Recording to write").require();
  add_force_option(parser, options->how);
  CommandOption live = parser.add_flag(
      "--live", options->live, "Perform the script in real time on the 1 kHz thread, and report its timing");
  parser.add_flag("--draw", options->draw, "Also draw 60 frames per second into memory").need(live);
  add_instruction_set_option(parser, options->instruction_set);
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return record_source(*options, console); }};
}

}  // namespace spoonbill
