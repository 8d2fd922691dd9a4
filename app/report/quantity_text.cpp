#include "app/report/quantity_text.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "engine/base/text.h"
#include "engine/inspection/surface_check.h"
#include "engine/material/lattice_materials.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {
namespace {

std::string with_decimals(double number, int decimals, const char* unit) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f %s", decimals, number, unit);
  return text.data();
}

// Formats a number from 1 to 999, and also a number below 0.1, with three significant digits. A small
// quantity therefore never reads as 0.00, except below 1e-9, where it counts as a rounding error. A number
// from 0.1 to 1 gets two decimals.
std::string with_three_digits(double number, const char* unit) {
  const double size = std::abs(number) < 1e-9 ? 0.0 : std::abs(number);
  if (size == 0.0) return with_decimals(0.0, 2, unit);
  if (size >= 0.0995) return with_decimals(number, size >= 99.95 ? 0 : size >= 9.995 ? 1 : 2, unit);
  return with_decimals(number, static_cast<int>(std::ceil(2.0 - std::log10(1.005 * size))), unit);
}

bool is_same_range(const Range<double>& a, const Range<double>& b) {
  return a.low == b.low && a.high == b.high;
}

// Returns a text such as "50 to 100 %".
std::string percent_range_text(const Range<double>& fractions) {
  return number_text(100.0 * fractions.low) + " to " + number_text(100.0 * fractions.high) + " %";
}

}  // namespace

std::string decimals_text(double value, int decimals) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string modulus_text(double pascals) {
  constexpr std::array<std::pair<double, const char*>, 3> units = {
      {{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}}};
  for (const auto& [size, unit] : units) {
    if (pascals >= 0.9995 * size) return with_three_digits(pascals / size, unit);
  }
  return with_three_digits(pascals, "Pa");
}

std::string millimetres_text(double metres) {
  return with_decimals(1e3 * metres, 1, "mm");
}

std::string area_text(double square_metres) {
  return with_three_digits(1e4 * square_metres, "cm\u00b2");
}

std::string volume_text(double cubic_metres) {
  return with_three_digits(1e6 * cubic_metres, "cm\u00b3");
}

std::string grams_text(double kilograms) {
  return with_three_digits(1e3 * kilograms, "g");
}

std::string density_text(double kilograms_per_m3) {
  return with_decimals(1e-3 * kilograms_per_m3, 2, "g/cm\u00b3");
}

std::string newtons_text(double newtons) {
  return with_decimals(newtons, 2, "N");
}

std::string percent_text(double fraction) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), fraction < 0.1 ? "%.2g %%" : "%.0f %%", 100.0 * fraction);
  return text.data();
}

std::string slowness_text(double inertia_scale) {
  const double times = std::sqrt(inertia_scale);
  if (times < 1.05) return "real time";
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), times < 9.95 ? "%.1f times slower" : "%.0f times slower", times);
  return text.data();
}

std::string count_text(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string deviation_text(double deviation_m) {
  constexpr double rounding_m = 1e-12;
  return deviation_m <= rounding_m ? "none" : "at most " + short_length_text(deviation_m);
}

std::string size_text(const Vector3& size_m) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.1f x %.1f x %.1f mm", 1e3 * size_m.x(), 1e3 * size_m.y(),
                1e3 * size_m.z());
  return text.data();
}

std::vector<std::string> flag_texts(std::uint32_t flags) {
  constexpr std::array<std::pair<std::uint32_t, const char*>, 6> meanings = {{
      {tick_flag_failed, "Internal fault: undo, or save"},
      {tick_flag_body_limited, "Body cannot follow: move the tool away"},
      {tick_flag_nodes_slowed, "Too stiff for real time: soften E"},
      {tick_flag_speed_capped, "Speed cap met: move more slowly"},
      {tick_flag_contact_overflow, "Contact too large: use a smaller tool"},
      {tick_flag_force_limited, "Force limit met: lower the force scale"},
  }};
  std::vector<std::string> texts;
  for (const auto& [flag, meaning] : meanings) {
    if ((flags & flag) != 0) texts.emplace_back(meaning);
  }
  return texts;
}

const char* name_of(Closedness closedness) {
  switch (closedness) {
    case Closedness::solid:
      return "solid";
    case Closedness::tube:
      return "tube";
    case Closedness::sheet:
      return "sheet";
  }
  return "";
}

std::string closing_text(const Closing& closing) {
  switch (closing.closedness) {
    case Closedness::solid:
      return "closed";
    case Closedness::tube:
      return "a tube, open by " + short_length_text(closing.gap_m) + " at an end";
    case Closedness::sheet:
      return "a sheet, open in both directions";
  }
  return "";
}

std::string region_material_text(const MaterialRegion& region) {
  std::string text = region.material ? region.material->name : "";
  if (!region.friction && !(region.material && region.material->friction > 0.0)) return text;
  const double friction = region.friction ? *region.friction : region.material->friction;
  return text + (text.empty() ? "friction " : ", friction ") + number_text(friction);
}

std::string region_extent_text(const BodyRegion& region) {
  const BodyRegion whole;
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!is_same_range(region.along, whole.along)) add(percent_range_text(region.along) + " along");
  if (!is_same_range(region.around, whole.around)) add(percent_range_text(region.around) + " around");
  if (std::isfinite(region.depth_m.high)) {
    add(number_text(1e3 * region.depth_m.low) + " to " + millimetres_text(region.depth_m.high) + " deep");
  } else if (region.depth_m.low != whole.depth_m.low) {
    add("from " + millimetres_text(region.depth_m.low) + " down");
  }
  return text.empty() ? "all of it" : text;
}

}  // namespace spoonbill
