// The shapes of bodies when contacts between them were last searched. While bodies rest, a tick needs no new
// search: the constraints of the last one follow the lattices.
#pragma once

#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// A search is repeated once a node has moved farther than this since the last one, in cells of its body. The
// normals of contacts then turn by less than a thousandth, and contacts up to contact_margin_cells minus this
// distance are known.
inline constexpr double searched_motion_cells = 1e-3;

// Has one owner, on one thread. Allocates only in its constructor.
class SearchedShapes {
 public:
  SearchedShapes() = default;
  explicit SearchedShapes(std::span<const BodyState> bodies);

  // Stores the shapes of the first bodies given to the constructor, in their order.
  void remember(std::span<const BodyState> bodies);
  void forget() { known_count_ = 0; }
  // Returns whether no node of these bodies has moved farther than searched_motion_cells since remember(),
  // and no fixed body has turned or is about to turn.
  bool still_hold(std::span<const BodyState> bodies) const;

  // Calls visit(const double*, count) with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (std::size_t b = 0; b < known_count_; ++b) {
      const std::vector<Vector3>& nodes = displacements_m_[b];
      visit(nodes.data()->data(), 3 * nodes.size());
    }
  }

 private:
  std::vector<std::vector<Vector3>> displacements_m_;  // of the nodes of each body
  std::size_t known_count_ = 0;  // number of bodies of the last remember(); 0 if forgotten
};

}  // namespace spoonbill
