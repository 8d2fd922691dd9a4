// Random inputs that are the same on every machine, unlike the distributions of the standard library.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  int integer(int low, int high) {  // both limits included
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::mt19937_64 engine_;
};

enum class KnotKind { clamped, unclamped, periodic };

// Returns 1 to 6 spans whose lengths differ up to fivefold. A third of the inner knots (and of the periodic
// seams) have a multiplicity up to the degree. Periodic ones may have fewer control points than degree + 1.
KnotVector random_knots(Random& random, int degree, KnotKind kind);
KnotVector random_knots(Random& random);

// Puts control points on a jittered sheet of about 1 x 1 m, 0.5 m high, which has a normal nearly everywhere.
Surface random_surface(Random& random, KnotVector u, KnotVector v);
Surface random_surface(Random& random);

// Returns sorted parameters in the domain, including both ends.
std::vector<double> random_parameters(Random& random, const KnotVector& knots, int count);

}  // namespace spoonbill
