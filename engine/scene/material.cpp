#include "engine/scene/material.h"

#include "engine/base/text.h"

namespace spoonbill {

Status check_material(const Material& material) {
  const auto about = [&material] { return "material " + material.name + ": "; };
  if (const Status status = check_fields({}, material); !status.ok()) {
    return Error{about() + status.error().message};
  }
  if (material.plastic && material.relaxing_share > 0.0) {
    return Error{about() + "cannot both flow and creep; set plastic to false or relaxing_share to 0"};
  }
  if (!is_plainly_elastic(material) && material.poissons_ratio < least_spring_poissons_ratio) {
    return Error{about() + "poissons_ratio is " + number_text(material.poissons_ratio) + ", must be " +
                 number_text(least_spring_poissons_ratio) +
                 " or more for a material that is plastic, creeps or stiffens"};
  }
  return {};
}

bool is_plainly_elastic(const Material& material) {
  return !material.plastic && material.relaxing_share == 0.0 && material.stiffening == 0.0;
}

}  // namespace spoonbill
