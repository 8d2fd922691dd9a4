#include "render/colour.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

namespace spoonbill {
namespace {

struct NamedLook {
  std::string_view word;
  int srgb[3];
  float roughness, metalness, translucency;
};

constexpr std::array<NamedLook, 18> looks = {{
    {"clay", {164, 139, 113}, 0.74f, 0.0f, 0.0f},
    {"plasticine", {196, 134, 96}, 0.62f, 0.0f, 0.0f},
    {"wax", {232, 214, 168}, 0.45f, 0.0f, 0.15f},
    {"steel", {198, 200, 202}, 0.24f, 1.0f, 0.0f},
    {"alumin", {214, 216, 219}, 0.36f, 1.0f, 0.0f},
    {"titan", {178, 173, 166}, 0.40f, 1.0f, 0.0f},
    {"silver", {240, 236, 226}, 0.20f, 1.0f, 0.0f},
    {"brass", {226, 192, 112}, 0.28f, 1.0f, 0.0f},
    {"jelly", {234, 150, 24}, 0.14f, 0.0f, 0.78f},
    {"gel", {234, 150, 24}, 0.14f, 0.0f, 0.78f},
    {"silicone", {172, 190, 200}, 0.46f, 0.0f, 0.22f},
    {"rubber", {86, 90, 96}, 0.60f, 0.0f, 0.0f},
    {"polypropylene", {214, 220, 224}, 0.40f, 0.0f, 0.08f},
    {"abs", {196, 202, 208}, 0.34f, 0.0f, 0.0f},
    {"wood", {188, 142, 96}, 0.66f, 0.0f, 0.0f},
    {"beech", {206, 168, 122}, 0.62f, 0.0f, 0.0f},
    {"foam", {214, 214, 206}, 0.90f, 0.0f, 0.0f},
    {"ceramic", {232, 230, 224}, 0.18f, 0.0f, 0.0f},
}};

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

}  // namespace

float srgb8_to_linear(int value) {
  const double s = value / 255.0;
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

SurfaceLook find_material_look(std::string_view name) {
  const std::string lower = lower_case(name);
  NamedLook found{"", {186, 188, 190}, 0.6f, 0.0f, 0.0f};
  for (const NamedLook& look : looks) {
    if (lower.find(look.word) != std::string::npos) {
      found = look;
      break;
    }
  }
  const auto& c = found.srgb;
  return {{srgb8_to_linear(c[0]), srgb8_to_linear(c[1]), srgb8_to_linear(c[2])},
          found.roughness,
          found.metalness,
          found.translucency};
}

}  // namespace spoonbill
