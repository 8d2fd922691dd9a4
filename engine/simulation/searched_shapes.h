// The shapes of bodies when contacts between them were last searched. While bodies rest, a tick needs no new
// search: the constraints of the last one follow the lattices.
#pragma once

#include <array>
#include <span>
#include <vector>

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
      const Field& field = displacements_m_[b];
      for (std::size_t n = 0; n < field[0].size(); ++n) {
        const std::array<double, 3> displacement_m = {field[0][n], field[1][n], field[2][n]};
        visit(displacement_m.data(), displacement_m.size());
      }
    }
  }

 private:
  using Field = std::array<std::vector<float>, 3>;  // by axis
  std::vector<Field> displacements_m_;              // of the nodes of each body
  std::size_t known_count_ = 0;                     // number of bodies of the last remember(); 0 if forgotten
};

}  // namespace spoonbill
