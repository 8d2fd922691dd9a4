// The log of a run: a CSV file with a row for each body, and for the tool, after each tick.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/session/session.h"
#include "engine/base/file.h"
#include "engine/trial/body_measures.h"

namespace spoonbill {

// Which rows a log has beside those of the bodies: a trial has no tool.
enum class LoggedTool { none, with_force };

// Writes the log of a session. The file appears under its name at commit(). Has one owner, on one thread. The
// columns are:
//
// - tick, time_s; body: the name of the body, or "tool"; kind: that of the body, or "tool"
// - x_m to qz: pose of a fixed or rigid body, which maps its rest shape to the present one, or of the tool's
//   proxy
// - centre_x_m to centre_z_m: centre of mass
// - largest_speed_m_per_s: highest speed of a node; a body that is lowered counts as at rest
// - contact_x_n to contact_z_n: force of all other bodies and of the tool on the body; for the tool, the
//   force on the hand, after force scale and limit
// - contact_area_m2: area on which contacts push the body (Simulation::contact_area_m2())
// - ground_x_n to ground_z_n: force of the ground on the body
// - support_x_n to support_z_n: force of the body's supports on it; for a fixed body, the force that holds
//   it; for a held body, the force of the hand. In a trial, the force of fixing planes is included. It is
//   then found from the change of the momentum of all nodes, which for a stiff body is right in the mean
//   alone
// - inverted_cells
// - energy_j: kinetic, gravitational and elastic energy, without that of a hand's spring; empty for a fixed
//   body, and for one that creeps or flows
// - phase: the part of a trial
//
// A field that has no meaning for a row is empty.
class RunLog {
 public:
  // Starts the file with the names of the columns.
  static Result<RunLog> create(const std::filesystem::path& file, const OutputOptions& how,
                               const Session& session, LoggedTool tool);

  // Adds the rows of the last tick. The session must have the same bodies as in create(). `phase` is the part
  // of the run, if it has parts.
  Status add(const Session& session, std::string_view phase = {});

  Status commit();

 private:
  RunLog(OutputFile file, const Session& session, LoggedTool tool);
  void add_body(const Session& session, int body, std::string_view phase);
  void add_tool(const Session& session, std::string_view phase);

  // A body, with what its rows need from tick to tick.
  struct LoggedBody {
    std::string name, kind;
    EnergyMeter energy;  // of a deformable body
    ControlNet rest;     // control points of a fixed body at rest
    Pose mesh_pose;      // of a fixed body with a mesh
    RigidMass at_rest;   // mass of a fixed body, and its centre at rest
    int support_count = 0;
    Vector3 momentum_ns = Vector3::Zero();  // of a deformable body after the last row
  };
  OutputFile file_;
  std::vector<LoggedBody> bodies_;
  LoggedTool tool_;
  Snapshot snapshot_;
  std::string text_;  // rows that are not written yet
};

}  // namespace spoonbill
