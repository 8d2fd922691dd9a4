#include "engine/simulation/body_supports.h"

#include <string>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// As far as its first node has come; where it has none, as it was.
void find_way(const SpringLattice& lattice, SupportedNodes& support) {
  if (support.nodes.empty()) return;
  support.end_m = lattice.displacement(support.nodes.front()) - support.base_m.front();
}

void take_base(const SpringLattice& lattice, SupportedNodes& support) {
  support.base_m.clear();
  for (const int node : support.nodes) {
    support.base_m.push_back(lattice.displacement(node) - support.end_m);
  }
}

}  // namespace

Result<BodySupports> BodySupports::make(const std::vector<Support>& supports, const LatticeMesh& mesh) {
  BodySupports result;
  if (supports.empty()) return result;
  const std::vector<BodyPlace> places = node_places(mesh);
  for (std::size_t s = 0; s < supports.size(); ++s) {
    const std::string name = "supports[" + std::to_string(s) + "]: ";
    if (Status status = check_support(supports[s]); !status.ok()) return Error{name + status.error().message};
    std::vector<int> nodes;
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (contains(supports[s].region, places[static_cast<std::size_t>(n)])) nodes.push_back(n);
    }
    if (nodes.empty()) return Error{name + "its region holds no node of the lattice; make it larger"};
    result.of_region_.push_back(std::move(nodes));
  }
  result.as_set_ = supports;
  result.supported_.resize(supports.size());
  return result;
}

void BodySupports::take_nodes(const SpringLattice& lattice, std::vector<std::uint8_t>& held) {
  SPOONBILL_ASSERT(held.size() == static_cast<std::size_t>(lattice.mesh().node_count()));
  for (std::size_t s = supported_.size(); s-- > 0;) {
    SupportedNodes& support = supported_[s];
    find_way(lattice, support);
    support.moves = as_set_[s].motion.has_value();
    support.nodes.clear();
    for (const int node : of_region_[s]) {
      std::uint8_t& is_held = held[static_cast<std::size_t>(node)];
      if (is_held == 0) support.nodes.push_back(node);
      is_held = 1;
    }
    take_base(lattice, support);
  }
}

void BodySupports::begin_anew(const SpringLattice& before, const SpringLattice& now) {
  for (SupportedNodes& support : supported_) {
    find_way(before, support);
    take_base(now, support);
  }
}

std::span<SupportedNodes> BodySupports::begin_tick(const SpringLattice& lattice, double end_s,
                                                   double tick_s) {
  SPOONBILL_ASSERT(tick_s > 0.0);
  for (std::size_t s = 0; s < supported_.size(); ++s) {
    SupportedNodes& support = supported_[s];
    support.impulse_ns.setZero();
    if (!support.moves) continue;
    find_way(lattice, support);
    support.start_m = support.end_m;
    support.end_m = way_at(*as_set_[s].motion, end_s);
    support.fastest_m = tick_s * top_speed_m_per_s(*as_set_[s].motion);
  }
  return supported_;
}

}  // namespace spoonbill
