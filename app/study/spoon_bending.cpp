#include "app/study/spoon_bending.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/simulation/rest_shape.h"
#include "engine/trial/height_map.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

const Vector3 up = Vector3::UnitY();
constexpr double held_fraction = 1.0 / 3.0;  // of the handle's length
constexpr double shortest_handle_m = 0.02;

// Returns the end of the spoon behind the bowl, as a distance from the rim's centre along the front.
double find_end_m(const StudySpoon& spoon) {
  constexpr int steps = 200;
  const Surface& surface = spoon.body.surface;
  double end_m = infinity;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const Vector3 point = position(surface, surface.u.parameter_at(static_cast<double>(i) / steps),
                                     surface.v.parameter_at(static_cast<double>(j) / steps));
      end_m = std::min(end_m, spoon.bowl.front.dot(point - spoon.bowl.centre_m));
    }
  }
  return end_m;
}

}  // namespace

Result<LeverBending> bend_lever(const HeldLever& lever, double load_kg) {
  Scene scene;
  scene.bodies = {lever.body};
  scene.planes = {lever.hand};
  scene.sculpting.gravity_m_per_s2 = -standard_gravity_m_per_s2 * up;
  Body& body = scene.bodies.front();
  body.lattice = {};
  body.lattice.node_budget = bending_node_budget;
  if (load_kg > 0.0) {
    body.loads = {PointLoad{lever.loaded.x(), lever.loaded.y(), -load_kg * standard_gravity_m_per_s2 * up}};
  }
  const auto shape = compute_rest_shape(scene, 0);
  if (!shape) return shape.error();
  const auto height_m = [&](const Surface& surface) {
    return up.dot(position(surface, lever.measured.x(), lever.measured.y()));
  };
  double behind_m = infinity;
  for (const Vector3& node : shape->mesh.nodes) {
    const double ahead_m = lever.hand.normal.dot(node - lever.hand.point_m);
    if (ahead_m <= 0.0) behind_m = std::min(behind_m, -ahead_m);
  }
  return LeverBending{height_m(body.surface) - height_m(shape->surface), std::abs(shape->largest_strain),
                      behind_m};
}

Result<SpoonBending> bend_spoon(const StudySpoon& spoon, const Material& material, double food_kg) {
  const Bowl& bowl = spoon.bowl;
  const double end_m = find_end_m(spoon), handle_m = -0.5 * bowl.length_m - end_m;
  if (handle_m < shortest_handle_m) {
    return Error{ErrorCode::unsupported,
                 spoon.file.string() + ": the spoon has no handle that a hand could hold"};
  }
  HeldLever lever;
  lever.body = spoon.body;
  lever.body.kind = BodyKind::deformable;
  lever.body.material = material;
  lever.body.material.plastic = false;
  lever.body.regions.clear();
  SpoonBending bending;
  bending.hand_m = held_fraction * handle_m;
  const Vector3 level_front = (bowl.front - up.dot(bowl.front) * up).normalized();
  lever.hand = {bowl.centre_m + (end_m + bending.hand_m) * bowl.front, level_front};
  const HeightMap map(spoon.body.surface, up, 0.4e-3);
  lever.loaded = map.cell_at(map.plan(bowl.centre_m)).parameters;
  lever.measured = bowl.rim.front();
  const auto own = bend_lever(lever, 0.0);
  if (!own) return own.error();
  const auto with_food = bend_lever(lever, food_kg);
  if (!with_food) return with_food.error();
  bending.hand_m -= own->behind_plane_m;
  bending.own_weight = own.value();
  bending.with_food = with_food.value();
  return bending;
}

}  // namespace spoonbill
