#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/frames/frame_events.h"
#include "app/frames/frame_painter.h"
#include "app/frames/replay_pictures.h"
#include "app/panel/panel.h"
#include "app/report/document_facts.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "app/session/lockstep.h"
#include "app/session/run_log.h"
#include "engine/base/geometry.h"
#include "haptic/recording_lines.h"
#include "haptic/virtual_device.h"
#include "render/gl/context.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

struct ReplayOptions {
  OutputOptions how;
  std::filesystem::path recording;
  std::filesystem::path out;
  FrameOptions frames;
  std::filesystem::path video;
  std::filesystem::path rerecord;
  std::filesystem::path saved;  // document of the last state
  std::filesystem::path log;
  InstructionSet instruction_set = best_instruction_set();
  bool no_frames = false;
  bool progress = false;
  bool json = false;
};

struct Replay {
  const ReplayOptions& options;
  const Recording& recording;
  Session& session;
  Lockstep& lockstep;
  Console& console;
  const RecordingWriter* writer = nullptr;
};

LockstepInput make_lockstep_input(const Recording& recording, PlaybackDevice& device,
                                  const std::string& source) {
  LockstepInput input;
  input.device = &device;
  input.tick_count = recording.readings.size();
  input.commands = recording.commands;
  input.expected = recording.checkpoints;
  input.expected_end = recording.end;
  input.missed = recording.missed;
  input.source = source;
  return input;
}

Error stopped_replay(const Replay& replay, InterruptWatch& interrupt) {
  interrupt.answer();
  std::string text = "stopped after " + std::to_string(replay.lockstep.tick()) + " of " +
                     std::to_string(replay.lockstep.tick_count()) + " ticks";
  if (!replay.options.no_frames) text += "; the frames written so far are complete";
  if (replay.writer != nullptr) {
    text += "; the recording is " + replay.writer->written_file().string() +
            ", which can be replayed up to that tick";
  }
  return Error{ErrorCode::cancelled, text};
}

Status run_without_pictures(const Replay& replay) {
  constexpr std::uint64_t ticks_between_checks = 10;  // ticks between progress updates and checks for Ctrl+C
  replay.session.keeps_documents = false;
  InterruptWatch interrupt;
  ProgressBar progress(replay.console, "Replaying", replay.options.progress);
  Lockstep& lockstep = replay.lockstep;
  while (lockstep.tick() < lockstep.tick_count()) {
    if (interrupt.requested()) return stopped_replay(replay, interrupt);
    if (Status ran = lockstep.run_to(lockstep.tick() + ticks_between_checks); !ran) return ran;
    replay.session.marks.clear();  // discards requests for files, because there is no output folder
    progress.show(lockstep.tick(), lockstep.tick_count());
  }
  return lockstep.finish();
}

PictureRequest make_picture_request(const ReplayOptions& options, const Lockstep& lockstep,
                                    Console& console) {
  PictureRequest request;
  request.size = options.frames.picture_size();
  request.frame_count = frame_count(lockstep.tick_count());
  request.every = options.frames.every;
  if (!options.no_frames) request.folder = options.out;
  request.replaces_read_only = options.how.replaces_read_only;
  if (options.video.empty()) return request;
  if (VideoEncoder::available()) {
    request.video = options.video;
  } else {
    console.err << "spoonbill: no video is made because ffmpeg is not installed\n";
  }
  return request;
}

// Waits for the oldest picture in progress and writes it to its files.
Status write_oldest_frame(PaintingCrew& crew, const PictureRequest& request, ReplayPictures& pictures) {
  auto painted = crew.receive();
  if (!painted) return painted.error();
  for (const std::string& name : painted->extra_names) {
    if (Status written = write_marked_picture(painted->picture, name, *request.folder); !written)
      return written;
  }
  if (!painted->is_frame) return {};
  return pictures.add(painted->frame, std::move(painted->picture));
}

