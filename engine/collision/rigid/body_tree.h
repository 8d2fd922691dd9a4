// Broad phase over many bodies by FCL's dynamic tree of boxes. For loading, checks and reports, not for the
// tick, because it allocates.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Indices of two bodies, in the boxes of the first and second tree or of the same tree.
using BodyPair = std::pair<std::size_t, std::size_t>;

// Tree of the boxes of bodies. Immutable, but queries are not concurrent: one owner, one thread.
class BodyTree {
 public:
  // `boxes` are finite, in metres, and may have no volume. Boxes that touch count as near: grow them by half
  // the distance that bodies may be apart.
  explicit BodyTree(const std::vector<Box>& boxes);
  ~BodyTree();
  BodyTree(const BodyTree&) = delete;
  BodyTree& operator=(const BodyTree&) = delete;

  // Returns the pairs whose boxes overlap or touch, in ascending order. Within one tree the first index is
  // below the second; with another tree the first index is of this one.
  std::vector<BodyPair> near_pairs() const;
  std::vector<BodyPair> near_pairs(const BodyTree& other) const;

  // Returns the least value of `distance_m` over the pairs of this tree's bodies and the other's. It is
  // called until no other pair of boxes is nearer than that. Infinite if a tree is empty. The distance must
  // not be below that of the boxes.
  double find_nearest(const BodyTree& other,
                      const std::function<double(std::size_t, std::size_t)>& distance_m) const;

 private:
  struct Bodies;  // defined in the source, to hide FCL's headers
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace spoonbill
