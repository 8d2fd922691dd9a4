#include "engine/simulation/rest_shape.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/material/lattice/body_coordinates.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {
namespace {

Vector3 final_displacement(const Support& support) {
  if (!support.motion || support.motion->kind == MotionKind::oscillation) return Vector3::Zero();
  return support.motion->displacement_m;
}

std::vector<FixedAxis> find_fixed_axes(const BodyState& state, const Body& body) {
  std::vector<Vector3> displacement_m(state.fixed.size(), Vector3::Zero());
  for (std::size_t s = 0; s < body.supports.size(); ++s) {
    for (const int node : state.supports.supports()[s].nodes) {
      displacement_m[static_cast<std::size_t>(node)] = final_displacement(body.supports[s]);
    }
  }
  std::vector<FixedAxis> fixed;
  for (std::size_t n = 0; n < displacement_m.size(); ++n) {
    if (state.fixed[n] != 0) fix_node(static_cast<int>(n), displacement_m[n], fixed);
  }
  return fixed;
}

// Returns the principal Green-Lagrange strain of the largest magnitude at a point of a cell. It is computed
// from the displacement gradient, because the deformation gradient would round away the digits of a small
// strain.
double principal_strain(const CellCorners& rest, const CellCorners& bent, const Vector3& at) {
  const Eigen::Matrix3d jacobian = trilinear_jacobian(rest, at.x(), at.y(), at.z());
  const Eigen::Matrix3d gradient =
      (trilinear_jacobian(bent, at.x(), at.y(), at.z()) - jacobian) * jacobian.inverse();
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose() + gradient.transpose() * gradient);
  const Vector3 principal = decompose_symmetric(strain).values;
  return principal[std::abs(principal[0]) > std::abs(principal[2]) ? 0 : 2];
}

void find_strain(const LatticeMesh& bent, RestShape& shape) {
  for (int i = 0; i + 1 < bent.count[0]; ++i) {
    for (int j = 0; j + 1 < bent.count[1]; ++j) {
      for (int k = 0; k + 1 < bent.count[2]; ++k) {
        if (!bent.is_filled(i, j, k)) continue;
        const CellCorners corners = shape.mesh.cell(i, j, k), moved = bent.cell(i, j, k);
        for (int face = 0; face < 6; ++face) {
          Vector3 at = Vector3::Constant(0.5);
          at[face / 2] = face % 2;
          const double strain = principal_strain(corners, moved, at);
          if (std::abs(strain) <= std::abs(shape.largest_strain)) continue;
          shape.largest_strain = strain;
          shape.largest_strain_position_m = trilinear(corners, at.x(), at.y(), at.z());
        }
      }
    }
  }
}

void measure(const StaticBody& body, const StaticLoads& loads, RestShape& shape) {
  LatticeMesh bent = shape.mesh;
  const std::vector<Vector3>& moved = shape.result.displacement_m;
  double furthest_m = -1.0;
  for (std::size_t n = 0; n < moved.size(); ++n) {
    bent.nodes[n] += moved[n];
    shape.reaction_n += shape.result.reaction_n[n];
    shape.load_n += body.mass_kg(static_cast<int>(n)) * loads.gravity_m_per_s2;
    const bool beside = !bent.node_locations.empty() && bent.node_locations[n] == NodeLocation::outside_body;
    if (beside || moved[n].norm() <= furthest_m) continue;
    furthest_m = moved[n].norm();
    shape.furthest_node = static_cast<int>(n);
  }
  for (const NodeForce& force : loads.forces) shape.load_n += force.force_n;
  for (const PressedFace& face : loads.pressures) {
    const auto at = [&](std::size_t c) { return bent.nodes[static_cast<std::size_t>(face.nodes[c])]; };
    shape.load_n -= face.pressure_pa * vector_area(at(0), at(1), at(2), at(3));
  }
  PressedSkin skin = loads.pressed_skin;
  skin.find_forces([&](int node) { return bent.nodes[static_cast<std::size_t>(node)]; },
                   [&](int, const Vector3& force_n) { shape.load_n += force_n; });
  find_strain(bent, shape);
}

}  // namespace

Result<RestShape> compute_rest_shape(const Scene& scene, int body, const Progress& progress) {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(scene.bodies.size()));
  const Body& definition = scene.bodies[static_cast<std::size_t>(body)];
  if (definition.kind != BodyKind::deformable) {
    return Error{ErrorCode::unsupported, "only a deformable body has a rest shape under load", "kind"};
  }
  Result<BodyState> state = make_body_state(definition, scene.planes, InstructionSet::baseline);
  if (!state.ok()) return state.error();
  const std::vector<FixedAxis> fixed = find_fixed_axes(state.value(), definition);
  if (fixed.empty())
    return Error{ErrorCode::missing,
                 "nothing fixes the body; give it a support or the document a fixing plane"};
  const Result<StaticBody> body_at_rest =
      StaticBody::make(state->lattice.mesh(), state->lattice.materials(), CellKind::hexahedra);
  if (!body_at_rest.ok()) return body_at_rest.error();
  const StaticLoads loads{scene.sculpting.gravity_m_per_s2, state->loads.forces(), state->loads.pressures(),
                          state->loads.pressed_skin()};
  StaticSettings settings;
  settings.progress = progress;
  Result<StaticResult> result = rest_under_load(body_at_rest.value(), loads, fixed, settings);
  if (!result.ok()) return result.error();
  RestShape shape{state->lattice.mesh(), std::move(result).value(), definition.surface};
  shape.fixed_nodes = static_cast<int>(fixed.size() / 3);
  measure(body_at_rest.value(), loads, shape);
  for (int n = 0; n < shape.mesh.node_count(); ++n) {
    state->lattice.set_displacement(n, shape.result.displacement_m[static_cast<std::size_t>(n)]);
  }
  state->update_skin();
  shape.surface = state->mapping().current();
  return shape;
}

}  // namespace spoonbill
