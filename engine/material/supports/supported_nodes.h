// The nodes of a lattice that one support holds, and how it moves them through a tick.
#pragma once

#include <span>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Plain data, kept from tick to tick by whoever owns the body. Nodes are in order, and the lattice holds
// them; each is displaced by its base and by how far the support is.
struct SupportedNodes {
  std::vector<int> nodes;
  std::vector<Vector3> base_m;
  bool moves = false;
  Vector3 start_m = Vector3::Zero();  // how far the support is, and shall be at the end of the tick
  Vector3 end_m = Vector3::Zero();
  double fastest_m = 0.0;                // the most of its own that a tick moves it
  Vector3 impulse_ns = Vector3::Zero();  // what it gave the body in the tick
};

}  // namespace spoonbill
