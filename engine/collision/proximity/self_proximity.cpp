#include "engine/collision/proximity/self_proximity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

namespace {

// Smallest cosine of the angle between a direction and the inward normal for which the direction counts as
// leading into the body.
constexpr double inward_cosine = 0.3;
// Least thickness of a body, in lattice cells. Facing points at a smaller distance are on two parts that
// already touch in the rest shape.
constexpr double least_thickness_cells = 0.25;
// Largest numbers of blocks into which the surface is divided along u and v to find neighbours.
constexpr int most_blocks_u = 32, most_blocks_v = 64;

std::vector<double> block_starts(const KnotVector& knots, int most) {
  const std::vector<double> breaks = knots.breakpoints();
  const int elements = static_cast<int>(breaks.size()) - 1, count = std::min(elements, most);
  std::vector<double> starts;
  for (int k = 0; k <= count; ++k) starts.push_back(breaks[static_cast<std::size_t>(k * elements / count)]);
  return starts;
}

int find_block(const std::vector<double>& starts, double parameter) {
  const auto next = std::upper_bound(starts.begin(), starts.end(), parameter) - starts.begin();
  return std::clamp(static_cast<int>(next) - 1, 0, static_cast<int>(starts.size()) - 2);
}

}  // namespace

RestPairs::RestPairs(const Grid& grid, Surface rest, double cell_m)
    : rest_(std::move(rest)),
      u_(block_starts(rest_.u, most_blocks_u)),
      v_(block_starts(rest_.v, most_blocks_v)),
      cell_m_(cell_m) {
  SPOONBILL_ASSERT(cell_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(rest_.u == grid.u.knots && rest_.v == grid.v.knots);
  points_.reserve(static_cast<std::size_t>(grid.rows() * grid.columns()));
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) points_.push_back(point_at(u, v));
  }
  neighbour_distance_m_ =
      std::max(neighbour_cells * cell_m, neighbour_thicknesses * thickness(grid.columns()));
  find_neighbours();
}

// Returns the body's thickness, twice the volume divided by the area. Both are computed from the triangles
// between the samples.
double RestPairs::thickness(int columns) const {
  double volume = 0.0, area = 0.0;
  const auto add = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    volume += a.dot(b.cross(c)) / 6.0;
    area += 0.5 * (b - a).cross(c - a).norm();
  };
  const Vector3& origin = points_.front().position_m;
  const auto at = [&](int index) -> Vector3 { return points_[index].position_m - origin; };
  for (int k = 0; k + columns + 1 < static_cast<int>(points_.size()); ++k) {
    if (k % columns == columns - 1) continue;
    add(at(k), at(k + columns), at(k + 1));
    add(at(k + columns + 1), at(k + 1), at(k + columns));
  }
  return area > 0.0 ? 2.0 * std::abs(volume) / area : 0.0;
}

RestPairs::RestPoint RestPairs::point_at(double u, double v) const {
  const int across = static_cast<int>(v_.size()) - 1;
  return {position(rest_, u, v), unit_normal(rest_, u, v), find_block(u_, u) * across + find_block(v_, v)};
}

void RestPairs::find_neighbours() {
  for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v_.size(); ++j) {
      block_centres_.push_back(position(rest_, 0.5 * (u_[i] + u_[i + 1]), 0.5 * (v_[j] + v_[j + 1])));
    }
  }
  const std::size_t count = block_centres_.size();
  std::vector<double> distances(count);
  neighbours_.assign(count * count, false);
  for (std::size_t block = 0; block < count; ++block) {
    measure_from(static_cast<int>(block), distances);
    for (std::size_t k = 0; k < count; ++k)
      neighbours_[block * count + k] = distances[k] <= neighbour_distance_m_;
  }
}

