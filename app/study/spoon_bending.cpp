#include "app/study/spoon_bending.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <optional>
#include <vector>

#include "app/study/spoon_measures.h"
#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/simulation/rest_shape.h"
#include "engine/trial/height_map.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

const Vector3 up = Vector3::UnitY();
constexpr double held_fraction = 1.0 / 3.0;  // of the handle's length
constexpr double shortest_handle_m = 0.02;

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
  const auto [end_m, handle_m] = find_handle(spoon);
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

Bendings bend_all(const StudyPlan& plan, int workers) {
  SPOONBILL_ASSERT(workers >= 1);
  struct Bent {
    const StudySpoon* spoon;
    const Material* material;
    std::optional<SpoonBending> bending;
  };
  std::vector<Bent> all;
  for (const StudySpoon& spoon : plan.spoons) {
    for (const Material& material : plan.materials) all.push_back({&spoon, &material, std::nullopt});
  }
  const double food_kg = find_food_kg(plan.foods.front());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < all.size(); k = next++) {
      auto bending = bend_spoon(*all[k].spoon, *all[k].material, food_kg);
      if (bending) all[k].bending = bending.value();
    }
  };
  std::vector<std::future<void>> crew;
  const auto wanted = std::min(static_cast<std::size_t>(workers), all.size());
  for (std::size_t k = 1; k < wanted; ++k) crew.push_back(std::async(std::launch::async, work));
  work();
  for (std::future<void>& worker : crew) worker.get();
  Bendings bendings;
  for (const Bent& one : all) {
    if (one.bending) bendings.emplace(std::pair{one.spoon->name, one.material->name}, *one.bending);
  }
  return bendings;
}

const SpoonBending* find_bending(const Bendings& bendings, const std::string& spoon,
                                 const std::string& material) {
  const auto found = bendings.find({spoon, material});
  return found != bendings.end() ? &found->second : nullptr;
}

}  // namespace spoonbill
