#include "render/studio.h"

#include <algorithm>
#include <array>

namespace spoonbill {

std::span<const Studio> studios() {
  static const std::array<Studio, 3> all = {{
      {.name = "soft",
       .key_colour = {1.50f, 1.43f, 1.34f},
       .fill_colour = {0.20f, 0.22f, 0.25f},
       .rim_colour = {0.42f, 0.46f, 0.52f},
       .sky_colour = {0.37f, 0.39f, 0.42f},
       .floor_colour = {0.38f, 0.37f, 0.36f},
       .ceiling = 1.02f,
       .horizon = 0.20f,
       .floor = 0.62f,
       .strip = 0.5f,
       .top_srgb = {196.0f, 200.0f, 205.0f},
       .bottom_srgb = {238.0f, 238.5f, 239.0f}},
      {.name = "contrast",
       .key_colour = {1.90f, 1.82f, 1.70f},
       .fill_colour = {0.07f, 0.07f, 0.08f},
       .rim_colour = {0.90f, 0.95f, 1.05f},
       .sky_colour = {0.24f, 0.25f, 0.27f},
       .floor_colour = {0.24f, 0.23f, 0.22f},
       .ceiling = 0.55f,
       .horizon = 0.05f,
       .floor = 0.34f,
       .strip = 1.3f,
       .top_srgb = {142.0f, 147.0f, 154.0f},
       .bottom_srgb = {212.0f, 213.0f, 215.0f}},
      {.name = "dark",
       .key_colour = {1.05f, 1.02f, 0.98f},
       .fill_colour = {0.10f, 0.11f, 0.13f},
       .rim_colour = {1.70f, 1.80f, 2.00f},
       .sky_colour = {0.17f, 0.18f, 0.20f},
       .floor_colour = {0.10f, 0.10f, 0.11f},
       .ceiling = 0.20f,
       .horizon = 0.03f,
       .floor = 0.12f,
       .strip = 1.6f,
       .ground_line = {150, 156, 164},
       .scale_bar = {196, 200, 206},
       .top_srgb = {24.0f, 26.0f, 30.0f},
       .bottom_srgb = {62.0f, 64.0f, 68.0f}},
  }};
  return all;
}

const Studio* find_studio(std::string_view name) {
  const auto all = studios();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Studio& s) { return s.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace spoonbill