// Computes the lengths of the shortest paths from one block to the others (Dijkstra's algorithm), up to
// neighbour_distance_m_.
void RestPairs::measure_from(int block, std::vector<double>& distances) const {
  using Path = std::pair<double, int>;
  std::priority_queue<Path, std::vector<Path>, std::greater<>> queue;
  std::fill(distances.begin(), distances.end(), std::numeric_limits<double>::infinity());
  const int rows = static_cast<int>(u_.size()) - 1, columns = static_cast<int>(v_.size()) - 1;
  const auto offer = [&](int to, double distance) {
    if (distance > neighbour_distance_m_ || distance >= distances[to]) return;
    distances[to] = distance;
    queue.push({distance, to});
  };
  offer(block, 0.0);
  while (!queue.empty()) {
    const auto [distance, at] = queue.top();
    queue.pop();
    if (distance > distances[at]) continue;
    const int i = at / columns, j = at % columns;
    for (int row = i - 1; row <= i + 1; ++row) {
      if (!rest_.u.is_periodic() && (row < 0 || row >= rows)) continue;
      for (int column = j - 1; column <= j + 1; ++column) {
        if (!rest_.v.is_periodic() && (column < 0 || column >= columns)) continue;
        const int to = (row + rows) % rows * columns + (column + columns) % columns;
        offer(to, distance + step_between(at, to));
      }
    }
    // At a pole, all blocks of the column are neighbours, so a path may step from any of them to any other.
    if (rest_.v.is_periodic() || (j != 0 && j != columns - 1)) continue;
    for (int row = 0; row < rows; ++row) {
      offer(row * columns + j, distance + step_between(at, row * columns + j));
    }
  }
}

double RestPairs::step_between(int block, int other) const {
  return (block_centres_[block] - block_centres_[other]).norm();
}

bool RestPairs::can_meet(double u, double v, double other_u, double other_v) const {
  return can_meet(point_at(u, v), point_at(other_u, other_v));
}

bool RestPairs::can_meet(const RestPoint& one, const RestPoint& other) const {
  const Vector3 between = other.position_m - one.position_m;
  const double distance = between.norm();
  if (distance > through_body * neighbour_distance_m_) return true;
  const double enough = -inward_cosine * distance;
  const bool inward = between.dot(one.normal) < enough && -between.dot(other.normal) < enough;
  if (inward && distance > least_thickness_cells * cell_m_) return false;
  if (distance > neighbour_distance_m_) return true;
  return !neighbours_[static_cast<std::size_t>(one.block) * block_centres_.size() +
                      static_cast<std::size_t>(other.block)];
}

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
  is_current_.resize(rings);
  boxes_.resize(rings);
}

const std::vector<std::array<int, 2>>& RingSeparation::find_near(const ControlNet& net, SurfaceBounds& bounds,
                                                                 double reach_m) {
  SPOONBILL_ASSERT(net.columns == columns_);
  SPOONBILL_ASSERT(reach_m >= 0.0);
  near_.clear();
  bounds.update_boxes(net);
  for (std::size_t ring = 0; ring < boxes_.size(); ++ring) boxes_[ring] = bounds.box(static_cast<int>(ring));
  for (const auto& [one, other] : pairs_) {
    if (boxes_[one].is_near(boxes_[other], reach_m)) near_.push_back({one, other});
  }
  if (near_.empty()) return near_;
  compute_centres(net);
  std::fill(is_current_.begin(), is_current_.end(), char{0});
  const auto are_apart = [&](const std::array<int, 2>& pair) {
    return are_apart_along(net, pair[0], pair[1], reach_m) || are_apart_along(net, pair[1], pair[0], reach_m);
  };
  near_.erase(std::remove_if(near_.begin(), near_.end(), are_apart), near_.end());
  return near_;
}

void RingSeparation::compute_centres(const ControlNet& net) {
  std::fill(centres_.begin(), centres_.end(), Vector3::Zero());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) centres_[j] += net.point(i, j);
  }
}

