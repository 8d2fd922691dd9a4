// Pressure on the skin of a body in a box of cells.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// One owner. Each triangle bears its pressure times its area as the body is bent, a third at each corner, and
// each corner hands that on to the nodes it follows: the work is that of the pressure on the volume inside
// the skin.
class PressedSkin {
 public:
  bool empty() const { return triangles_.empty(); }

  // It pushes inwards, Pa. All of them are of one skin.
  void press(const BodySkin& skin, std::size_t triangle, double pressure_pa);

  std::vector<int> nodes() const;  // those that it loads, in order

  // Hands `take` nodes and what they bear, N, with the nodes at `position_of`; a node may come more than
  // once. Allocates nothing.
  template <class PositionOf, class Take>
  void find_forces(const PositionOf& position_of, const Take& take) {
    for (std::size_t p = 0; p < points_.size(); ++p) {
      at_m_[p].setZero();
      force_n_[p].setZero();
      for (std::size_t c = 0; c < 8; ++c) {
        at_m_[p] += points_[p].weights[c] * position_of(points_[p].nodes[c]);
      }
    }
    press_points();
    for (std::size_t p = 0; p < points_.size(); ++p) {
      for (std::size_t c = 0; c < 8; ++c) take(points_[p].nodes[c], points_[p].weights[c] * force_n_[p]);
    }
  }

 private:
  struct Pressed {
    BodySkin::Triangle points{};
    double pressure_pa = 0.0;
  };
  void press_points();

  std::vector<CellPoint> points_;  // those that triangles have
  std::vector<Pressed> triangles_;
  std::vector<int> of_skin_;             // by the skin's points: which of them, or -1
  std::vector<Vector3> at_m_, force_n_;  // of the points: working memory
};

}  // namespace spoonbill
