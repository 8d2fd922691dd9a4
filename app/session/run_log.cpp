#include "app/session/run_log.h"

#include <cstdint>
#include <utility>

#include "app/report/csv_text.h"
#include "engine/base/assert.h"
#include "engine/simulation/body_hold.h"

namespace spoonbill {
namespace {

constexpr std::string_view column_names =
    "tick,time_s,body,kind,x_m,y_m,z_m,qw,qx,qy,qz,centre_x_m,centre_y_m,centre_z_m,largest_speed_m_per_s,"
    "contact_x_n,contact_y_n,contact_z_n,contact_area_m2,ground_x_n,ground_y_n,ground_z_n,support_x_n,"
    "support_y_n,support_z_n,inverted_cells,energy_j,phase\n";

// A quotient gives the decimal that a product with tick_s would miss by rounding.
constexpr double ticks_per_s = 1000.0;

// Rows are written in pieces of about this size.
constexpr std::size_t chunk_bytes = 1 << 16;

void append_empty(std::string& line, int fields) {
  line.append(static_cast<std::size_t>(fields), ',');
}

void append_vector(std::string& line, const Vector3& vector) {
  for (const double component : vector) append_csv_number(line, component);
}

void append_pose(std::string& line, const Pose& pose) {
  append_vector(line, pose.position_m);
  const Quaternion& q = pose.orientation;
  for (const double component : {q.w(), q.x(), q.y(), q.z()}) append_csv_number(line, component);
}

void append_end(std::string& line, std::string_view phase) {
  line += ',';
  line += phase;
  line += '\n';
}

void append_start(std::string& line, std::uint64_t tick, const std::string& name, const std::string& kind) {
  line += std::to_string(tick);
  append_csv_number(line, static_cast<double>(tick) / ticks_per_s);
  line += ',' + name + ',' + kind;
}

}  // namespace

RunLog::RunLog(OutputFile file, const Session& session, LoggedTool tool)
    : file_(std::move(file)), tool_(tool) {
  const std::vector<Body>& bodies = session.simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    LoggedBody& logged = bodies_.emplace_back();
    logged.name = csv_field(bodies[b].name);
    logged.kind = body_kind_names[static_cast<std::size_t>(bodies[b].kind)];
    logged.support_count = static_cast<int>(bodies[b].supports.size());
    if (bodies[b].kind == BodyKind::deformable)
      logged.momentum_ns = find_mass_centre(session.simulation.lattice(static_cast<int>(b))).momentum_ns();
  }
}

Result<RunLog> RunLog::create(const std::filesystem::path& file, const OutputOptions& how,
                              const Session& session, LoggedTool tool) {
  auto created = OutputFile::create(file, how);
  if (!created) return created.error();
  if (Status written = created->write(column_names); !written) return written.error();
  return RunLog(std::move(created).value(), session, tool);
}

void RunLog::add_body(const Session& session, int body, std::string_view phase) {
  LoggedBody& logged = bodies_[static_cast<std::size_t>(body)];
  const Simulation& simulation = session.simulation;
  const SpringLattice& lattice = simulation.lattice(body);
  const Vector3& gravity = simulation.scene().sculpting.gravity_m_per_s2;
  const std::optional<Pose> pose = simulation.rigid_pose(body);
  const RigidDynamics* const rigid = simulation.rigid_dynamics(body);
  std::optional<MassCentre> centre;  // of a deformable body
  append_start(text_, simulation.tick(), logged.name, logged.kind);
  if (rigid) {
    append_pose(text_, rigid->pose());
    append_vector(text_, rigid->centre_m());
    append_csv_number(text_, simulation.fastest_m_per_s(body));
  } else if (pose) {
    const Body& at_rest = simulation.scene().bodies[static_cast<std::size_t>(body)];
    const bool has_moved =
        at_rest.mesh ? logged.mesh_pose != at_rest.mesh_pose || logged.at_rest.mass_kg == 0.0
                     : logged.rest.x != at_rest.surface.net.x || logged.rest.y != at_rest.surface.net.y ||
                           logged.rest.z != at_rest.surface.net.z;
    if (has_moved) {
      logged.rest = at_rest.surface.net;
      logged.mesh_pose = at_rest.mesh_pose;
      logged.at_rest = find_fixed_mass(at_rest);
    }
    append_pose(text_, *pose);
    append_vector(text_, pose->position_m + pose->orientation * logged.at_rest.centre_m);
    append_empty(text_, 1);
  } else {
    centre = find_mass_centre(lattice);
    append_empty(text_, 7);
    append_vector(text_, centre->position_m);
    append_csv_number(text_, simulation.fastest_m_per_s(body));
  }
  const Vector3 contact_n = simulation.contact_force_n(body) + simulation.tool_force_n(body);
  const Vector3 ground_n = simulation.ground_force_n(body);
  append_vector(text_, contact_n);
  append_csv_number(text_, simulation.contact_area_m2(body));
  append_vector(text_, ground_n);
  Vector3 support_n = Vector3::Zero();
  if (rigid) {
    support_n = rigid->hand_impulse_ns() / tick_s;
  } else if (pose) {
    support_n = -contact_n - ground_n - logged.at_rest.mass_kg * gravity;
  } else if (tool_ == LoggedTool::none && !simulation.scene().planes.empty() && lattice.has_fixed_nodes()) {
    // In a trial, nothing else acts on a body, so that the force of planes and supports is the rest of
    // Newton's second law.
    support_n = (centre->momentum_ns() - logged.momentum_ns) / tick_s - contact_n - ground_n -
                find_load_force_n(lattice) - centre->mass_kg * gravity;
  } else {
    for (int s = 0; s < logged.support_count; ++s) support_n += simulation.support_force_n(s, body);
  }
  if (centre) logged.momentum_ns = centre->momentum_ns();
  append_vector(text_, support_n);
  if (rigid) {
    append_empty(text_, 1);
    append_csv_number(text_, rigid->energy_j(gravity));
  } else if (pose) {
    append_empty(text_, 2);
  } else {
    append_csv_number(text_, measure_cells(lattice).inverted_cells);
    const std::optional<double> energy_j = logged.energy.find_energy_j(lattice, gravity);
    energy_j ? append_csv_number(text_, *energy_j) : append_empty(text_, 1);
  }
  append_end(text_, phase);
}

void RunLog::add_tool(const Session& session, std::string_view phase) {
  write_snapshot(session, snapshot_);
  append_start(text_, session.simulation.tick(), "tool", "tool");
  append_pose(text_, snapshot_.tool.proxy);
  append_empty(text_, 4);
  append_vector(text_, snapshot_.force_n);
  append_empty(text_, 9);
  append_end(text_, phase);
}

Status RunLog::add(const Session& session, std::string_view phase) {
  SPOONBILL_ASSERT(session.simulation.scene().bodies.size() == bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) add_body(session, static_cast<int>(b), phase);
  if (tool_ == LoggedTool::with_force) add_tool(session, phase);
  if (text_.size() < chunk_bytes) return {};
  return file_.write(std::exchange(text_, {}));
}

Status RunLog::commit() {
  if (Status written = file_.write(text_); !written) return written;
  return file_.commit();
}

}  // namespace spoonbill
