#include "engine/collision/rigid/body_tree.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

using Object = fcl::CollisionObject<double>;

// Enlargement of the boxes, as a fraction of the largest coordinate. It is needed because FCL computes with a
// rounded centre and rounded sides.
constexpr double box_rounding = 4.0 * std::numeric_limits<double>::epsilon();

std::size_t body_index(const Object* object) {
  return reinterpret_cast<std::size_t>(object->getUserData());
}

Object make_object(const Box& box, std::size_t index) {
  const double slack = box_rounding * box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
  const Vector3 sides = (box.high - box.low).array() + 2.0 * slack;
  fcl::Transform3d at = fcl::Transform3d::Identity();
  at.translation() = 0.5 * (box.low + box.high);
  Object object(std::make_shared<fcl::Box<double>>(sides), at);
  object.setUserData(reinterpret_cast<void*>(index));
  return object;
}

bool add_pair(Object* first, Object* second, void* pairs) {
  static_cast<std::vector<BodyPair>*>(pairs)->emplace_back(body_index(first), body_index(second));
  return false;  // do not stop the search
}

struct NearestSearch {
  const std::function<double(std::size_t, std::size_t)>& distance_m;
  double least_m = std::numeric_limits<double>::infinity();
};

bool update_nearest(Object* first, Object* second, void* search, double& least) {
  auto& nearest = *static_cast<NearestSearch*>(search);
  nearest.least_m = std::min(nearest.least_m, nearest.distance_m(body_index(first), body_index(second)));
  least = nearest.least_m;
  return false;
}

}  // namespace

struct BodyTree::Bodies {
  std::vector<Object> objects;
  fcl::DynamicAABBTreeCollisionManager<double> tree;
};

BodyTree::BodyTree(const std::vector<Box>& boxes) : bodies_(std::make_unique<Bodies>()) {
  bodies_->objects.reserve(boxes.size());
  std::vector<Object*> registered;
  registered.reserve(boxes.size());
  for (std::size_t index = 0; index < boxes.size(); ++index) {
    const Box& box = boxes[index];
    SPOONBILL_ASSERT(box.low.allFinite() && box.high.allFinite() &&
                     (box.low.array() <= box.high.array()).all());
    bodies_->objects.push_back(make_object(box, index));
    registered.push_back(&bodies_->objects.back());
  }
  if (!registered.empty()) bodies_->tree.registerObjects(registered);
  bodies_->tree.setup();
}

BodyTree::~BodyTree() = default;

std::vector<BodyPair> BodyTree::near_pairs() const {
  std::vector<BodyPair> pairs;
  if (bodies_->objects.size() < 2) return pairs;
  bodies_->tree.collide(&pairs, add_pair);
  for (BodyPair& pair : pairs) {
    if (pair.second < pair.first) std::swap(pair.first, pair.second);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<BodyPair> BodyTree::near_pairs(const BodyTree& other) const {
  std::vector<BodyPair> pairs;
  if (bodies_->objects.empty() || other.bodies_->objects.empty()) return pairs;
  bodies_->tree.collide(&other.bodies_->tree, &pairs, add_pair);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

double BodyTree::find_nearest(const BodyTree& other,
                              const std::function<double(std::size_t, std::size_t)>& distance_m) const {
  NearestSearch search{distance_m};
  if (bodies_->objects.empty() || other.bodies_->objects.empty()) return search.least_m;
  bodies_->tree.distance(&other.bodies_->tree, &search, update_nearest);
  return search.least_m;
}

}  // namespace spoonbill
