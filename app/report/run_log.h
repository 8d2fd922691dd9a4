// The log of a run: a CSV file with a row for each body, and for the tool, after each tick.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
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
// - x_m to qz: pose of a fixed body, which maps its rest shape to the present one, or of the tool's proxy
// - centre_x_m to centre_z_m: centre of mass; largest_speed_m_per_s: highest speed of a node
// - contact_x_n to contact_z_n and contact_area_m2: force of all other bodies on the body, and the area on
//   which contacts push it; for the tool, the force on the hand
// - ground_x_n to ground_z_n: force of the ground on the body
// - support_x_n to support_z_n: force of the body's supports on it
// - inverted_cells; energy_j: kinetic, gravitational and elastic energy of a body that neither creeps nor
//   flows
//
// A field that has no meaning for a row is empty.
class RunLog {
 public:
  // Starts the file with the names of the columns.
  static Result<RunLog> create(const std::filesystem::path& file, const OutputOptions& how,
                               const Session& session, LoggedTool tool);

  // Adds the rows of the last tick. The session must have the same bodies as in create().
  Status add(const Session& session);

  Status commit();

 private:
  RunLog(OutputFile file, const Session& session, LoggedTool tool);
  void add_body(const Session& session, int body);
  void add_tool(const Session& session);

  // A body, with what its rows need from tick to tick.
  struct LoggedBody {
    std::string name, kind;
    EnergyMeter energy;                // of a deformable body
    ControlNet rest;                   // control points of a fixed body at rest
    Vector3 rest_m = Vector3::Zero();  // centre of mass of a fixed body at rest
    int support_count = 0;
  };
  OutputFile file_;
  std::vector<LoggedBody> bodies_;
  LoggedTool tool_;
  Snapshot snapshot_;
  std::string text_;  // rows that are not written yet
};

}  // namespace spoonbill
