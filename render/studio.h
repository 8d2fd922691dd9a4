// The studio in which bodies are drawn: lights, surroundings that shiny bodies mirror, and backdrop. Plain
// data; does not affect the simulation.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

#include "render/colour.h"

namespace spoonbill {

// Colours are linear, 1 for white paper in full light, unless stated otherwise.
struct Studio {
  std::string_view name;
  Eigen::Vector3f key_colour;    // of the main light, from above
  Eigen::Vector3f fill_colour;   // of the weak light at the side of the eye
  Eigen::Vector3f rim_colour;    // of the light from behind
  Eigen::Vector3f sky_colour;    // of what surrounds the bodies above the horizon
  Eigen::Vector3f floor_colour;  // and below it
  // Brightness of mirrored surroundings: above, at the horizon, below, and of the strip light at the side.
  float ceiling = 1.0f, horizon = 0.2f, floor = 0.6f, strip = 0.5f;
  Colour ground_line{70, 78, 88}, scale_bar{48, 54, 62};  // drawn on the ground
  Eigen::Vector3f top_srgb, bottom_srgb;  // backdrop at the upper and lower edge of the picture, 0 to 255
};

// The studios that the program has; the first is the default.
std::span<const Studio> studios();

// Returns the studio of this name, or null.
const Studio* find_studio(std::string_view name);

}  // namespace spoonbill
