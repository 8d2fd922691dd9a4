// Where the solid bodies of a document are in each other. For reports. Deterministic; any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

struct BodyMeeting {
  std::size_t first = 0, second = 0;  // places of the bodies among those given; first is less
  bool contained = false;             // one is inside the other
  double depth_m = 0.0;               // how far the first must go to leave the second
  Vector3 position_m = Vector3::Zero();
};

struct BodyMeetings {
  std::vector<BodyMeeting> found;  // of each pair that touches its deepest contact, in the order of the pairs
  bool complete = true;  // false where surfaces are near each other in too many places to be searched
};

// Each surface bounds a body, closed and with its normals outward. FCL's tree picks the pairs whose boxes are
// near. Nothing where it was stopped.
std::optional<BodyMeetings> find_body_meetings(const std::vector<const Surface*>& bodies,
                                               const Progress& progress = {});

}  // namespace spoonbill
