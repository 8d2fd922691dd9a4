// The rings of a closed tube at constant v, and where the nodes of its lattice lie on them.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/pose.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

inline constexpr int ring_samples = 256;

double parameter_at(const KnotVector& knots, double share);

struct Ring {
  std::vector<Vector3> points;  // ring_samples, the seam not repeated
  Vector3 centre = Vector3::Zero();
  Vector3 along = Vector3::Zero();  // how the centre moves with v
  double perimeter = 0.0;
};

// The surface is periodic along u.
Ring sample_ring(const Surface& surface, double v);

// The body's middle line: v against distance from the first pole, and each station's perimeter and middle.
struct Profile {
  std::vector<double> v, distance, perimeter;
  std::vector<Vector3> centre;
};

Profile sample_profile(const Surface& surface);

// The stations where caps end and the side begins.
struct Rims {
  std::size_t first = 0, last = 0;
};

// From each pole the first station whose perimeter reaches most of the largest one nearby (within a tenth of
// the length).
Rims near_rims(const Profile& profile);

// From each pole the first station beyond the farthest one out at which the body grows longer faster than
// wider. Where a body is hollow about its pole, its cap then reaches over the edge of the hollow to the side.
Rims shoulder_rims(const Profile& profile);

// Of each end the one that is further from the pole.
Rims further_rims(const Rims& a, const Rims& b);

struct CrossSection {
  Vector3 e1, e2;                       // the wide and the narrow axis
  double width = 0.0, thickness = 0.0;  // of a bent one along its bend and across it
  bool bent = false;                    // as of a spoon's bowl
};

CrossSection principal_axes(const Ring& ring, const Vector3& axis);

// Counts that suit the middle make slender cells elsewhere where an extent differs much along the body, as of
// a spoon: then the one between its least and its greatest.
struct Extents {
  double width, thickness;
  bool bent = false;  // whether any section between the rims is
};

Extents extents_to_fill(const Surface& surface, const Profile& profile, const Rims& rims,
                        const CrossSection& middle);

// The parameters u of the ring's four corners and of the nodes between them. Corner 0 lies between +e1 and
// +e2.
struct RingParameters {
  std::vector<double> u;  // 2 (ni - 1) + 2 (nj - 1), from the corner (ni - 1, nj - 1) on, in the sense of u
};

RingParameters ring_parameters(const Surface& surface, const Ring& ring, const CrossSection& section, int ni,
                               int nj);

// The ring position of the boundary node (i, j), or of a fractional place on the boundary of the unit square.
double ring_position(double s, double t, int ni, int nj);

double ring_parameter_at(const Surface& surface, const RingParameters& ring, double position);

}  // namespace spoonbill
