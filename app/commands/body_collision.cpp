#include "app/commands/body_collision.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/rigid/body_tree.h"

namespace spoonbill {
namespace {

// So that bodies which touch to the tolerance are near.
std::vector<Box> grown(std::vector<Box> boxes) {
  for (Box& box : boxes) box = {box.low.array() - touch_tolerance_m, box.high.array() + touch_tolerance_m};
  return boxes;
}

std::string name_at(const std::vector<std::string>& names, std::size_t body) {
  return names.empty() ? std::string() : names[body];
}

}  // namespace

Box box_about(const Box& box, const Pose& pose) {
  const Eigen::Matrix3d turn = pose.orientation.normalized().toRotationMatrix();
  const Vector3 centre = turn * (0.5 * (box.low + box.high)) + pose.position_m;
  const Vector3 half = turn.cwiseAbs() * (0.5 * (box.high - box.low));
  return {centre - half, centre + half};
}

BodiesAnswer::BodiesAnswer(std::vector<std::string> names_a, std::vector<std::string> names_b)
    : names_a_(std::move(names_a)), names_b_(std::move(names_b)) {
  answer_.distance_m = std::numeric_limits<double>::infinity();
}

void BodiesAnswer::add(std::size_t a, std::size_t b, CollisionAnswer answer) {
  const auto name = [&](ContactSide& side_a, ContactSide& side_b) {
    side_a.body = name_at(names_a_, a);
    side_b.body = name_at(names_b_, b);
  };
  answer_.touching |= answer.touching;
  answer_.contained |= answer.contained;
  answer_.complete &= answer.complete;
  if (!answer.touching && answer.distance_m < answer_.distance_m) {
    name(answer.nearest_a, answer.nearest_b);
    answer_.distance_m = answer.distance_m;
    answer_.nearest_a = std::move(answer.nearest_a);
    answer_.nearest_b = std::move(answer.nearest_b);
  }
  for (ContactOfTwo& contact : answer.contacts) {
    name(contact.a, contact.b);
    answer_.contacts.push_back(std::move(contact));
  }
}

Result<CollisionAnswer> collide_bodies(const BodyBoxes& a, const BodyBoxes& b, const PairCollision& collide) {
  const BodyTree bodies(grown(a.boxes)), others(grown(b.boxes));
  BodiesAnswer together(a.names, b.names);
  std::set<BodyPair> known;
  std::optional<Error> error;
  const auto add = [&](std::size_t i, std::size_t j) {
    auto answer = collide(i, j, together.answer().distance_m);
    if (!answer) {
      error = answer.error();
      return;
    }
    known.emplace(i, j);
    together.add(i, j, std::move(answer).value());
  };
  for (const auto& [i, j] : bodies.near_pairs(others)) {
    if (!error) add(i, j);
  }
  if (!error && !together.answer().touching) {
    bodies.find_nearest(others, [&](std::size_t i, std::size_t j) {
      if (!error && !known.contains({i, j})) add(i, j);
      return error ? 0.0 : together.answer().distance_m;
    });
  }
  if (error) return *error;
  return together.answer();
}

}  // namespace spoonbill