// Computes the interval that the control points of each column occupy along the axis of a ring. The axis
// leads from the centre of the ring's first control column to the centre of its last.
void RingSeparation::compute_intervals(const ControlNet& net, int ring) {
  is_current_[ring] = 1;
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
  if (!is_current_[axis_ring]) compute_intervals(net, axis_ring);
  const Interval own = interval(axis_ring, axis_ring), other_interval = interval(other, axis_ring);
  return other_interval.low > own.high + reach_m || other_interval.high < own.low - reach_m;
}

namespace {

// Approximate number of positions around a ring at which it is tested whether the ring can meet another ring.
constexpr int positions_around = 24;
// Extra search distance beyond the margin, in lattice cells. If every two elements are farther apart than the
// margin plus this distance, no two can come within the margin until a control point has moved by half of
// this distance.
constexpr double lead_cells = 1.0;
constexpr std::size_t element_pair_capacity = 1 << 14;
// Largest number of pairs of elements that one search compares. That number of comparisons takes about 50 ms.
// The limit bounds the time for a body so crumpled that all elements are near each other.
constexpr int element_test_capacity = 1 << 23;
// Number of elements whose cells are cached. The cache is cleared when it is full.
constexpr int slot_capacity = 1024;

bool are_near(SurfaceLevels& levels, const LevelCell& a, const LevelCell& b, double reach) {
  return patch_distance(levels.corners(a), levels.bulge(a), levels.corners(b), levels.bulge(b)) <= reach;
}

}  // namespace

SelfProximity::SelfProximity(const NestedGrid& nested, const Surface& rest, double cell_m)
    : near_(nested),
      rest_(nested.grid, rest, cell_m),
      rings_(rest.v, find_rings_that_can_meet()),
      cell_m_(cell_m) {
  SPOONBILL_ASSERT(cell_m > 0.0);
  SPOONBILL_ASSERT(rest.net.rows == nested.grid.u.knots.control_point_count());
  const SurfaceBounds& bounds = near_.levels().bounds();
  const auto elements = static_cast<std::size_t>(bounds.elements_u() * bounds.elements_v());
  boxes_.resize(elements);
  bulges_.resize(elements);
  nearby_.reserve(element_pair_capacity);
  slots_.resize(elements);
  cells_.resize(static_cast<std::size_t>(slot_capacity * near_.levels().step(0) * near_.levels().step(0)));
  clear_net_ = rest.net;
}

std::vector<std::array<int, 2>> SelfProximity::find_rings_that_can_meet() const {
  std::vector<std::array<int, 2>> pairs;
  const int rings = (near_.levels().nested().grid.columns() - 1) / near_.levels().step(0);
  for (int ring = 0; ring < rings; ++ring) {
    for (int other = ring; other < rings; ++other) {
      if (can_meet(ring, other)) pairs.push_back({ring, other});
    }
  }
  return pairs;
}

// Returns true if two rings can meet. Tests positions sampled along the two circles that bound each ring.
bool SelfProximity::can_meet(int ring, int other) const {
  const Grid& grid = near_.levels().nested().grid;
  const int step = near_.levels().step(0), stride = std::max(1, (grid.rows() - 1) / positions_around);
  for (int i = 0; i < grid.rows(); i += stride) {
    for (int k = 0; k < grid.rows(); k += stride) {
      for (const int j : {ring * step, (ring + 1) * step}) {
        for (const int l : {other * step, (other + 1) * step}) {
          if (rest_.can_meet(i * grid.columns() + j, k * grid.columns() + l)) return true;
        }
      }
    }
  }
  return false;
}

// Returns a bound of how far a point of the surface has moved since the search that found nothing near. A
// surface moves no farther than its control points.
double SelfProximity::moved_since_clear_m(const ControlNet& net) const {
  SPOONBILL_ASSERT(net.size() == clear_net_.size());
  double farthest = 0.0;
  for (std::size_t k = 0; k < net.size(); ++k) {
    const double x = net.x[k] - clear_net_.x[k], y = net.y[k] - clear_net_.y[k],
                 z = net.z[k] - clear_net_.z[k], square = x * x + y * y + z * z;
    farthest = farthest < square ? square : farthest;
  }
  return moved_before_m_ + std::sqrt(farthest);
}

