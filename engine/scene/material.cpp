#include "engine/scene/material.h"

#include "engine/base/text.h"

namespace spoonbill {
namespace {

Status check_fractions(const char* field, const Range<double>& fractions, bool may_cross_seam) {
  constexpr Range<double> whole{0.0, 1.0};
  for (const double fraction : {fractions.low, fractions.high}) {
    if (Status status = check_range(field, fraction, whole); !status.ok()) return status;
  }
  if (may_cross_seam ? fractions.low != fractions.high : fractions.low <= fractions.high) return {};
  return Error{ErrorCode::inconsistent,
               std::string(field) + " is [" + number_text(fractions.low) + ", " +
                   number_text(fractions.high) + "], must " +
                   (may_cross_seam ? "have two different ends" : "run from the lower to the higher"),
               field};
}

}  // namespace

Status check_material(const Material& material) {
  const auto context = [&material] { return "material " + material.name; };
  if (const Status status = check_fields({}, material); !status.ok()) return status.error().in(context());
  if (material.plastic && material.relaxing_fraction > 0.0) {
    return Error{ErrorCode::inconsistent,
                 "cannot both flow and creep; set plastic to false or relaxing_share to 0", "plastic"}
        .in(context());
  }
  if (!is_linear_elastic(material) && material.poissons_ratio < min_spring_poissons_ratio) {
    return Error{ErrorCode::out_of_range,
                 "poissons_ratio is " + number_text(material.poissons_ratio) + ", must be " +
                     number_text(min_spring_poissons_ratio) +
                     " or more for a material that is plastic, creeps or stiffens",
                 "poissons_ratio"}
        .in(context());
  }
  return {};
}

double find_yield_stress_pa(const Material& material) {
  return material.plastic ? material.youngs_modulus_pa * material.yield_strain : material.yield_strength_pa;
}

bool is_linear_elastic(const Material& material) {
  return !material.plastic && material.relaxing_fraction == 0.0 && material.stiffening == 0.0;
}

bool contains(const BodyRegion& region, const BodyCoordinates& point) {
  const bool around = region.around.low <= region.around.high
                          ? region.around.contains(point.around)
                          : point.around >= region.around.low || point.around <= region.around.high;
  return around && region.along.contains(point.along) && region.depth_m.contains(point.depth_m);
}

Status check_region(const BodyRegion& region) {
  if (Status status = check_fractions("along", region.along, false); !status.ok()) return status;
  if (Status status = check_fractions("around", region.around, true); !status.ok()) return status;
  if (region.depth_m.low >= 0.0 && region.depth_m.low <= region.depth_m.high) return {};
  return Error{ErrorCode::inconsistent,
               "depth_mm is [" + number_text(region.depth_m.low * 1e3) + ", " +
                   number_text(region.depth_m.high * 1e3) +
                   "], must run from 0 or more to the same or a larger depth",
               "depth_mm"};
}

Status check_material_region(const MaterialRegion& region) {
  if (Status status = check_region(region.region); !status.ok()) return status;
  if (!region.material && !region.friction) {
    return Error{ErrorCode::missing, "material or friction must be given"};
  }
  if (region.friction) {
    if (Status status = check_range("friction", *region.friction, friction_range); !status.ok()) {
      return status;
    }
  }
  return region.material ? check_material(*region.material) : Status();
}

}  // namespace spoonbill
