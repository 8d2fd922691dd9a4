#include "engine/simulation/scene_contacts.h"

#include <span>
#include <utility>

#include "engine/simulation/simulation_state.h"

namespace spoonbill {
namespace {

std::vector<BodyPairContact> make_pairs(const std::vector<BodyState>& bodies) {
  std::vector<BodyPairContact> pairs;
  for (std::size_t second = 1; second < bodies.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      pairs.emplace_back(bodies[first], bodies[second]);
    }
  }
  return pairs;
}

// Largest number of constraints between bodies. Two handles pressed against each other need some hundreds.
constexpr int contact_capacity = 8192;

}  // namespace

SceneContacts make_scene_contacts(const std::vector<BodyState>& bodies, const ContactScene& scene,
                                  const ToolModel& model) {
  const std::span<const BodyState> scene_bodies(bodies.data(), scene.body_count);
  return {ToolContact(scene_bodies, model),
          ToolContact(scene_bodies, model),
          BodyContacts(contact_capacity),
          make_pairs(bodies),
          {bodies.begin(), bodies.end()},
          SearchedShapes(bodies),
          BodyGroundContact(scene_bodies.first(scene.has_ground ? scene.body_count : 0)),
          {scene_bodies.begin(), scene_bodies.end()},
          {scene_bodies.begin(), scene_bodies.end()}};
}

ContactScene find_contact_scene(const Scene& scene) {
  return {scene.bodies.size(), scene.ground.has_value()};
}

void exchange_contacts(Simulation::State& state, SceneContacts& contacts) {
  std::swap(state.tool.contact, contacts.tool);
  std::swap(state.mirrored.contact, contacts.mirrored);
  std::swap(state.between, contacts.between);
  state.pairs.swap(contacts.pairs);
  state.self.swap(contacts.self);
  std::swap(state.searched, contacts.searched);
  std::swap(state.ground_contact, contacts.ground);
  state.rigid_ground.swap(contacts.rigid_ground);
  state.sampled_ground.swap(contacts.sampled_ground);
}

void make_contacts(Simulation::State& state) {
  SceneContacts made = make_scene_contacts(state.bodies, find_contact_scene(state.scene), state.model);
  exchange_contacts(state, made);
}

}  // namespace spoonbill
