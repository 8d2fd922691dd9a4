#include "engine/collision/proximity/self_proximity.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/collision/levels/patch_distance.h"

namespace spoonbill {
namespace {

// Of a ring, at most so many places tell whether it can meet another.
constexpr int places_around = 24;
// How far beyond the margin, in lattice cells, elements are looked for: as long as none are, and no control
// point has gone half as far since, none can be within the margin.
constexpr double lead_cells = 1.0;
constexpr std::size_t element_pair_capacity = 1 << 14;
// Of more elements in contact, those of before are taken again.
constexpr int slot_capacity = 1024;

bool are_near(SurfaceLevels& levels, const LevelCell& a, const LevelCell& b, double reach) {
  return patch_distance(levels.corners(a), levels.bulge(a), levels.corners(b), levels.bulge(b)) <= reach;
}

}  // namespace

SelfProximity::SelfProximity(const NestedGrid& nested, const Surface& rest, double cell_m)
    : near_(nested),
      rest_(nested.grid, rest, cell_m),
      rings_(rest.v, rings_that_can_meet()),
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

std::vector<std::array<int, 2>> SelfProximity::rings_that_can_meet() const {
  std::vector<std::array<int, 2>> pairs;
  const int rings = (near_.levels().nested().grid.columns() - 1) / near_.levels().step(0);
  for (int ring = 0; ring < rings; ++ring) {
    for (int other = ring; other < rings; ++other) {
      if (can_meet(ring, other)) pairs.push_back({ring, other});
    }
  }
  return pairs;
}

// By their ends.
bool SelfProximity::can_meet(int ring, int other) const {
  const Grid& grid = near_.levels().nested().grid;
  const int step = near_.levels().step(0), stride = std::max(1, (grid.rows() - 1) / places_around);
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

// The surface moves no farther than its control points: two parts approach by twice that at most.
bool SelfProximity::is_still_clear(const ControlNet& net) const {
  if (!clear_) return false;
  const double most = 0.5 * lead_cells * cell_m_;
  double farthest = 0.0;
  for (std::size_t k = 0; k < net.size(); ++k) {
    const double x = net.x[k] - clear_net_.x[k], y = net.y[k] - clear_net_.y[k],
                 z = net.z[k] - clear_net_.z[k], square = x * x + y * y + z * z;
    farthest = farthest < square ? square : farthest;
  }
  return farthest < most * most;
}

void SelfProximity::find(const Surface& surface, double margin_m) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  near_.begin(surface);
  missing_elements_ = false;
  if (is_still_clear(surface.net)) return;
  find_near_elements(margin_m);
  if (nearby_.empty()) {
    find_near_elements(margin_m + lead_cells * cell_m_);
    clear_ = nearby_.empty();
    missing_elements_ = false;  // of those that are too far to count
    if (clear_) clear_net_ = surface.net;
    return;
  }
  clear_ = false;
  begin_cells();
  SurfaceLevels& levels = near_.levels();
  const double reach = std::max(margin_m, deepest_self_cells * cell_m_);
  for (const auto& [one, other] : nearby_) offer_elements(one, other, reach);
  near_.keep_if([&](const NearPoint& near) { return near.gap_m <= reach; });
  near_.settle(levels, 1.0, margin_m);
  const auto keep = [&](const NearPoint& near) { return faces(near); };
  near_.keep_if(keep);
  near_.add_between_samples(levels, 1.0);
  near_.keep_if(keep);
}

// Whether elements can meet is told by their middles.
void SelfProximity::find_near_elements(double reach) {
  nearby_.clear();
  SurfaceLevels& levels = near_.levels();
  const auto& rings = rings_.near(levels.surface().net, levels.bounds(), reach);
  if (rings.empty()) return;
  const int elements_u = levels.bounds().elements_u(), elements_v = levels.bounds().elements_v();
  for (int e = 0; e < elements_u; ++e) {
    levels.element_boxes(e, boxes_.data() + e * elements_v, bulges_.data() + e * elements_v);
  }
  const int step = levels.step(0), half = step / 2, columns = levels.nested().grid.columns();
  const auto middle = [&](int u, int v) { return (u * step + half) * columns + v * step + half; };
  for (const auto& [ring, other] : rings) {
    for (int one = 0; one < elements_u; ++one) {
      const Box& box = boxes_[one * elements_v + ring];
      for (int two = ring == other ? one + 1 : 0; two < elements_u; ++two) {
        if (!box.is_near(boxes_[two * elements_v + other], reach)) continue;
        if (!rest_.can_meet(middle(one, ring), middle(two, other))) continue;
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

void SelfProximity::begin_cells() {
  ++filling_;
  slots_used_ = 0;
}

// The finest cells of an element, valid until begin_cells().
std::span<const SelfProximity::NearCell> SelfProximity::cells_of(const LevelCell& element) {
  SurfaceLevels& levels = near_.levels();
  const int side = levels.step(0), finest = levels.nested().levels, cells = side * side;
  Slot& slot = slots_[element.i / side * levels.bounds().elements_v() + element.j / side];
  if (slot.filling == filling_) return {cells_.data() + slot.first, static_cast<std::size_t>(cells)};
  slot = {filling_, slots_used_++ * cells};
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
  if (slots_used_ + 2 > slot_capacity) begin_cells();
  const std::span<const NearCell> cells = cells_of(one), other_cells = cells_of(other);
  offer_samples(one, bounding_box(other), other_cells, reach);
  offer_samples(other, bounding_box(one), cells, reach);
}

// The samples of an element against the cells of another, in a box, that may be nearer than what they were
// offered.
void SelfProximity::offer_samples(const LevelCell& element, const Box& box, std::span<const NearCell> cells,
                                  double reach) {
  SurfaceLevels& levels = near_.levels();
  const int side = levels.step(0), columns = levels.nested().grid.columns();
  const bool ring = levels.surface().v.is_periodic();
  for (int i = element.i; i < element.i + side; ++i) {
    for (int j = element.j; j <= element.j + side; ++j) {
      // Those at its end are the next element's, those of a pole one place.
      const bool pole = !ring && (j == 0 || j == columns - 1);
      if (pole ? i > 0 : j == element.j + side) continue;
      const int sample = i * columns + j;
      const Vector3 point = levels.sample(sample);
      const auto may_be_nearer = [&](const Box& about) {
        const double least = std::min(reach, near_.offered_m(sample));
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

// Newton's method may have led to a neighbour, or round to another wall.
bool SelfProximity::faces(const NearPoint& near) const {
  if (near.gap_m < -deepest_self_cells * cell_m_) return false;
  if (!(near.normal.dot(unit_normal(near_.levels().surface(), near.u, near.v)) < 0.0)) return false;
  return rest_.can_meet(near.u, near.v, near.other_u, near.other_v);
}

}  // namespace spoonbill
