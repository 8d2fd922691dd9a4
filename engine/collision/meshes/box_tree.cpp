#include "engine/collision/meshes/box_tree.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

struct Item {
  std::array<float, 3> middle;
  std::uint32_t index;
};

// Which items a node shall have, and who its parent is if it is a right child.
struct NodeItems {
  std::uint32_t begin, end;
  std::uint32_t right_of;
};

constexpr std::uint32_t none = 0xffffffffU;

std::vector<Item> items_of(const std::vector<Box>& boxes) {
  std::vector<Item> items(boxes.size());
  for (std::uint32_t k = 0; k < items.size(); ++k) {
    const Eigen::Vector3f middle = (0.5 * (boxes[k].low + boxes[k].high)).cast<float>();
    items[k] = {{middle.x(), middle.y(), middle.z()}, k};
  }
  return items;
}

int longest_axis(const std::vector<Item>& items, const NodeItems& range) {
  std::array<float, 3> low = items[range.begin].middle, high = low;
  for (std::uint32_t k = range.begin; k < range.end; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], items[k].middle[axis]);
      high[axis] = std::max(high[axis], items[k].middle[axis]);
    }
  }
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  }
  return longest;
}

void halve(std::vector<Item>& items, const NodeItems& range, std::uint32_t middle) {
  const int axis = longest_axis(items, range);
  std::nth_element(items.begin() + range.begin, items.begin() + middle, items.begin() + range.end,
                   [axis](const Item& a, const Item& b) {
                     return a.middle[axis] != b.middle[axis] ? a.middle[axis] < b.middle[axis]
                                                             : a.index < b.index;
                   });
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes, std::uint32_t leaf_size) {
  SPOONBILL_ASSERT(!boxes.empty() && leaf_size >= 1);
  SPOONBILL_ASSERT_DEBUG(std::all_of(boxes.begin(), boxes.end(), [](const Box& box) {
    return (box.low.array() <= box.high.array()).all();
  }));
  std::vector<Item> items = items_of(boxes);
  std::vector<NodeItems> waiting = {{0, static_cast<std::uint32_t>(items.size()), none}};
  while (!waiting.empty()) {
    const NodeItems range = waiting.back();
    waiting.pop_back();
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    if (range.right_of != none) nodes_[range.right_of].first = index;
    const std::uint32_t count = range.end - range.begin;
    const Box none_yet{Vector3::Zero(), Vector3::Zero()};
    nodes_.push_back({none_yet, range.begin, count <= leaf_size ? count : 0});
    if (count <= leaf_size) continue;
    const std::uint32_t middle = range.begin + count / 2;
    halve(items, range, middle);
    waiting.push_back({middle, range.end, index});
    waiting.push_back({range.begin, middle, none});
  }
  order_.reserve(items.size());
  for (const Item& item : items) order_.push_back(item.index);
  refit([&](std::uint32_t place) { return boxes[order_[place]]; });
}

}  // namespace spoonbill
