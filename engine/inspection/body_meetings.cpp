#include "engine/inspection/body_meetings.h"

#include <algorithm>

#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/surfaces/surface_pair_collider.h"

namespace spoonbill {
namespace {

// Cells a quarter of an element wide, as for collisions that are reported.
constexpr int levels = 2;

std::optional<BodyMeeting> meeting_of(const SurfacePairCollider& collider, const PairResult& result) {
  const std::vector<PairContact>& contacts = collider.contacts();
  if (!result.touching || contacts.empty()) return std::nullopt;
  const auto deepest = std::max_element(
      contacts.begin(), contacts.end(),
      [](const PairContact& one, const PairContact& other) { return one.depth_m < other.depth_m; });
  return BodyMeeting{0, 0, result.contained, deepest->depth_m, deepest->pair.first_m};
}

}  // namespace

std::optional<BodyMeetings> find_body_meetings(const std::vector<const Surface*>& bodies,
                                               const Progress& progress) {
  std::vector<Box> boxes;
  boxes.reserve(bodies.size());
  for (const Surface* body : bodies) {
    const Box box = bounding_box(body->net);
    boxes.push_back({box.low.array() - touch_tolerance_m, box.high.array() + touch_tolerance_m});
  }
  BodyMeetings meetings;
  const std::vector<BodyPair> pairs = BodyTree(boxes).near_pairs();
  double done = 0.0;
  for (const auto& [first, second] : pairs) {
    if (!progress.report(done++ / static_cast<double>(pairs.size()))) return std::nullopt;
    const Surface &a = *bodies[first], &b = *bodies[second];
    const auto grid_a = make_nested_grid(a.u, a.v, levels), grid_b = make_nested_grid(b.u, b.v, levels);
    if (!grid_a || !grid_b) {
      meetings.complete = false;
      continue;
    }
    SurfacePairCollider collider(grid_a.value(), grid_b.value());
    PairQuery query;
    query.first_closed = query.second_closed = true;
    const PairResult result = collider.collide(a, b, query);
    meetings.complete = meetings.complete && !result.overflow;
    if (auto meeting = meeting_of(collider, result)) {
      meeting->first = first;
      meeting->second = second;
      meetings.found.push_back(*meeting);
    }
  }
  return meetings;
}

}  // namespace spoonbill
