// A ball that rolls along the corner in which two surfaces cross, touching both: its path is a fillet's.
// Outside the tick; pure function.
#pragma once

#include <optional>

#include "engine/merging/line_crossing.h"

namespace spoonbill {

// Where the ball touches when it touches the first surface on a line of constant u.
struct BallContact {
  double v = 0.0;                       // on the first surface
  double other_u = 0.0, other_v = 0.0;  // on the other
  Vector3 centre_m = Vector3::Zero();
};

// On which side of each surface the ball lies: +1 where its normals point.
struct BallSides {
  int of_surface = 1, of_other = 1;
};

// Solved by Newton's method from the crossing on, for a radius that grows from nothing. None where no ball of
// that radius fits.
std::optional<BallContact> ball_contact(const Surface& surface, double u, const Surface& other,
                                        const LineCrossing& crossing, BallSides sides, double radius_m);

}  // namespace spoonbill
