#include "engine/scene/fixing_plane.h"

#include "engine/base/pose.h"

namespace spoonbill {

Status check_fixing_plane(const FixingPlane& plane) {
  if (Status status = check_position("fixing plane: point_m", plane.point_m); !status.ok()) return status;
  return check_unit("fixing plane: normal", plane.normal);
}

}  // namespace spoonbill
