#include "engine/simulation/contact_snapshots.h"

#include <cstddef>
#include <optional>

namespace spoonbill {
namespace {

ContactSnapshot snapshot_of(std::size_t body, const BodyState& state, const SurfaceContact& contact) {
  ContactSnapshot snapshot;
  snapshot.body = static_cast<int>(body);
  snapshot.point_m = contact.point_m;
  snapshot.normal = contact.normal;
  snapshot.tangent_u = contact.tangent_u;
  snapshot.tangent_v = contact.tangent_v;
  snapshot.depth_m = contact.depth_m;
  snapshot.u = contact.u;
  snapshot.v = contact.v;
  snapshot.nodes = state.mapping().at(contact.u, contact.v);
  return snapshot;
}

// The tool's, with each body it is near.
void add_of_tool(const Simulation::State& s, std::vector<ContactSnapshot>& contacts) {
  if (!s.reaction.touching) return;
  for (std::size_t b = 0; b < s.scene.bodies.size(); ++b) {
    const CollisionResult& collision = s.tool.contact.collision(static_cast<int>(b));
    if (collision.found) contacts.push_back(snapshot_of(b, s.bodies[b], collision.nearest));
  }
}

// Of two bodies that push each other, on the surface of each.
void add_of_pair(const Simulation::State& s, const BodyPairContact& pair, std::size_t first,
                 std::size_t second, std::vector<ContactSnapshot>& contacts) {
  if (!s.between.acted(static_cast<int>(first), static_cast<int>(second))) return;
  const auto add = [&](std::size_t body, const std::optional<SurfaceSpot>& spot) {
    if (!spot) return;
    const BodyState& state = s.bodies[body];
    contacts.push_back(snapshot_of(body, state, contact_at(state.mapping().current(), *spot)));
  };
  add(first, pair.deepest_on_first(s.bodies[first]));
  add(second, pair.deepest_on_second());
}

}  // namespace

void write_contacts(const Simulation::State& s, std::vector<ContactSnapshot>& contacts) {
  contacts.reserve(s.scene.bodies.size() + 2 * s.pairs.size());
  contacts.clear();
  add_of_tool(s, contacts);
  auto pair = s.pairs.begin();
  for (std::size_t second = 1; second < s.stepped(); ++second) {
    for (std::size_t first = 0; first < second; ++first, ++pair) {
      add_of_pair(s, *pair, first, second, contacts);
    }
  }
}

}  // namespace spoonbill
