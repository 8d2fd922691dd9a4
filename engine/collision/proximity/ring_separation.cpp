#include "engine/collision/proximity/ring_separation.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

RingSeparation::RingSeparation(const KnotVector& v, std::vector<std::array<int, 2>> pairs)
    : columns_(v.control_point_count()), width_(v.degree() + 1), pairs_(std::move(pairs)) {
  const std::vector<double> breaks = v.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    const int span = v.find_span(0.5 * (breaks[b] + breaks[b + 1]));
    for (int j = 0; j < width_; ++j) column_.push_back(v.control_index(span, j));
  }
  const std::size_t rings = breaks.size() - 1, columns = static_cast<std::size_t>(columns_);
  near_.reserve(pairs_.size());
  centres_.resize(columns);
  low_.resize(rings * columns);
  high_.resize(rings * columns);
  taken_.resize(rings);
  boxes_.resize(rings);
}

const std::vector<std::array<int, 2>>& RingSeparation::near(const ControlNet& net, SurfaceBounds& bounds,
                                                            double reach_m) {
  SPOONBILL_ASSERT(net.columns == columns_);
  SPOONBILL_ASSERT(reach_m >= 0.0);
  near_.clear();
  bounds.take_boxes(net);
  for (std::size_t ring = 0; ring < boxes_.size(); ++ring) boxes_[ring] = bounds.box(static_cast<int>(ring));
  for (const auto& [one, other] : pairs_) {
    if (boxes_[one].is_near(boxes_[other], reach_m)) near_.push_back({one, other});
  }
  if (near_.empty()) return near_;
  take_centres(net);
  std::fill(taken_.begin(), taken_.end(), char{0});
  const auto apart = [&](const std::array<int, 2>& pair) {
    return are_apart_along(net, pair[0], pair[1], reach_m) || are_apart_along(net, pair[1], pair[0], reach_m);
  };
  near_.erase(std::remove_if(near_.begin(), near_.end(), apart), near_.end());
  return near_;
}

void RingSeparation::take_centres(const ControlNet& net) {
  std::fill(centres_.begin(), centres_.end(), Vector3::Zero());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) centres_[j] += net.point(i, j);
  }
}

// Of all columns along the way from a ring's first control column to its last.
void RingSeparation::take_intervals(const ControlNet& net, int ring) {
  taken_[ring] = 1;
  const int* const column = column_.data() + ring * width_;
  const Vector3 axis = (centres_[column[width_ - 1]] - centres_[column[0]]).normalized();
  double* const low = low_.data() + ring * columns_;
  double* const high = high_.data() + ring * columns_;
  std::fill_n(low, columns_, std::numeric_limits<double>::infinity());
  std::fill_n(high, columns_, -std::numeric_limits<double>::infinity());
  const double a = axis.x(), b = axis.y(), c = axis.z();
  for (int i = 0; i < net.rows; ++i) {
    const std::size_t row = net.index(i, 0);
    const double *const x = net.x.data() + row, *const y = net.y.data() + row, *const z = net.z.data() + row;
    for (int j = 0; j < columns_; ++j) {
      const double along = a * x[j] + b * y[j] + c * z[j];
      low[j] = along < low[j] ? along : low[j];
      high[j] = high[j] < along ? along : high[j];
    }
  }
}

RingSeparation::Interval RingSeparation::interval(int ring, int along) const {
  Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (int k = 0; k < width_; ++k) {
    const int at = along * columns_ + column_[ring * width_ + k];
    all = {std::min(all.low, low_[at]), std::max(all.high, high_[at])};
  }
  return all;
}

bool RingSeparation::are_apart_along(const ControlNet& net, int axis_ring, int other, double reach_m) {
  if (!taken_[axis_ring]) take_intervals(net, axis_ring);
  const Interval own = interval(axis_ring, axis_ring), its = interval(other, axis_ring);
  return its.low > own.high + reach_m || its.high < own.low - reach_m;
}

}  // namespace spoonbill
