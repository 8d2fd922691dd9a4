// Where the surface of one body comes near itself from outside: samples with the nearest points of other
// parts of it, and the places between samples where they are nearest or deepest.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/proximity/near_points.h"
#include "engine/collision/proximity/rest_pairs.h"
#include "engine/collision/proximity/ring_separation.h"

namespace spoonbill {

// Deeper than this in itself, in lattice cells, a point is not looked at: what is nearest may be another
// wall.
inline constexpr double deepest_self_cells = 1.0;

// One owner, one thread; allocates only when made. The grid must outlive it.
class SelfProximity {
 public:
  // The surface at rest bounds a body: du x dv points outwards. `cell_m` is the cell of the body's lattice.
  SelfProximity(const NestedGrid& nested, const Surface& rest, double cell_m);
  SelfProximity(const SelfProximity&) = delete;
  SelfProximity& operator=(const SelfProximity&) = delete;

  // All that is within `margin_m` of another part that it faces and can meet (see RestPairs), the same margin
  // each time. Costs next to nothing where the body is not folded.
  void find(const Surface& surface, double margin_m);

  // Keeps those of the points that `keep` keeps.
  template <class Keep>
  void keep_if(const Keep& keep) {
    near_.keep_if(keep);
  }

  // Of the last find().
  const std::vector<NearPoint>& points() const { return near_.points(); }
  // Nothing was near in the last find(): the next one costs next to nothing.
  bool is_clear() const { return clear_; }
  // A capacity was met, and points may be missing. Remedy: fewer control points or a smaller margin.
  bool overflow() const { return missing_elements_ || near_.overflow(); }

 private:
  bool is_still_clear(const ControlNet& net) const;
  std::vector<std::array<int, 2>> rings_that_can_meet() const;
  bool can_meet(int ring, int other) const;
  void find_near_elements(double reach);
  // A finest cell and a box about its patch.
  struct NearCell {
    LevelCell cell;
    PatchCorners corners;
    Box box;
  };
  const Box& bounding_box(const LevelCell& element) const;
  void begin_cells();
  std::span<const NearCell> cells_of(const LevelCell& element);
  void offer_elements(const LevelCell& one, const LevelCell& other, double reach);
  void offer_samples(const LevelCell& element, const Box& box, std::span<const NearCell> cells, double reach);
  bool faces(const NearPoint& near) const;

  NearPoints near_;
  RestPairs rest_;
  RingSeparation rings_;
  double cell_m_;
  std::vector<Box> boxes_;                        // of the elements, by u and v
  std::vector<double> bulges_;                    // of the same
  std::vector<std::array<LevelCell, 2>> nearby_;  // elements that could meet
  struct Slot {
    std::uint32_t filling = 0;  // of cells_, at which the element was taken
    int first = 0;
  };
  std::vector<Slot> slots_;      // of each element
  std::vector<NearCell> cells_;  // of the elements in the slots
  std::uint32_t filling_ = 0;
  int slots_used_ = 0;
  // The control points when no elements were within the margin and a lead; none since something was.
  ControlNet clear_net_;
  bool clear_ = false;
  bool missing_elements_ = false;
};

}  // namespace spoonbill
