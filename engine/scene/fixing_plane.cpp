#include "engine/scene/fixing_plane.h"

namespace spoonbill {

Status check_fixing_plane(const FixingPlane& plane) {
  return check_fields("fixing plane: ", plane);
}

}  // namespace spoonbill
