#include "tests/engine/simulation/soft_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/collision/surfaces/surface_pair_collider.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {

Material silicone() {
  Material material = small_handle().bodies[0].material;
  material.name = "silicone";
  material.plastic = false;
  material.damping_time_s = 4.4e-5;
  return material;
}

double depth_between(const Surface& first, const Surface& second) {
  const NestedGrid of_first = make_nested_grid(first.u, first.v, 2).value();
  const NestedGrid of_second = make_nested_grid(second.u, second.v, 2).value();
  SurfacePairCollider collider(of_first, of_second);
  PairQuery query;
  query.first_closed = query.second_closed = true;
  const PairResult result = collider.collide(first, second, query);
  EXPECT_FALSE(result.contained);
  EXPECT_FALSE(result.overflow);
  double deepest = 0.0;
  for (const PairContact& contact : collider.contacts()) deepest = std::max(deepest, contact.depth_m);
  return deepest;
}

double lowest(const Surface& surface) {
  return *std::min_element(surface.net.y.begin(), surface.net.y.end());
}

}  // namespace spoonbill