// Runs the replay up to `tick`. Writes each requested document as soon as it is made, which limits the memory
// in use. Adds the names of the requested screenshots to `names`.
Status run_and_save(const Replay& replay, const PictureRequest& request, std::uint64_t tick,
                    const InterruptWatch& interrupt, std::vector<std::string>& names) {
  while (!interrupt.requested()) {
    const std::uint64_t next = std::min(replay.lockstep.tick() + 1, tick);
    if (Status ran = replay.lockstep.run_to(next); !ran) return ran;
    auto more = consume_marks(replay.session, request.folder);
    if (!more) return more.error();
    for (std::string& name : more.value()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
    }
    if (replay.lockstep.tick() >= tick) return {};
  }
  return {};
}

// The facts that a replay needs before it draws its first frame.
struct ReplayPlan {
  double lowest_y_m;              // of the bodies in all frames, because the ground is at one height
  std::vector<SheetFrame> sheet;  // frames of the contact sheet
};

// Makes the plan from a replay of its own. Where this replay fails, the one with pictures fails too, and says
// why.
ReplayPlan plan_replay(const Replay& replay, const PictureRequest& request, const InterruptWatch& interrupt,
                       double lowest_y_m) {
  const Recording& recording = replay.recording;
  auto session =
      Session::make(recording.header.document, "", recording.header.device, replay.options.instruction_set);
  if (!session) return {lowest_y_m, {}};
  session->keeps_documents = false;
  PlaybackDevice device(recording.header.device, recording.readings);
  if (!recording.readings.empty()) session->reading = recording.readings.front();
  Lockstep lockstep(session.value(), make_lockstep_input(recording, device, ""), nullptr);
  Snapshot snapshot;
  FrameEvents events;
  auto command = recording.commands.begin();
  ProgressBar progress(replay.console, "Planning", replay.options.progress);
  for (std::uint64_t frame = 0; frame < request.frame_count && !interrupt.requested();
       frame += request.every) {
    if (!lockstep.run_to(frame_tick(frame))) break;
    session->marks.clear();
    write_snapshot(session.value(), snapshot);
    // The lowest control point is not above its surface.
    if (framed_box(snapshot).low.y() < lowest_y_m)
      lowest_y_m = std::min(lowest_y_m, drawn_bounds(snapshot).low.y());
    std::vector<std::string> names;
    for (; command != recording.commands.end() && command->tick <= lockstep.tick(); ++command) {
      if (!is_view_command(command->command)) names.push_back(command->command.value("command", ""));
    }
    events.add(frame, snapshot.time_s(), snapshot.force_n.norm(), names);
    progress.show(frame + 1, request.frame_count);
  }
  return {lowest_y_m, events.choose(sheet_frame_count)};
}

Status draw_frames(const Replay& replay, const PictureRequest& request, ReplayPictures& pictures,
                   const InterruptWatch& interrupt) {
  Snapshot start;
  write_snapshot(replay.session, start);
  Framing framing = find_framing(replay.session.simulation.scene(), start);
  const bool has_ground = framing.scene_ground_y_m || replay.session.view.ground_y_m;
  if (request.folder || !has_ground) {
    const ReplayPlan plan = plan_replay(replay, request, interrupt, framing.lowest_y_m);
    framing.lowest_y_m = plan.lowest_y_m;
    pictures.choose_sheet(plan.sheet);
  }
  PaintingCrew crew(request.size.width_px, request.size.height_px);
  ProgressBar progress(replay.console, "Drawing", replay.options.progress);
  std::vector<std::string> names;
  const auto paint = [&](std::uint64_t frame, bool is_frame) -> Status {
    PaintingJob job = make_painting_job(frame, replay.session, framing, request.size);
    job.extra_names = std::exchange(names, {});
    job.is_frame = is_frame;
    // Only a numbered frame clears the flags of the ticks since the last frame. A screenshot between two
    // frames must not hide these flags from the next frame.
    if (is_frame) replay.session.flags = tick_flag_none;
    if (crew.is_full()) {
      if (Status written = write_oldest_frame(crew, request, pictures); !written) return written;
    }
    crew.start(std::move(job));
    return {};
  };
  for (std::uint64_t frame = 0; frame < request.frame_count && !interrupt.requested(); ++frame) {
    if (Status ran = run_and_save(replay, request, frame_tick(frame), interrupt, names); !ran) return ran;
    if (interrupt.requested()) break;  // stopped before the tick of the frame
    const bool is_frame = frame % request.every == 0;
    if (!is_frame && names.empty()) continue;
    if (Status painted = paint(frame, is_frame); !painted) return painted;
    progress.show(frame + 1, request.frame_count);
  }
  if (Status ran = run_and_save(replay, request, replay.lockstep.tick_count(), interrupt, names); !ran)
    return ran;
  if (!names.empty() && !interrupt.requested()) {
    if (Status painted = paint(request.frame_count, false); !painted) return painted;
  }
  while (crew.in_flight() > 0) {
    if (Status written = write_oldest_frame(crew, request, pictures); !written) return written;
  }
  progress.show(1, 1);
  return {};
}

