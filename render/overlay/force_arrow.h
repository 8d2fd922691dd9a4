// The force on the hand as an arrow out of the tool. No GL.
#pragma once

#include <optional>

#include "engine/simulation/snapshot.h"
#include "render/view_settings.h"

namespace spoonbill {

struct ForceArrow {
  Vector3 start_m, tip_m;
  double newtons = 0.0;
};

// As long as the force asks for, up to five times the tool's size or 60 mm; none below 5 mN, where an arrow's
// direction would be noise. The overlay must be on.
std::optional<ForceArrow> force_arrow(const Snapshot& snapshot, const ViewSettings& settings);

}  // namespace spoonbill
