// Collides all bodies of one model with all of another: FCL's tree picks the pairs that are near.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/report/contact_facts.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// The bodies of a model as the tree sees them.
struct BodyBoxes {
  std::vector<Box> boxes;          // about each body; at least one
  std::vector<std::string> names;  // of the bodies, or none where a name would say nothing
};

// The box about another that is turned.
Box box_about(const Box& box, const Pose& pose);

// Joins the answers of several pairs of bodies into one: they touch where a pair does, and of others the
// nearest counts.
class BodiesAnswer {
 public:
  BodiesAnswer(std::vector<std::string> names_a, std::vector<std::string> names_b);

  void add(std::size_t a, std::size_t b, CollisionAnswer answer);
  const CollisionAnswer& answer() const { return answer_; }

 private:
  std::vector<std::string> names_a_, names_b_;
  CollisionAnswer answer_;
};

// Collides a body of A with one of B. Of those that do not touch, the distance is searched up to `reach_m`,
// and may be infinite beyond.
using PairCollision = std::function<Result<CollisionAnswer>(std::size_t a, std::size_t b, double reach_m)>;

// An Error of a pair is that of all.
Result<CollisionAnswer> collide_bodies(const BodyBoxes& a, const BodyBoxes& b, const PairCollision& collide);

}  // namespace spoonbill
