#include "app/report/region_text.h"

#include <cmath>

#include "app/report/quantity_text.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

bool is_whole(const Range<double>& range, const Range<double>& whole) {
  return range.low == whole.low && range.high == whole.high;
}

std::string shares_text(const Range<double>& shares) {
  return number_text(100.0 * shares.low) + " to " + number_text(100.0 * shares.high) + " %";
}

}  // namespace

std::string made_of_text(const MaterialRegion& region) {
  std::string text = region.material ? region.material->name : "";
  if (!region.friction && !(region.material && region.material->friction > 0.0)) return text;
  const double friction = region.friction ? *region.friction : region.material->friction;
  return text + (text.empty() ? "friction " : ", friction ") + number_text(friction);
}

std::string position_text(const BodyRegion& region) {
  const BodyRegion whole;
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!is_whole(region.along, whole.along)) add(shares_text(region.along) + " along");
  if (!is_whole(region.around, whole.around)) add(shares_text(region.around) + " around");
  if (std::isfinite(region.depth_m.high)) {
    add(number_text(1e3 * region.depth_m.low) + " to " + millimetres_text(region.depth_m.high) + " deep");
  } else if (region.depth_m.low != whole.depth_m.low) {
    add("from " + millimetres_text(region.depth_m.low) + " down");
  }
  return text.empty() ? "all of it" : text;
}

}  // namespace spoonbill
