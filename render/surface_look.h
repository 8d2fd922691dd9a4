// How a material looks, in a few honest parameters. Drawing only; the physics knows nothing of it.
#pragma once

#include <Eigen/Core>
#include <string_view>

namespace spoonbill {

struct SurfaceLook {
  Eigen::Vector3f base_colour = {0.5f, 0.5f, 0.5f};  // linear reflectance; of metals the mirror's tint
  float roughness = 0.6f;                            // 0 mirror .. 1 chalk
  float metalness = 0.0f;                            // 0 or 1
  float translucency = 0.0f;                         // 0 opaque .. 1 clear
};

// By what the material's name contains ("modelling-clay", "steel-304"); a neutral matt grey for other names.
SurfaceLook look_of_material(std::string_view name);

// The linear value of an 8-bit sRGB one.
float linear_of_srgb8(int value);

}  // namespace spoonbill
