#include "engine/collision/levels/element_tree.h"

#include <algorithm>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

ElementTree::Direction ElementTree::unroll(const KnotVector& knots) {
  Direction direction{knots.degree(), {}, {}};
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    direction.first_control.push_back(static_cast<int>(direction.control.size()));
    const int span = knots.find_span(0.5 * (breaks[b] + breaks[b + 1]));
    for (int j = 0; j <= knots.degree(); ++j) direction.control.push_back(knots.control_index(span, j));
  }
  return direction;
}

ElementTree::ElementTree(const KnotVector& u, const KnotVector& v) : u_(unroll(u)), v_(unroll(v)) {
  leaf_.resize(static_cast<std::size_t>(u_.elements() * v_.elements()));
  add({0, u_.elements(), 0, v_.elements()});
  boxes_.resize(nodes_.size());
  sizes_.resize(nodes_.size());
  strip_.resize(static_cast<std::size_t>(v_.elements()));
  bulges_.resize(static_cast<std::size_t>(v_.elements()));
}

int ElementTree::add(const Node& range) {
  const int index = static_cast<int>(nodes_.size()), long_u = range.end_u - range.first_u,
            long_v = range.end_v - range.first_v;
  nodes_.push_back(range);
  if (long_u == 1 && long_v == 1) {
    leaf_[range.first_u * v_.elements() + range.first_v] = index;
    return index;
  }
  Node low = range, high = range;
  if (long_u >= long_v) {
    low.end_u = high.first_u = range.first_u + long_u / 2;
  } else {
    low.end_v = high.first_v = range.first_v + long_v / 2;
  }
  const int left = add(low), right = add(high);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

void ElementTree::update(SurfaceLevels& levels) {
  SPOONBILL_ASSERT_DEBUG(levels.surface().u.breakpoints().size() ==
                         static_cast<std::size_t>(u_.elements()) + 1);
  levels.bounds().update(levels.surface().net);
  for (int e = 0; e < u_.elements(); ++e) take_strip(levels, e);
  join_boxes();
}

void ElementTree::join_boxes() {
  for (int index = static_cast<int>(nodes_.size()) - 1; index >= 0; --index) {
    const Node& node = nodes_[index];
    if (node.is_leaf()) continue;
    boxes_[index] = joined(boxes_[node.left], boxes_[node.right]);
    sizes_[index] = (boxes_[index].high - boxes_[index].low).sum();
  }
}

int ElementTree::leaf_near(const Vector3& point) const {
  SPOONBILL_ASSERT(!boxes_.empty());
  int nearest = leaf_[0];
  double least = std::numeric_limits<double>::infinity();
  for (const int leaf : leaf_) {
    const double squared = (0.5 * (boxes_[leaf].low + boxes_[leaf].high) - point).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    nearest = leaf;
  }
  return nearest;
}

// Where the surface may leave its corners by more than they are apart, its control points tell more.
void ElementTree::take_strip(SurfaceLevels& levels, int element_u) {
  levels.element_boxes(element_u, strip_.data(), bulges_.data());
  for (int element_v = 0; element_v < v_.elements(); ++element_v) {
    const int index = leaf_[element_u * v_.elements() + element_v];
    Box& box = boxes_[index];
    box = strip_[element_v];
    sizes_[index] = (box.high - box.low).sum();
    // Six bulges are in the sum.
    if (bulges_[element_v] <= 0.1 * sizes_[index]) continue;
    const Box hull = hull_of(levels.surface().net, element_u, element_v);
    box = {box.low.cwiseMax(hull.low), box.high.cwiseMin(hull.high)};
    sizes_[index] = (box.high - box.low).sum();
  }
}

Box ElementTree::hull_of(const ControlNet& net, int element_u, int element_v) const {
  const int* const rows = u_.control.data() + u_.first_control[element_u];
  const int* const columns = v_.control.data() + v_.first_control[element_v];
  Box box;
  for (int i = 0; i <= u_.degree; ++i) {
    for (int j = 0; j <= v_.degree; ++j) box.include(net.point(rows[i], columns[j]));
  }
  return box;
}

}  // namespace spoonbill
