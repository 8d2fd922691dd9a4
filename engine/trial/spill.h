// Finds when food spills over a rim, and when it has left what bore it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/mass_points.h"
#include "engine/trial/rim.h"

namespace spoonbill {

// Food has spilled when more than this fraction of its mass is outside the rim and below the rim's plane.
inline constexpr double spill_limit_fraction = 0.01;

// Mass of a body outside the rim, as fractions of its mass, and times. The rim's plane turns with the body
// that has the rim. A deformable body counts by its MassPoints, a rigid body as a whole, at its centre of
// mass. If the rim is steeper than 78 degrees, all that is lower than the body with the rim counts as outside
// and below.
struct Spill {
  double outside_fraction = 0.0;  // outside the rim, seen along the normal of its plane
  double spilled_fraction = 0.0;  // outside the rim and below its plane
  double margin_m = 0.0;          // of the centre of mass to the rim (Rim::margin_m())
  // Centre of the mass outside, from the centre of the rim in the rim's plane: towards the first corner of
  // the rim, and to the left of that seen from above. Zero if nothing is outside.
  Vector2 outside_m = Vector2::Zero();
  std::optional<double> first_spill_s;  // time at which it first exceeded spill_limit_fraction
  std::optional<double> left_s;         // time at which the centre of mass was first outside the rim
};

// Watches the free bodies of a trial and the rim of the body that bears them: the trial's turned body or, if
// that has no rim, the first other body with a rim, but not the lowered one. A body is watched from when its
// centre of mass is inside the rim and above the lowest point of that body. Has one owner, which calls
// follow() after each tick. Allocates only when it measures for the first time.
class SpillWatch {
 public:
  explicit SpillWatch(const Scene& scene);

  // Measures at every fifth call, and whenever `now` is true. `time_s` is the time of the trial.
  void follow(const Simulation& simulation, double time_s, bool now = false);

  // Returns what is known of a body; null if it has not been inside a rim.
  const Spill* find(std::size_t body) const;

 private:
  void measure(const Simulation& simulation, double time_s);

  int bearer_ = -1;  // -1: no body has a rim
  Vector3 up_ = Vector3::UnitY(), normal_ = Vector3::UnitY();
  std::optional<Rim> rim_;        // empty until first needed
  std::vector<bool> is_watched_;  // by body
  std::vector<std::optional<Spill>> spills_;
  std::vector<std::optional<MassPoints>> points_;  // by body; empty until first needed
  std::uint64_t calls_ = 0;
};

}  // namespace spoonbill
