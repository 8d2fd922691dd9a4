#include <array>
#include <cstddef>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

struct SpringLattice::Reforming {
  struct Spring {
    int direction, start;
    float rest_length;
  };
  struct Cell {
    int first;
    float rest_volume_sum;
  };
  std::array<Spring, 2 * lattice_direction_count> springs{};
  std::array<Cell, 8> cells{};
  std::size_t spring_count = 0, cell_count = 0;
};

bool SpringLattice::reform_springs(int node, const Vector3& move, Reforming& next) const {
  const Vector3 here = position(node);
  for (int d = 0; d < lattice_direction_count; ++d) {
    for (const bool starts_here : {true, false}) {
      const int start = starts_here ? node : node - offset_[d];
      if (start < 0 || !(stiffness_[d][start] > 0.0f)) continue;
      const Vector3 there = position(starts_here ? node + offset_[d] : start);
      const double longer = (here + move - there).norm() - (here - there).norm();
      const float rest = rest_length_[d][start] + static_cast<float>(longer);
      const float first = first_rest_length_[d][start];
      if (!(rest >= 0.5f * first && rest <= 2.0f * first)) return false;
      next.springs[next.spring_count++] = {d, start, rest};
    }
  }
  return true;
}

bool SpringLattice::reform_cells(int node, const Vector3& move, Reforming& next) const {
  constexpr float least_share = 0.25f, greatest_share = 4.0f, sum_of_volume = 12.0f;
  for (int c = 0; c < 8; ++c) {
    const int step_i = c >> 2 & 1, step_j = c >> 1 & 1, step_k = c & 1;
    const int first = node - mesh_.index(step_i, step_j, step_k);
    if (first < 0 || has_cell_[first] == 0.0f) continue;
    CellCorners corners;
    for (int o = 0; o < 8; ++o) corners[o] = position(first + mesh_.index(o >> 2 & 1, o >> 1 & 1, o & 1));
    const double before = cell_volume(corners);
    corners[c] += move;
    const double larger = cell_volume(corners) - before;
    const float sum = rest_volume_sum_[first] + sum_of_volume * static_cast<float>(larger);
    const float share = sum * inverse_volume_[first] / sum_of_volume;
    if (!(share >= least_share && share <= greatest_share)) return false;
    next.cells[next.cell_count++] = {first, sum};
  }
  return true;
}

bool SpringLattice::reform(int node, const Vector3& move_m) {
  // What single precision makes of it.
  const Vector3 before = displacement(node);
  const Vector3 move = (before + move_m).cast<float>().cast<double>() - before;
  const int twin = mesh_.twin(node);
  Reforming next, of_twin;
  if (!reform_springs(node, move, next) || !reform_cells(node, move, next)) return false;
  if (twin != node && (!reform_springs(twin, move, of_twin) || !reform_cells(twin, move, of_twin))) {
    return false;
  }
  set_displacement(node, before + move);
  take_reformed(next);
  take_reformed(of_twin);
  return true;
}

void SpringLattice::take_reformed(const Reforming& next) {
  for (std::size_t s = 0; s < next.spring_count; ++s) {
    const auto& [d, start, rest] = next.springs[s];
    const float change = rest - rest_length_[d][start];
    square_difference_[d][start] -= change * (2.0f * rest_length_[d][start] + change);
    rest_length_[d][start] = rest;
  }
  for (std::size_t c = 0; c < next.cell_count; ++c) {
    rest_volume_sum_[next.cells[c].first] = next.cells[c].rest_volume_sum;
  }
}

}  // namespace spoonbill
