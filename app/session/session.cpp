#include "app/session/session.h"

#include <utility>
#include <variant>

namespace spoonbill {
namespace {

bool is_history_command(const Json& command, const char* name) {
  return command.size() == 1 && command.contains("command") && command["command"] == name;
}

bool changes_what_a_shape_means(const Command& command) {
  return std::holds_alternative<PlacePlane>(command) || std::holds_alternative<RemovePlanes>(command) ||
         std::holds_alternative<KeepShape>(command);
}

Status apply_simulation_command(Session& session, const TimedCommand& timed) {
  const auto command = command_from_json(timed.command, timed.origin);
  if (!command) return command.error();
  if (Status applied = session.simulation.apply(command.value()); !applied) {
    return Error{timed.origin + ": " + applied.error().message};
  }
  if (changes_what_a_shape_means(command.value())) session.history.clear(session.simulation);
  return {};
}

Status cancel_stroke(Session& session) {
  if (!session.history.in_stroke()) return {};
  if (Status cancelled = session.history.cancel(session.simulation); !cancelled) return cancelled;
  return session.simulation.apply(LiftTool{});
}

Error unknown_command(const TimedCommand& timed) {
  return Error{timed.origin + ": unknown command " + json_excerpt(timed.command)};
}

}  // namespace

Result<Session> Session::make(const Document& document, const std::string& source, DeviceSpecification device,
                              InstructionSet set) {
  auto view = view_from_json(document.view, source);
  if (!view) return view.error();
  auto simulation = Simulation::make(document.scene, set);
  if (!simulation) return Error{source + ": " + simulation.error().message};
  StrokeHistory history(simulation.value());
  return Session{document.name,   std::move(simulation).value(),
                 CouplingState(), std::move(history),
                 view.value(),    std::move(device),
                 DeviceReading(), tick_flag_none};
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

Status apply_command(Session& session, const TimedCommand& timed) {
  const Json& command = timed.command;
  if (is_simulation_command(command)) return apply_simulation_command(session, timed);
  if (is_view_command(command)) return apply_view_command(command, timed.origin, session.view);
  if (is_history_command(command, "undo")) return session.history.undo(session.simulation);
  if (is_history_command(command, "redo")) return session.history.redo(session.simulation);
  if (is_history_command(command, "cancel_stroke")) return cancel_stroke(session);
  return unknown_command(timed);
}

Status check_commands(const std::vector<TimedCommand>& commands) {
  ViewChoice scratch;
  for (const TimedCommand& timed : commands) {
    const Json& command = timed.command;
    if (is_simulation_command(command)) {
      const auto read = command_from_json(command, timed.origin);
      if (!read) return read.error();
    } else if (is_view_command(command)) {
      if (Status read = apply_view_command(command, timed.origin, scratch); !read) return read;
    } else if (!is_history_command(command, "undo") && !is_history_command(command, "redo")) {
      return unknown_command(timed);
    }
  }
  return {};
}

}  // namespace spoonbill
