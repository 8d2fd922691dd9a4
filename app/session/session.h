// A session: one simulation with its undo history, view and device, and the requests that change it between
// two ticks.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/session/edit_history.h"
#include "app/session/view_choice.h"
#include "app/training/task_watch.h"
#include "app/training/training.h"
#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "engine/exchange/json.h"
#include "engine/inspection/mass_properties.h"
#include "engine/scene/scene.h"
#include "haptic/device.h"
#include "haptic/recording.h"
#include "haptic/tick.h"

namespace spoonbill {

// Requests: everything that a user, a script or a recording can request from a session between two ticks.
// Plain values, each with one JSON form:
//  the commands of engine/exchange/document.h     the commands of app/session/view_choice.h
//  {"command": "undo"}    {"command": "redo"}    {"command": "cancel_stroke"}
//  {"command": "switch_force", "on": false}      the force of the device; on at the start
//  {"command": "save", "name": "bent"}           the document at that tick
//  {"command": "screenshot", "name": "bent"}     the next frame
// A replay writes the last two as saved-NAME.json and picture-NAME.png into its own output folder. Names have
// 1 to 64 letters, digits, - and _.
struct UndoStroke {};
struct RedoStroke {};
struct CancelStroke {};
struct SwitchForce {
  bool on = true;
};

// One of the view's commands, already validated.
struct ChangeView {
  Json command;
};

// Kind of a file to write.
enum class FileMarkKind { document, picture };

// A request to write a document or a screenshot under the given name.
struct MarkFile {
  FileMarkKind kind = FileMarkKind::document;
  std::string name;
};

using Request =
    std::variant<Command, UndoStroke, RedoStroke, CancelStroke, SwitchForce, ChangeView, MarkFile>;

// Reads a request. An error names the command's origin and the field.
Result<Request> request_from_json(const TimedCommand& timed);
Json request_to_json(const Request& request);

// Converts any text, such as a file name, to a valid name of a MarkFile request.
std::string make_mark_name(const std::string& text);

// A requested file with its contents.
struct FileMark {
  MarkFile mark;
  std::shared_ptr<const Document> document;  // document at the tick of the mark; null for a screenshot
};

// A simulation and all state that belongs to a session. Plain struct with one owner: the lock-step loop or
// the haptic thread.
struct Session {
  std::string title;
  Simulation simulation;
  CouplingState coupling;
  EditHistory history;
  ViewChoice view;
  std::vector<BodyMass> masses = {};  // masses of the document's bodies; sculpting does not change them

  DeviceSpecification device;
  DeviceReading reading;                 // reading of the last tick
  std::uint32_t flags = tick_flag_none;  // TickFlag bits, accumulated until a frame has shown them
  // Requests for files that consume_marks() has not consumed yet. A new request replaces an earlier one of
  // the same kind and name.
  std::vector<FileMark> marks;
  // False if documents will not be written; the documents in `marks` are then empty.
  bool keeps_documents = true;
  // Document made by the last save request; null if the session has changed since that request.
  std::shared_ptr<const Document> saved = {};
  std::size_t saves_at_tick = 0;  // number of different documents saved at this tick
  bool force_on = true;           // false while the user has switched the device's force off
  // Carries the spoon of a training session, instead of the tool; empty in other sessions.
  std::optional<Training> training = {};
  // Follows the task of a training session.
  std::optional<TaskWatch> watch = {};

  // Makes a session of the document. `source` names the document's file in messages; `watch` receives the
  // progress of feature maps, which distribute the nodes inside a body evenly.
  static Result<Session> make(const Document& document, const std::string& source, DeviceSpecification device,
                              InstructionSet set, const FeatureMapWatch& watch = {});
};

// Runs one tick with a reading of the device, and updates the undo history.
TickResult advance(Session& session, const DeviceReading& reading);

// Writes the data that drawing needs, as of the last tick. Before the first tick, writes the initial state.
void write_snapshot(const Session& session, Snapshot& snapshot);

// Returns the FNV-1a hash of all data on which the next tick depends, bit for bit.
std::uint64_t state_hash(const Session& session);

// Returns a hash of the bodies as documents store them, of the deformation of their lattices, of the fixing
// planes and of the poses. Tick, tool, settings, velocities and forces do not count: undoing every stroke
// gives back the hash of the start if nothing but strokes has moved the bodies. Must be called between ticks.
std::uint64_t shape_hash(const Simulation& simulation);

// Returns the document of the current state, as it would be saved.
Document make_session_document(const Session& session);

// Applies a request. An error leaves the session unchanged. Does not allocate if needs_rebuild(session,
// request) is false.
Status apply_request(Session& session, const Request& request);

// Returns true if the request takes milliseconds and allocates. This is so for a request that rebuilds grids
// or lattices, and for a request that makes a document to be written.
bool needs_rebuild(const Session& session, const Request& request);

// Applies a request given as JSON. An error names the command's origin.
Status apply_command(Session& session, const TimedCommand& command);

// Checks that every command can be parsed, so that a replay reports a mistake at its start.
Status check_commands(const std::vector<TimedCommand>& commands);

// State of a training session that the panel and the picture show. Plain data.
struct TrainingFacts {
  TaskResult progress;   // without path length, smoothness and tremor, see TaskWatch::progress()
  double held_s = 0.0;   // see TaskWatch::held_s()
  Pose wanted, reached;  // of the bowl or the finger: as the person wants it, and as the hand reaches it
  WristAngles wrist_rad{};
  double grip_used = 0.0;  // see GripTorque::used()
};

// Settings and undo state of a session that the panel shows beside the snapshot. Plain data, copied from the
// thread that ticks to the one that draws.
struct SessionFacts {
  std::string title;
  Tool tool;
  Material material;
  int region_count = 0;  // number of regions of the first body, whose material is `material`
  double mass_kg = 0.0;  // mass of all bodies
  Sculpting sculpting;
  Symmetry symmetry;
  std::optional<Ground> ground = {};
  bool can_undo = false;
  bool can_redo = false;
  bool in_stroke = false;
  bool force_on = true;
  std::optional<TrainingFacts> training = {};
};

// Copies the facts. Allocates only when a text is longer than the previous one.
void write_facts(const Session& session, SessionFacts& facts);

}  // namespace spoonbill
