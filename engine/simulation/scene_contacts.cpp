#include "engine/simulation/scene_contacts.h"

#include <span>
#include <utility>

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

}  // namespace spoonbill
