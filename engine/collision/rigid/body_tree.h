// The broad phase: which of many bodies may meet, by FCL's dynamic tree over their boxes. For loading,
// checking and reports; never in the tick, for it allocates.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// A body's place among the boxes of a first tree and of a second, or of one and the same.
using BodyPair = std::pair<std::size_t, std::size_t>;

// Immutable once made, but searching takes turns: one owner, one thread.
class BodyTree {
 public:
  // Finite boxes in metres, low corner first; they may be empty of volume. A pair of boxes that touch counts
  // as near: grow them by half of what bodies may be apart.
  explicit BodyTree(const std::vector<Box>& boxes);
  ~BodyTree();
  BodyTree(const BodyTree&) = delete;
  BodyTree& operator=(const BodyTree&) = delete;

  // The pairs whose boxes overlap or touch, in ascending order: within this tree with the first below the
  // second, or of this tree's bodies with those of the other.
  std::vector<BodyPair> near_pairs() const;
  std::vector<BodyPair> near_pairs(const BodyTree& other) const;

  // Calls `distance_m` with pairs of this tree's bodies and the other's until no other pair of boxes is
  // nearer than the least distance that it returned, and returns that; infinity where a tree is empty. The
  // distance must not be below that of the boxes.
  double find_nearest(const BodyTree& other,
                      const std::function<double(std::size_t, std::size_t)>& distance_m) const;

 private:
  struct Bodies;  // FCL's headers stay out of ours
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace spoonbill
