#include "engine/scene/material.h"

#include "engine/base/number_text.h"

namespace spoonbill {

Status check_material(const Material& material) {
  const struct {
    const char* field;
    double value;
    Range<double> range;
  } checks[] = {
      {"youngs_modulus_pa", material.youngs_modulus_pa, youngs_modulus_range_pa},
      {"poissons_ratio", material.poissons_ratio, poissons_ratio_range},
      {"density_kg_per_m3", material.density_kg_per_m3, density_range_kg_per_m3},
      {"damping_ratio", material.damping_ratio, damping_ratio_range},
      {"yield_strain", material.yield_strain, yield_strain_range_of(material.plastic)},
      {"flow_rate_per_s", material.flow_rate_per_s, flow_rate_range_per_s},
      {"hardening", material.hardening, hardening_range},
      {"stiffening", material.stiffening, stiffening_range},
      {"relaxing_share", material.relaxing_share, relaxing_share_range},
      {"relaxation_time_s", material.relaxation_time_s, relaxation_time_range_s},
      {"friction", material.friction, friction_range},
  };
  for (const auto& check : checks) {
    if (Status status = check_range(check.field, check.value, check.range); !status.ok()) {
      return Error{"material " + material.name + ": " + status.error().message};
    }
  }
  if (material.plastic && material.relaxing_share > 0.0) {
    return Error{"material " + material.name +
                 ": cannot both flow and creep; set plastic to false or relaxing_share to 0"};
  }
  if (!is_plainly_elastic(material) && material.poissons_ratio < least_spring_poissons_ratio) {
    return Error{"material " + material.name + ": poissons_ratio is " + number_text(material.poissons_ratio) +
                 ", must be " + number_text(least_spring_poissons_ratio) +
                 " or more for a material that is plastic, creeps or stiffens"};
  }
  return {};
}

bool is_plainly_elastic(const Material& material) {
  return !material.plastic && material.relaxing_share == 0.0 && material.stiffening == 0.0;
}

}  // namespace spoonbill
