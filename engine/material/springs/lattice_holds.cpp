// What of a lattice is free to move, and how light it is.
#include <algorithm>
#include <cstdint>

#include "engine/base/assert.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

float SpringLattice::free_inverse_mass(int node) const {
  return contact_inverse_mass_ > 0.0f ? contact_inverse_mass_ : 1.0f / node_mass_[mesh_.joined(node)];
}

void SpringLattice::set_contact_inverse_mass(double inverse_mass_per_kg) {
  SPOONBILL_ASSERT(inverse_mass_per_kg >= 0.0);
  contact_inverse_mass_ = static_cast<float>(inverse_mass_per_kg);
  for (int n = 0; n < mesh_.node_count(); ++n) {
    if (inverse_mass_[n] > 0.0f) inverse_mass_[n] = free_inverse_mass(n);
  }
}

void SpringLattice::hold(std::span<const std::uint8_t> held) {
  SPOONBILL_ASSERT(held.size() == static_cast<std::size_t>(mesh_.node_count()));
  held_count_ =
      static_cast<int>(std::count_if(held.begin(), held.end(), [](std::uint8_t is) { return is != 0; }));
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const bool free =
        held[static_cast<std::size_t>(n)] == 0 && held[static_cast<std::size_t>(mesh_.twin(n))] == 0;
    inverse_mass_[n] = free ? free_inverse_mass(n) : 0.0f;
    free_mass_[n] = free ? node_mass_[n] : 0.0f;
    free_node_[n] = free ? 1.0f : 0.0f;
    if (!free) set_velocity(n, Vector3::Zero());
  }
  find_active_blocks();
}

void SpringLattice::find_active_blocks() {
  active_block_.assign(static_cast<std::size_t>(padded_count_ / lattice_block), 0);
  free_block_ = active_block_;
  const int reach = *std::max_element(offset_, offset_ + lattice_direction_count);
  for (int n = 0; n < mesh_.node_count(); ++n) {
    if (free_node_[n] == 0.0f) continue;
    free_block_[static_cast<std::size_t>(n / lattice_block)] = 1;
    const int first = std::max(0, n - reach) / lattice_block;
    for (int b = first; b <= n / lattice_block; ++b) active_block_[static_cast<std::size_t>(b)] = 1;
  }
}

}  // namespace spoonbill