Status run_with_pictures(const Replay& replay, FactSheet& facts) {
  const PictureRequest request = make_picture_request(replay.options, replay.lockstep, replay.console);
  if (!request.folder && !request.video) return run_without_pictures(replay);
  retain_freed_memory();
  InterruptWatch interrupt;
  auto pictures = ReplayPictures::start(request);
  if (!pictures) return pictures.error();
  if (Status drawn = draw_frames(replay, request, pictures.value(), interrupt); !drawn) return drawn;
  if (interrupt.requested()) return stopped_replay(replay, interrupt);
  if (Status finished = replay.lockstep.finish(); !finished) return finished;
  if (Status finished = pictures->finish(); !finished) return finished;

  facts.add("Frames", std::to_string(pictures->count()), "frames", pictures->count());
  if (request.folder) {
    const std::string sheet = pictures->contact_sheet_file().string();
    facts.add("Folder", request.folder->string(), "out", request.folder->string());
    facts.add("Contact sheet", sheet, "contact_sheet", sheet);
  }
  if (request.video) facts.add("Video", request.video->string(), "video", request.video->string());
  return {};
}

Status replay_recording(const ReplayOptions& options, const Recording& recording, Console& console) {
  const std::string source = options.recording.string();
  if (recording.header.training) {
    return Error{ErrorCode::unsupported, source + ": is of a task; `spoonbill train` replays it", "training"};
  }
  if (Status checked = check_commands(recording.commands); !checked) return checked;
  auto session = [&] {
    MapProgress maps(console, options.progress);
    return Session::make(recording.header.document, source, recording.header.device, options.instruction_set,
                         maps.watch());
  }();
  if (!session) return session.error();
  std::optional<RecordingWriter> writer;
  if (!options.rerecord.empty()) {
    auto created = RecordingWriter::create(options.rerecord, recording.header, options.how);
    if (!created) return created.error();
    if (!created->notice().empty()) console.err << "spoonbill: " << created->notice() << '\n';
    writer.emplace(std::move(created).value());
  }
  std::optional<RunLog> log;
  if (!options.log.empty()) {
    auto created = RunLog::create(options.log, options.how, session.value(), LoggedTool::with_force);
    if (!created) return created.error();
    log.emplace(std::move(created).value());
  }
  PlaybackDevice device(recording.header.device, recording.readings);
  if (!recording.readings.empty()) session->reading = recording.readings.front();
  LockstepInput input = make_lockstep_input(recording, device, source);
  if (log) input.after_tick = [&] { return log->add(session.value()); };
  Lockstep lockstep(session.value(), std::move(input), writer ? &*writer : nullptr);

  FactSheet facts;
  facts.add("Ticks", std::to_string(recording.readings.size()), "ticks", recording.readings.size());
  if (recording.missed > 0) {
    facts.add("Missed", std::to_string(recording.missed) + " ticks while it was recorded live", "missed",
              recording.missed);
  } else {
    facts.add("", "", "missed", recording.missed);
  }
  if (Status ran = run_with_pictures(
          {options, recording, session.value(), lockstep, console, writer ? &*writer : nullptr}, facts);
      !ran)
    return ran;
  if (writer) {
    if (Status committed = writer->commit(); !committed) return committed;
  }
  if (log) {
    if (Status committed = log->commit(); !committed) return committed;
    facts.add("Log", options.log.string(), "log", options.log.string());
  }
  if (!options.saved.empty()) {
    const Document document = make_session_document(session.value());
    if (Status written = write_document(document, options.saved, options.how); !written) return written;
    facts.add("Saved", options.saved.string(), "saved", options.saved.string());
  }
  const std::string hash = hash_text(state_hash(session.value()));
  facts.add("State hash", hash, "state_hash", hash);
  facts.add("", "", "shape_hash", hash_text(shape_hash(session->simulation)));
  facts.add("", "", "complete", recording.end.has_value());
  facts.add("", "", "instruction_set", std::string(name_of(options.instruction_set)));
  facts.print(console.out, options.json);
  return {};
}

