#include "app/session/session.h"

#include <utility>
#include <variant>

namespace spoonbill {
namespace {

bool changes_what_a_shape_means(const Command& command) {
  return std::holds_alternative<PlacePlane>(command) || std::holds_alternative<RemovePlanes>(command) ||
         std::holds_alternative<KeepShape>(command) || std::holds_alternative<RefineKnots>(command);
}

// A recording cannot fill the memory with documents that nobody takes.
constexpr std::size_t most_waiting_marks = 1000;

struct RequestApplier {
  Session& session;

  Status operator()(const Command& command) {
    if (Status applied = session.simulation.apply(command); !applied) return applied;
    if (changes_what_a_shape_means(command)) session.history.clear(session.simulation);
    return {};
  }
  Status operator()(const UndoStroke&) { return session.history.undo(session.simulation); }
  Status operator()(const RedoStroke&) { return session.history.redo(session.simulation); }
  Status operator()(const CancelStroke&) {
    if (!session.history.in_stroke()) return {};
    if (Status cancelled = session.history.cancel(session.simulation); !cancelled) return cancelled;
    return session.simulation.apply(LiftTool{});
  }
  Status operator()(const ChangeView& change) {
    return apply_view_command(change.command, "view", session.view);
  }
  Status operator()(const MarkFile& mark) {
    if (session.marks.size() == most_waiting_marks) return Error{"too many files are asked for at once"};
    FileMark& made = session.marks.emplace_back(FileMark{mark, {}});
    if (mark.kind == FileMarkKind::document) made.document = document_of(session);
    return {};
  }
};

}  // namespace

Result<Session> Session::make(const Document& document, const std::string& source, DeviceSpecification device,
                              InstructionSet set, const FeatureMapWatch& watch) {
  auto view = view_from_json(document.view, source);
  if (!view) return view.error();
  auto simulation = Simulation::make(document.scene, set, watch);
  if (!simulation) return Error{source + ": " + simulation.error().message};
  StrokeHistory history(simulation.value());
  return Session{document.name,
                 std::move(simulation).value(),
                 CouplingState(),
                 std::move(history),
                 view.value(),
                 std::move(device),
                 DeviceReading(),
                 tick_flag_none,
                 {}};
}

TickResult advance(Session& session, const DeviceReading& reading) {
  TickResult result = tick(session.simulation, session.coupling, session.device, reading);
  session.reading = reading;
  session.flags |= result.flags;
  session.history.after_tick(session.simulation, result.touching);
  return result;
}

void write_snapshot(const Session& session, Snapshot& snapshot) {
  session.simulation.write_snapshot(snapshot);
  snapshot.tool.device = session.reading.pose();
  // Before the first tick only the hand is known.
  if (session.simulation.tick() == 0) snapshot.tool.proxy = snapshot.tool.device;
  snapshot.tool.button = (session.reading.buttons & button_main) != 0;
  snapshot.device.name = session.device.name;
  snapshot.device.force_limit_n = session.device.maximum_force_n;
  snapshot.force_n = session.coupling.force_n;
  snapshot.flags = session.flags;
}

std::uint64_t state_hash(const Session& session) {
  StateHash hash;
  hash.add(session.simulation.state_hash());
  add_to_hash(session.coupling, hash);
  return hash.value();
}

Document document_of(const Session& session) {
  Document document{session.title, session.simulation.scene(), view_to_json(session.view)};
  session.simulation.write_scene(document.scene);
  return document;
}

Status apply_request(Session& session, const Request& request) {
  return std::visit(RequestApplier{session}, request);
}

bool rebuilds(const Session& session, const Request& request) {
  if (std::holds_alternative<MarkFile>(request)) return true;
  const auto* command = std::get_if<Command>(&request);
  if (command == nullptr) return false;
  const auto* tool = std::get_if<SetTool>(command);
  // What snapshots hold changes with a soft tool that comes or goes.
  const bool held_solid = session.simulation.scene().tool.kind == ToolKind::solid;
  return (tool != nullptr && (held_solid || tool->tool.kind == ToolKind::solid)) ||
         (changes_what_a_shape_means(*command) || std::holds_alternative<SetMaterial>(*command));
}

Status apply_command(Session& session, const TimedCommand& timed) {
  const auto request = request_from_json(timed);
  if (!request) return request.error();
  if (Status applied = apply_request(session, request.value()); !applied) {
    return Error{timed.origin + ": " + applied.error().message};
  }
  return {};
}

Status check_commands(const std::vector<TimedCommand>& commands) {
  for (const TimedCommand& timed : commands) {
    if (const auto request = request_from_json(timed); !request) return request.error();
  }
  return {};
}

}  // namespace spoonbill
