#include "engine/scene/body_region.h"

#include <string>

#include "engine/base/text.h"

namespace spoonbill {
namespace {

Status check_shares(const char* field, const Range<double>& shares, bool may_pass_seam) {
  constexpr Range<double> whole{0.0, 1.0};
  for (const double share : {shares.low, shares.high}) {
    if (Status status = check_range(field, share, whole); !status.ok()) return status;
  }
  if (may_pass_seam ? shares.low != shares.high : shares.low <= shares.high) return {};
  return Error{std::string(field) + " is [" + number_text(shares.low) + ", " + number_text(shares.high) +
               "], must run from the lower to the higher"};
}

}  // namespace

bool contains(const BodyRegion& region, const BodyPlace& place) {
  const bool around = region.around.low <= region.around.high
                          ? region.around.contains(place.around)
                          : place.around >= region.around.low || place.around <= region.around.high;
  return around && region.along.contains(place.along) && region.depth_m.contains(place.depth_m);
}

Status check_region(const BodyRegion& region) {
  if (Status status = check_shares("along", region.along, false); !status.ok()) return status;
  if (Status status = check_shares("around", region.around, true); !status.ok()) return status;
  if (region.depth_m.low >= 0.0 && region.depth_m.low <= region.depth_m.high) return {};
  return Error{"depth_mm is [" + number_text(region.depth_m.low * 1e3) + ", " +
               number_text(region.depth_m.high * 1e3) + "], must run from at least 0 to more"};
}

}  // namespace spoonbill