// Returns true if an earlier search found nothing near and no two parts can have come within the margin
// since. Two parts approach each other by at most twice the farthest move.
bool SelfProximity::is_still_clear(const ControlNet& net) const {
  return clear_ && moved_since_clear_m(net) < 0.5 * lead_cells * cell_m_;
}

void SelfProximity::carry_over(const SelfProximity& before, const ControlNet& coarse,
                               const ControlNet& fine) {
  SPOONBILL_ASSERT(fine.size() == clear_net_.size());
  clear_ = before.clear_;
  if (!clear_) return;
  moved_before_m_ = before.moved_since_clear_m(coarse);
  clear_net_ = fine;
}

void SelfProximity::find(const Surface& surface, double margin_m) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  near_.begin(surface);
  missing_elements_ = false;
  if (is_still_clear(surface.net)) return;
  find_near_elements(margin_m);
  if (nearby_.empty()) {
    const bool missing = missing_elements_;
    find_near_elements(margin_m + lead_cells * cell_m_);
    clear_ = nearby_.empty() && !missing_elements_;
    missing_elements_ = missing;
    if (clear_) {
      clear_net_ = surface.net;
      moved_before_m_ = 0.0;
    }
    return;
  }
  clear_ = false;
  clear_cells();
  SurfaceLevels& levels = near_.levels();
  const double reach = std::max(margin_m, deepest_self_cells * cell_m_);
  for (const auto& [one, other] : nearby_) offer_elements(one, other, reach);
  near_.keep_if([&](const NearPoint& near) { return near.gap_m <= reach; });
  near_.compute_nearest(levels, 1.0, margin_m, margin_m);
  const auto keep = [&](const NearPoint& near) { return is_contact(near); };
  near_.keep_if(keep);
  near_.add_between_samples(near_, 1.0);
  near_.keep_if(keep);
}

// Finds pairs of elements within reach of each other. Skips pairs whose centres can never meet, according to
// their rest positions.
void SelfProximity::find_near_elements(double reach) {
  nearby_.clear();
  SurfaceLevels& levels = near_.levels();
  const auto& rings = rings_.find_near(levels.surface().net, levels.bounds(), reach);
  if (rings.empty()) return;
  const int elements_u = levels.bounds().elements_u(), elements_v = levels.bounds().elements_v();
  int tests_left = element_test_capacity;
  for (int e = 0; e < elements_u; ++e) {
    levels.element_boxes(e, boxes_.data() + e * elements_v, bulges_.data() + e * elements_v);
  }
  const int step = levels.step(0), half = step / 2, columns = levels.nested().grid.columns();
  const auto centre_sample = [&](int u, int v) { return (u * step + half) * columns + v * step + half; };
  for (const auto& [ring, other] : rings) {
    for (int one = 0; one < elements_u; ++one) {
      const Box& box = boxes_[one * elements_v + ring];
      tests_left -= elements_u;
      missing_elements_ = tests_left < 0;
      if (missing_elements_) return;
      for (int two = ring == other ? one + 1 : 0; two < elements_u; ++two) {
        if (!box.is_near(boxes_[two * elements_v + other], reach)) continue;
        if (!rest_.can_meet(centre_sample(one, ring), centre_sample(two, other))) continue;
        const LevelCell a{one * step, ring * step, 0}, b{two * step, other * step, 0};
        if (!are_near(levels, a, b, reach)) continue;
        missing_elements_ = nearby_.size() == element_pair_capacity;
        if (missing_elements_) return;
        nearby_.push_back({a, b});
      }
    }
  }
}

