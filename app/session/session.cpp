#include "app/session/session.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "app/session/view_choice.h"
#include "engine/exchange/document.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr std::size_t mark_name_limit = 64;

bool is_mark_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

struct PlainRequest {
  const char* name;
  Request request;
};

const std::array<PlainRequest, 3>& plain_requests() {
  static const std::array<PlainRequest, 3> all = {
      {{"undo", UndoStroke{}}, {"redo", RedoStroke{}}, {"cancel_stroke", CancelStroke{}}}};
  return all;
}

Result<Request> read_mark(const TimedCommand& timed, FileMarkKind kind) {
  FieldReader reader(timed.command, timed.origin);
  reader.ignore("command");
  MarkFile mark{kind, reader.text("name")};
  if (reader.status() && make_mark_name(mark.name) != mark.name) {
    reader.refuse("name", "must have 1 to 64 letters, digits, - and _");
  }
  reader.finish();
  if (!reader.status()) return reader.status().error();
  return Request(std::move(mark));
}

Result<Request> read_force_switch(const TimedCommand& timed) {
  FieldReader reader(timed.command, timed.origin);
  reader.ignore("command");
  const SwitchForce force{reader.boolean("on")};
  reader.finish();
  if (!reader.status()) return reader.status().error();
  return Request(force);
}

Result<Request> read_view_command(const TimedCommand& timed) {
  ViewChoice scratch;
  if (Status read = apply_view_command(timed.command, timed.origin, scratch); !read) return read.error();
  return Request(ChangeView{timed.command});
}

Result<Request> read_simulation_command(const TimedCommand& timed) {
  auto command = command_from_json(timed.command, timed.origin);
  if (!command) return command.error();
  return Request(std::move(command).value());
}

struct RequestToJson {
  Json operator()(const Command& command) const { return command_to_json(command); }
  Json operator()(const UndoStroke&) const { return {{"command", "undo"}}; }
  Json operator()(const RedoStroke&) const { return {{"command", "redo"}}; }
  Json operator()(const CancelStroke&) const { return {{"command", "cancel_stroke"}}; }
  Json operator()(const SwitchForce& force) const { return {{"command", "switch_force"}, {"on", force.on}}; }
  Json operator()(const ChangeView& change) const { return change.command; }
  Json operator()(const MarkFile& mark) const {
    return {{"command", mark.kind == FileMarkKind::document ? "save" : "screenshot"}, {"name", mark.name}};
  }
};

}  // namespace

Result<Request> request_from_json(const TimedCommand& timed) {
  if (is_simulation_command(timed.command)) return read_simulation_command(timed);
  if (is_view_command(timed.command)) return read_view_command(timed);
  FieldReader reader(timed.command, timed.origin);
  const std::string name = reader.text("command");
  if (!reader.status()) return reader.status().error();
  if (name == "save") return read_mark(timed, FileMarkKind::document);
  if (name == "screenshot") return read_mark(timed, FileMarkKind::picture);
  if (name == "switch_force") return read_force_switch(timed);
  for (const PlainRequest& plain : plain_requests()) {
    if (name != plain.name) continue;
    reader.finish();
    if (!reader.status()) return reader.status().error();
    return plain.request;
  }
  reader.refuse("command",
                "is " + json_excerpt(Json(name)) +
                    ", must be one of save, screenshot, undo, redo, cancel_stroke, switch_force, set_camera, "
                    "set_overlays, " +
                    simulation_command_names());
  return reader.status().error();
}

Json request_to_json(const Request& request) {
  return std::visit(RequestToJson{}, request);
}

std::string make_mark_name(const std::string& text) {
  std::string name = text.substr(0, mark_name_limit);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_mark_character(c); }, '-');
  return name.empty() ? "unnamed" : name;
}

namespace {

// Largest number of requested files that wait to be written, and largest number of different documents saved
// at one tick. The limits keep a recording from filling the memory.
constexpr std::size_t waiting_marks_limit = 1000;
constexpr std::size_t saves_at_tick_limit = 16;

struct RequestApplier {
  Session& session;

