#include "engine/scene/material_region.h"

namespace spoonbill {

Status check_material_region(const MaterialRegion& region) {
  if (Status status = check_region(region.region); !status.ok()) return status;
  if (!region.material && !region.friction) return Error{"material or friction must be given"};
  if (region.friction) {
    if (Status status = check_range("friction", *region.friction, friction_range); !status.ok()) {
      return status;
    }
  }
  return region.material ? check_material(*region.material) : Status();
}

}  // namespace spoonbill
