#include "render/overlay/fixed_tint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "tests/render/sample_scene.h"
#include "tests/render/tessellated.h"

namespace spoonbill {
namespace {

// The third of the sample's handle at small x is fixed.
TEST(FixedTint, CoversTheFixedPartAndFades) {
  Snapshot snapshot = sample_scene();
  const TessellatedSurface surface = tessellated(snapshot.bodies[0].surface, 8000.0);
  FixedTint tint;
  tint.update(snapshot.bodies[0].lattice, surface, true);
  ASSERT_EQ(tint.weights().size(), surface.vertex_count());
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v) {
    const double x = vertex(surface, v).x();
    if (x < 0.026) {
      EXPECT_EQ(tint.weights()[v], 1.0f) << x;
    } else if (x > 0.042) {
      EXPECT_EQ(tint.weights()[v], 0.0f) << x;
    }
  }
  auto& fixed = snapshot.bodies[0].lattice.fixed;
  std::fill(fixed.begin(), fixed.end(), std::uint8_t{0});
  tint.update(snapshot.bodies[0].lattice, surface, true);
  for (const float weight : tint.weights()) EXPECT_EQ(weight, 0.0f);
}

}  // namespace
}  // namespace spoonbill
