// Search over many bodies for pairs with near boxes, by FCL's dynamic tree. It allocates, and is therefore
// for loading, checks and reports, not for the tick.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Indices of two bodies: the first in this tree, the second in the other tree or in the same tree.
using BodyPair = std::pair<std::size_t, std::size_t>;

// Tree of the boxes of bodies. Immutable, but not thread-safe: queries must not run concurrently.
class BodyTree {
 public:
  // The `boxes`, in metres, must be finite and may have no volume. Boxes that touch count as near: to find
  // bodies within a distance of each other, grow their boxes by half of that distance.
  explicit BodyTree(const std::vector<Box>& boxes);
  ~BodyTree();
  BodyTree(const BodyTree&) = delete;
  BodyTree& operator=(const BodyTree&) = delete;

  // Returns the pairs whose boxes overlap or touch, in ascending order. With another tree, the first index
  // belongs to this tree. Without one, the first index is less than the second.
  std::vector<BodyPair> near_pairs() const;
  std::vector<BodyPair> near_pairs(const BodyTree& other) const;

  // Returns the smallest value of `distance_m` over the pairs of a body of this tree and a body of the other;
  // infinite if a tree is empty. Skips pairs whose boxes are no nearer than the smallest value found so far,
  // so the value of a pair must not be less than the distance of its boxes.
  double find_nearest(const BodyTree& other,
                      const std::function<double(std::size_t, std::size_t)>& distance_m) const;

 private:
  struct Bodies;  // defined in the source, to hide FCL's headers
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace spoonbill
