// Two bodies of a simulation on each other: finds where their surfaces come near and turns that into
// constraints between their lattices.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/collision/cell_pairs.h"
#include "engine/collision/surface_levels.h"
#include "engine/material/body_contacts.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// How deep surfaces of bodies that are pressed together come to be in each other at most, in lattice cells of
// the coarser one, up to a speed of 60 mm/s: their control nets follow a dent a cell wide only in part. What
// is left is taken back as soon as they rest.
inline constexpr double body_depth_limit_cells = 0.03;

// Where the body stands among the simulation's, and its state.
struct NumberedBody {
  int number;
  const BodyState* state;
};

// One owner, the simulation; rebuilt with the mapping of a body. add_contacts() allocates nothing.
class BodyPairContact {
 public:
  BodyPairContact(const BodyMapping& first, const BodyMapping& second);

  // Adds a constraint for each sample of either surface that is near the other, and for the places between
  // samples where the surfaces are nearest or deepest. False where a capacity was met.
  bool add_contacts(const NumberedBody& first, const NumberedBody& second, BodyContacts& contacts);

  // Of the last add_contacts(): below zero, how deep the surfaces are in each other; infinite where they are
  // not near.
  double least_gap_m() const { return least_gap_m_; }

 private:
  // The samples of one surface that are near the other, and the other's nearest parameters.
  struct Near {
    int sample;
    double u, v;
    double distance;
    double gap;  // with the side it is on
  };
  struct Side {
    explicit Side(const NestedGrid& nested);
    SurfaceLevels levels;
    std::vector<int> place;                // of each sample in `near`
    std::vector<std::uint32_t> placed_at;  // the search in which that was so
    std::vector<Near> near;
  };
  struct Direction {
    const NumberedBody& from;
    const NumberedBody& to;
    Side& side;
    Side& other;
  };

  void begin(const BodyState& first, const BodyState& second);
  bool offer_corners(Side& side, const LevelCell& cell, Side& other, const LevelCell& patch);
  bool add_samples(const Direction& direction, double margin, BodyContacts& contacts);
  bool add_deepest(const Direction& direction, double margin, BodyContacts& contacts);
  bool is_local_deepest(const Side& side, const Near& near) const;

  // By pointer, because the pairs keep the levels' addresses when this moves.
  std::unique_ptr<Side> first_, second_;
  std::unique_ptr<CellPairs> cells_;
  std::uint32_t search_ = 0;
  double least_gap_m_ = 0.0;
};

}  // namespace spoonbill
