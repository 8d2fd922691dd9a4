// Groups of pairs of cells that hang together: each is one region of contact.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "engine/collision/levels/cell_pairs.h"

namespace spoonbill {

// One owner, one thread; allocates only when made.
class ContactRegions {
 public:
  ContactRegions(const SurfaceLevels& first, const SurfaceLevels& second);

  struct Region {
    std::size_t begin, end;  // into the pairs
  };

  // Orders the pairs by their region. Two pairs hang together where their cells are the same or neighbours on
  // both surfaces, across a seam too. Regions beyond the capacity are joined to the last.
  const std::vector<Region>& group(std::vector<CellPair>& pairs);

 private:
  // Whether two cells of the second surface are the same or have a corner in common.
  bool are_neighbours(const LevelCell& a, const LevelCell& b, int step) const {
    const int in_u = std::abs(a.i - b.i), in_v = std::abs(a.j - b.j);
    return (in_u <= step || around_u_ - in_u <= step) && (in_v <= step || around_v_ - in_v <= step);
  }
  // A cell of the first surface.
  struct Paired {
    std::uint32_t at = 0;  // the group() in which it was last in a pair
    int last_pair = 0;
    bool split = false;  // whether not all its pairs hang together
  };

  int root(int pair);
  void take_cells(const std::vector<CellPair>& pairs);
  void join_neighbours(const std::vector<CellPair>& pairs, int pair);
  void join(const std::vector<CellPair>& pairs, const Paired& cell, const Paired& other);
  void order_by_region(std::vector<CellPair>& pairs);

  const SurfaceLevels* first_;
  const SurfaceLevels* second_;
  // Cells of the second surface around a periodic direction; without end on others.
  int around_u_ = 0, around_v_ = 0;
  std::vector<int> parent_;     // of each pair, an earlier one or itself
  std::vector<int> previous_;   // pair of the same cell of the first surface, by pair; -1 before the first
  std::vector<int> cell_;       // by pair: that cell, as cell_index() counts it
  std::vector<Paired> paired_;  // by cell_index()
  std::uint32_t group_ = 0;
  std::vector<Region> regions_;
  std::vector<int> end_;             // working memory: where the next pair of each region goes
  std::vector<CellPair> unordered_;  // working memory
};

}  // namespace spoonbill
