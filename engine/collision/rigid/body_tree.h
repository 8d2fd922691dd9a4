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

// Indices of two bodies among the boxes of the first and the second tree, or of the same tree.
using BodyPair = std::pair<std::size_t, std::size_t>;

// Tree of the boxes of bodies. Immutable, but queries are not concurrent: one owner, one thread.
class BodyTree {
 public:
  // The `boxes`, in metres, must be finite and may have no volume. Boxes that touch count as near: to find
  // bodies within a distance of each other, grow their boxes by half of that distance.
  explicit BodyTree(const std::vector<Box>& boxes);
  ~BodyTree();
  BodyTree(const BodyTree&) = delete;
  BodyTree& operator=(const BodyTree&) = delete;

  // Returns the pairs whose boxes overlap or touch, in ascending order. Within one tree the first index is
  // below the second; with another tree the first index belongs to this tree.
  std::vector<BodyPair> near_pairs() const;
  std::vector<BodyPair> near_pairs(const BodyTree& other) const;

  // Returns the least value of `distance_m` over the pairs of a body of this tree and one of the other;
  // infinite if a tree is empty. Pairs whose boxes are no nearer than the least value found are skipped, so
  // the value of a pair must not be below the distance of its boxes.
  double find_nearest(const BodyTree& other,
                      const std::function<double(std::size_t, std::size_t)>& distance_m) const;

 private:
  struct Bodies;  // defined in the source, to hide FCL's headers
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace spoonbill
