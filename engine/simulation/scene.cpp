#include "engine/simulation/scene.h"

#include <cmath>

#include "engine/number_text.h"

namespace spoonbill {

namespace {

// Normals arrive as decimals and from arithmetic; both stay far within this.
constexpr double unit_tolerance = 1e-6;

Status check_position(const char* field, const Vector3& position) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(field) + "[" + std::to_string(axis) + "]";
    if (Status status = check_range(name, position[axis], position_range_m); !status.ok()) return status;
  }
  return {};
}

Status check_unit(const std::string& field, const Vector3& vector) {
  const double length = vector.norm();
  if (std::abs(length - 1.0) <= unit_tolerance) return {};
  return Error{field + " has length " + number_text(length) + ", must be a unit vector"};
}

}  // namespace

Status check_fixing_plane(const FixingPlane& plane) {
  if (Status status = check_position("fixing plane: point_m", plane.point_m); !status.ok()) return status;
  return check_unit("fixing plane: normal", plane.normal);
}

Status check_symmetry(const Symmetry& symmetry) {
  if (Status status = check_position("symmetry: point_m", symmetry.point_m); !status.ok()) return status;
  return check_unit("symmetry: normal", symmetry.normal);
}

Status check_lattice_request(const LatticeRequest& lattice) {
  if (!lattice.counts) return check_range("lattice: node_budget", lattice.node_budget, node_budget_range);
  int product = 1;
  for (std::size_t direction = 0; direction < 3; ++direction) {
    const int count = (*lattice.counts)[direction];
    const std::string name = "lattice: nodes[" + std::to_string(direction) + "]";
    if (Status status = check_range(name, count, node_count_range); !status.ok()) return status;
    product *= count;
  }
  if (product <= node_budget_range.high) return {};
  return Error{"lattice: nodes make " + std::to_string(product) + " nodes, must be at most " +
               std::to_string(node_budget_range.high)};
}

Status check_tool(const Tool& tool) {
  if (Status status = check_range("tool: radius_m", tool.radius_m, tool_radius_range_m); !status.ok()) {
    return status;
  }
  return check_range("tool: iterations", tool.iterations, tool_iterations_range);
}

Status check_sculpting(const Sculpting& sculpting) {
  if (Status status =
          check_range("sculpting: damping_per_s", sculpting.damping_per_s, sculpting_damping_range_per_s);
      !status.ok()) {
    return status;
  }
  const double gravity = sculpting.gravity_m_per_s2.norm();
  if (Status status = check_range("sculpting: length of gravity_m_per_s2", gravity,
                                  Range<double>{0.0, gravity_limit_m_per_s2});
      !status.ok()) {
    return status;
  }
  return check_range("sculpting: force_scale", sculpting.force_scale, force_scale_range);
}

}  // namespace spoonbill