const Box& SelfProximity::bounding_box(const LevelCell& element) const {
  const SurfaceLevels& levels = near_.levels();
  const int side = levels.step(0), elements_v = (levels.nested().grid.columns() - 1) / side;
  return boxes_[element.i / side * elements_v + element.j / side];
}

void SelfProximity::clear_cells() {
  ++generation_;
  slots_used_ = 0;
}

// Returns the finest cells of an element. The result is valid until clear_cells().
std::span<const SelfProximity::NearCell> SelfProximity::element_cells(const LevelCell& element) {
  SurfaceLevels& levels = near_.levels();
  const int side = levels.step(0), finest = levels.nested().levels, cells = side * side;
  Slot& slot = slots_[element.i / side * levels.bounds().elements_v() + element.j / side];
  if (slot.generation == generation_) return {cells_.data() + slot.first, static_cast<std::size_t>(cells)};
  slot = {generation_, slots_used_++ * cells};
  levels.sample_element(element.i / side, element.j / side);
  for (int k = 0; k < cells; ++k) {
    NearCell& cell = cells_[slot.first + k];
    cell.cell = {element.i + k / side, element.j + k % side, finest};
    cell.corners = levels.corners(cell.cell);
    const double bulge = levels.bulge(cell.cell);
    const auto& [a, b, c, d] = cell.corners;
    cell.box = {a.cwiseMin(b).cwiseMin(c.cwiseMin(d)).array() - bulge,
                a.cwiseMax(b).cwiseMax(c.cwiseMax(d)).array() + bulge};
  }
  return {cells_.data() + slot.first, static_cast<std::size_t>(cells)};
}

void SelfProximity::offer_elements(const LevelCell& one, const LevelCell& other, double reach) {
  if (slots_used_ + 2 > slot_capacity) clear_cells();
  const std::span<const NearCell> cells = element_cells(one), other_cells = element_cells(other);
  offer_samples(one, bounding_box(other), other_cells, reach);
  offer_samples(other, bounding_box(one), cells, reach);
}

// Compares the samples of an element with the cells of another element, which is inside `box`. Skips a cell
// if the sample is known to be nearer to another cell.
void SelfProximity::offer_samples(const LevelCell& element, const Box& box, std::span<const NearCell> cells,
                                  double reach) {
  SurfaceLevels& levels = near_.levels();
  const int side = levels.step(0), columns = levels.nested().grid.columns();
  const bool ring = levels.surface().v.is_periodic();
  for (int i = element.i; i < element.i + side; ++i) {
    for (int j = element.j; j <= element.j + side; ++j) {
      // The samples at the end of an element belong to the next element. All samples of a pole are one point,
      // so only one of them is compared.
      const bool pole = !ring && (j == 0 || j == columns - 1);
      if (pole ? i > 0 : j == element.j + side) continue;
      const int sample = i * columns + j;
      const Vector3 point = levels.sample(sample);
      const auto may_be_nearer = [&](const Box& about) {
        const double least = std::min(reach, near_.offered_distance_m(sample));
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          const double beyond =
              std::max({about.low[axis] - point[axis], point[axis] - about.high[axis], 0.0});
          square += beyond * beyond;
        }
        return square < least * least;
      };
      if (!may_be_nearer(box)) continue;
      for (const NearCell& cell : cells) {
        if (may_be_nearer(cell.box)) near_.offer(i, j, levels, cell.cell, cell.corners);
      }
    }
  }
}

// Returns false if Newton's method found a nearest point on a neighbouring part or on another wall of the
// body.
bool SelfProximity::is_contact(const NearPoint& near) const {
  if (near.gap_m < -deepest_self_cells * cell_m_) return false;
  if (!(near.normal.dot(unit_normal(near_.levels().surface(), near.u, near.v)) < 0.0)) return false;
  return rest_.can_meet(near.u, near.v, near.other_u, near.other_v);
}

}  // namespace spoonbill
