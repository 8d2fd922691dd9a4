// Rings of a closed tube, a profile of the tube, and the positions of lattice nodes on the rings. A ring is a
// line of constant v. The profile lists the centres and perimeters of rings along the tube.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A piecewise linear function given by a table.
struct LinearTable {
  std::vector<double> from, to;  // `from` must not decrease

  // Returns the interpolated value at x; outside the table, the value of the nearest end.
  double at(double x) const {
    SPOONBILL_ASSERT_DEBUG(!from.empty() && from.size() == to.size());
    const auto upper = std::upper_bound(from.begin(), from.end(), x);
    if (upper == from.begin()) return to.front();
    if (upper == from.end()) return to.back();
    const auto i = static_cast<std::size_t>(upper - from.begin());
    return to[i - 1] + (to[i] - to[i - 1]) * (x - from[i - 1]) / (from[i] - from[i - 1]);
  }
};

// Number of samples around a ring.
inline constexpr int ring_samples = 256;

// Samples of a ring of a tube, which is a line of constant v. Lengths are in metres.
struct Ring {
  std::vector<Vector3> points;  // ring_samples points around the ring; the seam occurs once
  Vector3 centre = Vector3::Zero();
  Vector3 along = Vector3::Zero();  // mean derivative of the points with respect to v
  double perimeter = 0.0;
};

// Samples the ring of a surface at v. The surface must be periodic along u.
Ring sample_ring(const Surface& surface, double v);

// Stations along the centre line of a tube. For each station: v, the distance from the first pole along the
// centre line, and the perimeter and centre of the ring at v.
struct Profile {
  std::vector<double> v, distance, perimeter;
  std::vector<Vector3> centre;
};

// Samples the profile; the surface must be periodic along u and open along v.
Profile sample_profile(const Surface& surface);

// Indices of the stations of a Profile where the caps of a tube end and its sides begin.
struct Rims {
  std::size_t first = 0, last = 0;
};

// Returns the rim at each end of the tube. It is the station nearest to the pole among all stations whose
// perimeter is at least 85 % of the largest perimeter near the pole. Stations within a tenth of the tube's
// length count as near.
Rims near_rims(const Profile& profile);

// Returns, for each end of the tube, the first station from which the tube advances at least as fast as its
// mean radius (perimeter / 2 pi) grows. The search begins at the station that protrudes farthest at that end.
// If the end of a body is hollow around the pole, the cap therefore extends over the edge of the hollow to
// the side.
Rims shoulder_rims(const Profile& profile);

// Returns, for each end of the tube, the rim of `a` or `b` that is farther from the pole.
Rims further_rims(const Rims& a, const Rims& b);

// Axes and extents of a cross-section, in metres.
struct CrossSection {
  Vector3 e1, e2;                       // the wide and the narrow axis
  double width = 0.0, thickness = 0.0;  // for a bent section, measured along its bend and across it
  bool bent = false;                    // true for a curved section, as of a spoon's bowl
};

// Returns the axes and extents of a ring's section perpendicular to `axis`.
CrossSection principal_axes(const Ring& ring, const Vector3& axis);

// Width and thickness from which the numbers of lattice cells are chosen. Each is that of the section at half
// length, unless it varies by more than a factor of 2.5 along the body, as in a spoon. It is then the
// geometric mean of its smallest and largest values, because the value at half length would give slender
// cells elsewhere.
struct Extents {
  double width, thickness;
  bool bent = false;  // true if any section between the rims is bent
};

// Returns the extents for the tube's sections between the rims (see Extents).
Extents lattice_extents(const Surface& surface, const Profile& profile, const Rims& rims,
                        const CrossSection& centre_section);

// Parameters u of the lattice nodes around a ring, in the order of increasing u. A section has ni x nj nodes,
// of which 2 (ni - 1) + 2 (nj - 1) are on the ring. The first parameter is that of the corner node (ni - 1,
// nj - 1), which is between the axes +e1 and +e2 of the section.
struct RingParameters {
  std::vector<double> u;
};

// Returns the parameters of the nodes around a ring, for a section of ni x nj nodes. The nodes are spaced
// evenly along each side.
RingParameters ring_parameters(const Surface& surface, const Ring& ring, const CrossSection& section, int ni,
                               int nj);

// Returns the index into RingParameters::u of a point (s, t) on the boundary of the square [-1, 1] x [-1, 1].
// The index is fractional for a point between two nodes.
double ring_position(double s, double t, int ni, int nj);

// Returns the parameter u at a fractional index in RingParameters::u.
double ring_parameter_at(const Surface& surface, const RingParameters& ring, double position);

}  // namespace spoonbill
