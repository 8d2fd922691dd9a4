// Tessellates surfaces, and returns the positions of their vertices.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

inline TessellatedSurface tessellated(const SurfaceSnapshot& surface, double pixels_per_metre) {
  TessellatedSurface result;
  const Status status = result.update(surface, choose_sampling_level(surface, pixels_per_metre, {}));
  EXPECT_TRUE(status.ok()) << status.error().message;
  return result;
}

inline Vector3 vertex(const TessellatedSurface& surface, std::uint32_t i) {
  return {surface.samples().x[i], surface.samples().y[i], surface.samples().z[i]};
}

}  // namespace spoonbill