Status replay_file(const ReplayOptions& options, Console& console) {
  for (const auto& out : {options.rerecord, options.video, options.saved, options.log}) {
    if (Status checked = check_output(out, options.how); !checked) return checked;
  }
  const auto recording = read_recording(options.recording);
  if (!recording) return recording.error();
  if (Status checked = check_is_not_source(options.rerecord, options.recording, "--rerecord"); !checked)
    return checked;
  if (Status checked = check_is_not_source(options.saved, options.recording, "--save"); !checked)
    return checked;
  if (Status checked = check_is_not_source(options.log, options.recording, "--log"); !checked) return checked;
  if (!recording->notice.empty()) console.err << "spoonbill: " << one_line(recording->notice) << '\n';
  return replay_recording(options, recording.value(), console);
}

void add_picture_options(OptionSet parser, const std::shared_ptr<ReplayOptions>& options) {
  parser
      .add_option("--out", options->out,
                  "Folder for frame-####.png and contact-sheet.png; required unless --no-frames is given")
      .show_as("DIR");
  add_frame_options(parser, options->frames);
  parser
      .add_option("--video", options->video,
                  "Video to write if ffmpeg is installed; its ending selects the format. Default: none")
      .show_as("FILE");
  parser.add_flag("--no-frames", options->no_frames, "Draw nothing; only compute and compare the states");
}

}  // namespace

CommandEntry add_replay(OptionSet root) {
  auto options = std::make_shared<ReplayOptions>();
  const OptionSet parser =
      root.add_command("replay", "Replay a recording, verify its states and draw frames");
  parser.set_footer(
      "Frame k shows the state after floor(k * 1000 / 60) ticks of 1 ms, on any machine and load. States\n"
      "are compared with those in the recording; a difference is an error that names the tick. A truncated\n"
      "recording replays up to its end. Frames of an earlier replay in the same folder are replaced.\n"
      "Example: spoonbill replay assets/recordings/spoon-handle-bend.recording.jsonl --out output/bend");
  parser.add_option("RECORDING", options->recording, "Recording (.recording.jsonl)").require();
  add_picture_options(parser, options);
  parser
      .add_option("--rerecord", options->rerecord,
                  "File for a new recording of the replay, with the same bytes as RECORDING; default: none")
      .show_as("FILE");
  add_document_output(parser, options->saved,
                      "Document to write (.json): the bodies as they are at the end; default: none",
                      "--save");
  add_log_option(parser, options->log);
  add_force_option(parser, options->how);
  add_instruction_set_option(parser, options->instruction_set);
  parser.add_flag("--progress", options->progress, "Show progress even if the output is not a terminal");
  add_json_option(parser, options->json);
  parser.set_final_check([options]() -> Status {
    if (options->out.empty() && !options->no_frames)
      return Error{ErrorCode::missing, "--out is required", "--out"};
    return {};
  });
  return {parser, [options](Console& console) { return replay_file(*options, console); }};
}

}  // namespace spoonbill
