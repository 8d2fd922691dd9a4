// Measures of a spoon in the hand: its weight, its balance, and the grip that it needs.
#pragma once

#include <vector>

#include "app/study/study_plan.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Friction of the skin on the handle: smooth vinyl, Buchholz et al. 1988.
inline constexpr double skin_friction = 0.53;
// Grip forces of groups of people with early rheumatoid arthritis, N (TIRA, Arthritis Rheum. 2005 53(6) 886):
// the upper bound of the weakest group and the lower bounds of the others.
inline constexpr double grip_groups_n[] = {114.0, 116.0, 214.0, 328.0};

// The hand at one place of the handle, while the spoon is held level with the food in it.
struct GripMeasure {
  double from_end_m = 0.0;  // from the end of the handle
  double width_m = 0.0;     // of the handle there, across the spoon
  double torque_nm = 0.0;   // of the weights of spoon and food, about the hand
  // Force that holds the torque by friction at both sides of the handle, torque / (skin_friction width). It
  // ranks spoons and is no measured force.
  double force_n = 0.0;
};

// The handle of a spoon along the direction of the front. Lengths from the end of the handle.
struct Handle {
  double end_m = 0.0;     // from the rim's centre, along the front; negative
  double length_m = 0.0;  // up to where the bowl begins; not positive if the spoon has no handle
};
Handle find_handle(const StudySpoon& spoon);

// Section of a spoon across the direction of the front, `from_end_m` from the end of the handle: the centre
// of the box about it and its width.
struct SpoonSection {
  Vector3 centre_m = Vector3::Zero();
  double width_m = 0.0;
};
SpoonSection find_section(const StudySpoon& spoon, double from_end_m);

struct SpoonMeasures {
  double length_m = 0.0;  // along the direction of the front
  double mass_kg = 0.0;
  Vector3 centre_m = Vector3::Zero();  // of mass
  double balance_m =
      0.0;  // from the end of the handle to the balance point, along the direction of the front
  std::vector<GripMeasure> grips;  // empty if the spoon has no handle
};

// Returns the mass of a helping: its exact volume times its density.
double find_food_kg(const StudyFood& food);

// Measures a spoon that is made of one material. Weight and balance are exact integrals over the surface.
// Fails if the surface encloses no volume.
Result<SpoonMeasures> measure_spoon(const StudySpoon& spoon, const Material& material, double food_kg);

}  // namespace spoonbill
