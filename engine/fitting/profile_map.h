// Parameters for clouds of thin walls that turn about an axis: bowls, cups, plates. Both faces of a wall may
// be nearer to each other than points are to their neighbours, so that no graph of neighbours tells them
// apart; but all around the axis together they draw its profile clearly.
#pragma once

#include <optional>
#include <vector>

#include "engine/fitting/parameterisation.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// u turns about the axis, v runs along the outline of the profile from the axis over the rim to the axis: a
// closed shape. Nothing where the points are not round about an axis, have no outline from axis to axis, or
// are no thin wall with two faces.
struct ProfileMap {
  Parameterisation start;
  bool may_be_one_face;  // whose noise looks like a wall
};
std::optional<ProfileMap> profile_map(const std::vector<Vector3>& points_m);

}  // namespace spoonbill
