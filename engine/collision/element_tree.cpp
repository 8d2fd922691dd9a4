#include "engine/collision/element_tree.h"

#include <algorithm>

namespace spoonbill {
namespace {

Box joined(const Box& a, const Box& b) {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

}  // namespace

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
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis].resize(static_cast<std::size_t>(v.control_point_count()));
    high_[axis].resize(static_cast<std::size_t>(v.control_point_count()));
  }
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

// The boxes of the elements (element_u, .): first over the rows of their control points, all columns at once.
void ElementTree::take_strip(SurfaceLevels& levels, int element_u) {
  const ControlNet& net = levels.surface().net;
  const int* rows = u_.control.data() + u_.first_control[element_u];
  const std::vector<double>* coordinates[3] = {&net.x, &net.y, &net.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* values = coordinates[axis]->data();
    double* const low = low_[axis].data();
    double* const high = high_[axis].data();
    std::copy_n(values + rows[0] * net.columns, net.columns, low);
    std::copy_n(values + rows[0] * net.columns, net.columns, high);
    for (int k = 1; k <= u_.degree; ++k) {
      const double* const row = values + rows[k] * net.columns;
      for (int j = 0; j < net.columns; ++j) {
        low[j] = row[j] < low[j] ? row[j] : low[j];
        high[j] = high[j] < row[j] ? row[j] : high[j];
      }
    }
  }
  for (int e = 0; e < v_.elements(); ++e) {
    const int* columns = v_.control.data() + v_.first_control[e];
    Box& box = boxes_[leaf_[element_u * v_.elements() + e]];
    box = levels.element_box(element_u, e);
    for (int axis = 0; axis < 3; ++axis) {
      double low = low_[axis][columns[0]], high = high_[axis][columns[0]];
      for (int k = 1; k <= v_.degree; ++k) {
        low = std::min(low, low_[axis][columns[k]]);
        high = std::max(high, high_[axis][columns[k]]);
      }
      box.low[axis] = std::max(box.low[axis], low);
      box.high[axis] = std::min(box.high[axis], high);
    }
    sizes_[leaf_[element_u * v_.elements() + e]] = (box.high - box.low).sum();
  }
}

}  // namespace spoonbill