  Status operator()(const Command& command) {
    if (replaces_build(command)) return session.history.apply(session.simulation, command);
    return session.simulation.apply(command);
  }
  Status operator()(const UndoStroke&) { return session.history.undo(session.simulation); }
  Status operator()(const RedoStroke&) { return session.history.redo(session.simulation); }
  Status operator()(const CancelStroke&) {
    if (!session.history.in_stroke()) return {};
    if (Status cancelled = session.history.cancel(session.simulation); !cancelled) return cancelled;
    return session.simulation.apply(LiftTool{});
  }
  Status operator()(const SwitchForce& force) {
    session.force_on = force.on;
    return {};
  }
  Status operator()(const ChangeView& change) {
    return apply_view_command(change.command, "view", session.view);
  }
  Status operator()(const MarkFile& mark) {
    if (session.marks.size() == waiting_marks_limit) {
      return Error{ErrorCode::too_many,
                   "more than " + std::to_string(waiting_marks_limit) + " files requested at one tick"};
    }
    FileMark made{mark, {}};
    if (mark.kind == FileMarkKind::document) {
      if (Status saved = save_document(); !saved) return saved;
      made.document = session.saved;
    }
    // A new mark replaces an earlier one of the same kind and name, because both would be written to the same
    // file.
    std::erase_if(session.marks, [&](const FileMark& other) {
      return other.mark.kind == mark.kind && other.mark.name == mark.name;
    });
    session.marks.push_back(std::move(made));
    return {};
  }

  // Sets session.saved to the document of the current state, if session.saved is null.
  Status save_document() const {
    if (session.saved != nullptr) return {};
    if (session.saves_at_tick == saves_at_tick_limit) {
      return Error{ErrorCode::too_many, "more than " + std::to_string(saves_at_tick_limit) +
                                            " different documents saved at one tick"};
    }
    ++session.saves_at_tick;
    session.saved = std::make_shared<const Document>(session.keeps_documents ? make_session_document(session)
                                                                             : Document());
    return {};
  }
};

// Returns the mass of a body; zero for a face of a solid, which has no mass of its own.
BodyMass mass_of_session(const Body& body) {
  return compute_body_mass(body).value_or(BodyMass());
}

}  // namespace

Result<Session> Session::make(const Document& document, const std::string& source, DeviceSpecification device,
                              InstructionSet set, const FeatureMapWatch& watch) {
  auto view = view_from_json(document.view, source);
  if (!view) return view.error();
  auto simulation = Simulation::make(document.scene, set, watch);
  if (!simulation) return simulation.error().in(source);
  EditHistory history(simulation.value());
  std::vector<BodyMass> masses;
  for (const Body& body : document.scene.bodies) masses.push_back(mass_of_session(body));
  return Session{document.name,
                 std::move(simulation).value(),
                 CouplingState(),
                 std::move(history),
                 view.value(),
                 std::move(masses),
                 std::move(device),
                 DeviceReading(),
                 tick_flag_none,
                 {},
                 true,
                 {},
                 0,
                 true};
}

TickResult advance(Session& session, const DeviceReading& reading) {
  TickResult result =
      session.training ? session.training->tick(session.simulation, session.coupling, session.device, reading)
                       : tick(session.simulation, session.coupling, session.device, reading);
  if (session.watch) session.watch->follow(session.simulation, *session.training, result.force_n);
  session.reading = reading;
  session.saved.reset();
  session.saves_at_tick = 0;
  session.flags |= result.flags;
  session.history.after_tick(session.simulation, result.touching);
  return result;
}

