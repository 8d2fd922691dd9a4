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
  SurfacePattern pattern = SurfacePattern::none;
};

constexpr std::array<NamedLook, 18> looks = {{
    {"clay", {158, 116, 92}, 0.80f, 0.0f, 0.0f, SurfacePattern::smeared},
    {"plasticine", {196, 134, 96}, 0.62f, 0.0f, 0.0f, SurfacePattern::smeared},
    {"wax", {238, 220, 170}, 0.42f, 0.0f, 0.38f},
    {"steel", {186, 189, 193}, 0.08f, 1.0f, 0.0f},
    {"alumin", {232, 233, 236}, 0.52f, 1.0f, 0.0f, SurfacePattern::brushed},
    {"titan", {178, 173, 166}, 0.40f, 1.0f, 0.0f},
    {"silver", {240, 236, 226}, 0.20f, 1.0f, 0.0f},
    {"brass", {226, 192, 112}, 0.28f, 1.0f, 0.0f},
    {"jelly", {230, 122, 6}, 0.08f, 0.0f, 0.78f},
    {"gel", {230, 122, 6}, 0.08f, 0.0f, 0.78f},
    {"silicone", {112, 186, 190}, 0.50f, 0.0f, 0.60f},
    {"rubber", {86, 90, 96}, 0.60f, 0.0f, 0.0f},
    {"polypropylene", {236, 239, 242}, 0.34f, 0.0f, 0.30f},
    {"abs", {40, 43, 48}, 0.10f, 0.0f, 0.0f},
    {"wood", {188, 142, 96}, 0.66f, 0.0f, 0.0f, SurfacePattern::grain},
    {"beech", {218, 180, 138}, 0.58f, 0.0f, 0.0f, SurfacePattern::grain},
    {"foam", {236, 214, 142}, 0.95f, 0.0f, 0.0f, SurfacePattern::pores},
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
          found.translucency,
          found.pattern};
}

}  // namespace spoonbill
