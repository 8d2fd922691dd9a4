// Pairs of random surfaces for contact: of all degrees from 1 to 5, clamped and periodic, thin, folded and
// spiked.
#pragma once

#include <string>

#include "engine/bspline/surface.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {

struct RandomPair {
  Surface first, second;
  std::string kind;  // kinds of both surfaces
};

// Returns surfaces of about 1 m, rotated at random, with centres up to `apart_m` from each other.
RandomPair random_pair(Random& random, double apart_m);

void move(Surface& surface, const Vector3& by);

}  // namespace spoonbill