void write_snapshot(const Session& session, Snapshot& snapshot) {
  session.simulation.write_snapshot(snapshot);
  snapshot.tool.device = session.reading.pose();
  // Before the first tick there is no proxy yet.
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

std::uint64_t shape_hash(const Simulation& simulation) {
  Document document{{}, simulation.scene(), {}};
  simulation.write_scene(document.scene);
  // A tick may change the sign of a zero. The sum with 0 is never -0.
  for (Body& body : document.scene.bodies) {
    for (std::vector<double>* const coordinates :
         {&body.surface.net.x, &body.surface.net.y, &body.surface.net.z}) {
      for (double& value : *coordinates) value += 0.0;
    }
  }
  const Json json = document_to_json(document);
  StateHash hash;
  for (const char* part : {"body", "other_bodies", "fixing_planes"}) {
    const std::string text = json.value(part, Json()).dump();
    for (const char letter : text) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(letter)));
  }
  for (std::size_t b = 0; b < document.scene.bodies.size(); ++b) {
    simulation.lattice(static_cast<int>(b)).visit_deformation([&](const float* values, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        const float value = values[i] + 0.0f;
        hash.add(&value, 1);
      }
    });
  }
  for (const Pose& pose : simulation.shape().poses) {
    for (int axis = 0; axis < 3; ++axis) hash.add(pose.position_m[axis] + 0.0);
    for (int k = 0; k < 4; ++k) hash.add(pose.orientation.coeffs()[k] + 0.0);
  }
  return hash.value();
}

Document make_session_document(const Session& session) {
  Document document{session.title, session.simulation.scene(), view_to_json(session.view)};
  session.simulation.write_scene(document.scene);
  return document;
}

Status apply_request(Session& session, const Request& request) {
  if (!std::holds_alternative<MarkFile>(request)) session.saved.reset();
  return std::visit(RequestApplier{session}, request);
}

bool needs_rebuild(const Session& session, const Request& request) {
  if (std::holds_alternative<MarkFile>(request)) return true;
  if (std::holds_alternative<UndoStroke>(request)) return session.history.undo_needs_build();
  if (std::holds_alternative<RedoStroke>(request)) return session.history.redo_needs_build();
  if (std::holds_alternative<CancelStroke>(request)) return session.history.cancel_needs_build();
  const auto* command = std::get_if<Command>(&request);
  if (command == nullptr) return false;
  const auto* tool = std::get_if<SetTool>(command);
  // A solid tool may be soft, so a change from or to a solid tool can change the size of snapshots.
  const bool is_solid = session.simulation.scene().tool.kind == ToolKind::solid;
  return (tool != nullptr && (is_solid || tool->tool.kind == ToolKind::solid)) || replaces_build(*command) ||
         std::holds_alternative<MoveBody>(*command);
}

Status apply_command(Session& session, const TimedCommand& timed) {
  const auto request = request_from_json(timed);
  if (!request) return request.error();
  if (Status applied = apply_request(session, request.value()); !applied) {
    return applied.error().in(timed.origin);
  }
  return {};
}

Status check_commands(const std::vector<TimedCommand>& commands) {
  for (const TimedCommand& timed : commands) {
    if (const auto request = request_from_json(timed); !request) return request.error();
  }
  return {};
}

void write_facts(const Session& session, SessionFacts& facts) {
  const Scene& scene = session.simulation.scene();
  facts.title = session.title;
  facts.tool = scene.tool;
  facts.material = scene.bodies[0].material;
  facts.region_count = static_cast<int>(scene.bodies[0].regions.size());
  facts.mass_kg = 0.0;
  for (std::size_t b = 0; b < session.masses.size(); ++b) {
    facts.mass_kg += session.masses[b].mass_kg(scene.bodies[b].material.density_kg_per_m3);
  }
  facts.sculpting = scene.sculpting;
  facts.ground = scene.ground;
  facts.symmetry = scene.symmetry;
  facts.can_undo = session.history.can_undo();
  facts.can_redo = session.history.can_redo();
  facts.in_stroke = session.history.in_stroke();
  facts.force_on = session.force_on;
  if (!session.training) return facts.training.reset();
  const Training& training = *session.training;
  const SpoonHold* const hold = training.hold();
  facts.training =
      TrainingFacts{session.watch->progress(), session.watch->held_s(), training.wanted(),
                    training.reached(),        training.wrist_angles(), hold ? hold->torque().used() : 0.0};
}

}  // namespace spoonbill
