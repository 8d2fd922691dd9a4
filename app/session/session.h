// A session: one simulation with what belongs to it while it is worked on. Plain struct with one owner,
// whoever ticks it: the lock-step loop or the haptic thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/session/request.h"
#include "app/undo/stroke_history.h"
#include "app/view/view_choice.h"
#include "engine/exchange/document.h"
#include "haptic/device.h"
#include "haptic/recording.h"
#include "haptic/tick.h"

namespace spoonbill {

// A file that was asked for.
struct FileMark {
  MarkFile mark;
  std::optional<Document> document;  // as it was then, when that is what was asked for
};

struct Session {
  std::string title;
  Simulation simulation;
  CouplingState coupling;
  StrokeHistory history;
  ViewChoice view;

  DeviceSpecification device;
  DeviceReading reading;                 // of the last tick
  std::uint32_t flags = tick_flag_none;  // TickFlag bits, gathered until somebody clears them
  std::vector<FileMark> marks;           // gathered until somebody takes them

  // `source` names the document's file in messages; `watch` is told how feature maps come along.
  static Result<Session> make(const Document& document, const std::string& source, DeviceSpecification device,
                              InstructionSet set, const FeatureMapWatch& watch = {});
};

// One tick of touch; the undo history follows.
TickResult advance(Session& session, const DeviceReading& reading);

// What there is to draw of the last tick, or before the first one.
void write_snapshot(const Session& session, Snapshot& snapshot);

// FNV-1a over every bit that the next tick depends on.
std::uint64_t state_hash(const Session& session);

// What would be saved now.
Document document_of(const Session& session);

// An error leaves the session as it was. Allocates nothing unless rebuilds(session, request).
Status apply_request(Session& session, const Request& request);

// Whether applying it builds grids or lattices anew: takes milliseconds and memory.
bool rebuilds(const Session& session, const Request& request);

// As JSON. An error also names the command's origin.
Status apply_command(Session& session, const TimedCommand& command);

// Whether each command can be understood, so that a mistake in a recording's last second shows at its start.
Status check_commands(const std::vector<TimedCommand>& commands);

}  // namespace spoonbill
