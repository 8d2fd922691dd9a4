#include "engine/bspline/tube_rings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/bspline/basis.h"

namespace spoonbill {
namespace {

constexpr int along_samples = 400;
// Smallest perimeter of a rim (where a cap of the tube ends), as a fraction of the largest perimeter near the
// same pole.
constexpr double rim_fraction = 0.85;

std::size_t near_rim(const Profile& profile, bool from_end) {
  const auto station = [&](std::size_t s) { return from_end ? profile.v.size() - 1 - s : s; };
  const double near = 0.1 * profile.distance.back();
  double largest = 0.0;
  for (std::size_t s = 0; s < profile.v.size(); ++s) {
    if (std::abs(profile.distance[station(s)] - profile.distance[station(0)]) > near) break;
    largest = std::max(largest, profile.perimeter[station(s)]);
  }
  std::size_t s = 0;
  while (profile.perimeter[station(s)] < rim_fraction * largest) ++s;
  return station(s);
}

// Length of the region around a pole that is searched for a hollow and the material that protrudes around it,
// as a fraction of the body's length.
constexpr double end_fraction = 0.4;

std::size_t shoulder(const Profile& profile, bool from_end) {
  const std::size_t count = profile.v.size();
  const auto station = [&](std::size_t s) { return from_end ? count - 1 - s : s; };
  const auto centre = [&](std::size_t s) -> const Vector3& { return profile.centre[station(s)]; };
  const double pole = profile.distance[station(0)], near = end_fraction * profile.distance.back();
  std::size_t inner = 0;
  while (inner + 1 < count && std::abs(profile.distance[station(inner)] - pole) < near) ++inner;
  const Vector3 inward = (centre(inner) - centre(0)).normalized();
  std::size_t farthest = 0;
  for (std::size_t s = 0; s < inner; ++s) {
    if (inward.dot(centre(s) - centre(farthest)) < 0.0) farthest = s;
  }
  std::size_t s = farthest;
  while (s < inner && 2.0 * std::numbers::pi * inward.dot(centre(s + 1) - centre(s)) <
                          profile.perimeter[station(s + 1)] - profile.perimeter[station(s)]) {
    ++s;
  }
  return station(s);
}

// Fraction of the distance from the centre of a section to a tip. A section is not bent if the line along its
// wide axis, through the centre, crosses the outline only beyond this fraction, once towards each tip.
constexpr double bent_fraction = 0.9;

// Indices of the ring's points that are farthest along +e1 and along -e1.
struct Tips {
  int high = 0, low = 0;
};

Tips find_tips(const Ring& ring, const Vector3& e1) {
  Tips tips;
  for (int s = 0; s < ring_samples; ++s) {
    if (e1.dot(ring.points[s] - ring.points[tips.high]) > 0.0) tips.high = s;
    if (e1.dot(ring.points[s] - ring.points[tips.low]) < 0.0) tips.low = s;
  }
  return tips;
}

// Returns true if the wide axis through the centre leaves the section before it reaches the tips. An example
// is the bowl of a spoon, where the centre of the ring is outside the section or near one side.
bool is_bent(const Ring& ring, const Vector3& e1, const Vector3& e2) {
  const Tips tips = find_tips(ring, e1);
  const auto reach = [&](int s) { return e1.dot(ring.points[s] - ring.centre); };
  int crossings = 0;
  bool at_ends = true;
  for (int s = 0; s < ring_samples; ++s) {
    const int next = (s + 1) % ring_samples;
    const double a = e2.dot(ring.points[s] - ring.centre), b = e2.dot(ring.points[next] - ring.centre);
    if ((a < 0.0) == (b < 0.0)) continue;
    ++crossings;
    const double farthest = reach(s) > 0.0 ? reach(tips.high) : reach(tips.low);
    at_ends = at_ends && reach(s) / farthest > bent_fraction;
  }
  return crossings > 0 && !(crossings == 2 && at_ends);
}

// Measures the width of a bent section along the bend, and its thickness across the bend. Both are computed
// from points at equal fractions of the two sides between the tips.
void measure_bent(const Ring& ring, CrossSection& section) {
  const Tips tips = find_tips(ring, section.e1);
  const auto samples = [](int from, int to) { return (to - from + ring_samples) % ring_samples; };
  const int upper = samples(tips.high, tips.low), lower = ring_samples - upper;
  constexpr int stations = 32;
  double across = 0.0, along = 0.0;
  Vector3 last = ring.points[tips.high];
  for (int k = 1; k < stations; ++k) {
    const Vector3& a = ring.points[(tips.high + upper * k / stations) % ring_samples];
    const Vector3& b = ring.points[(tips.high + ring_samples - lower * k / stations) % ring_samples];
    across += (a - b).norm() / (stations - 1);
    along += (0.5 * (a + b) - last).norm();
    last = 0.5 * (a + b);
  }
  section.width = along + (ring.points[tips.low] - last).norm();
  section.thickness = across;
}

// A table that maps the arc length of a ring to u (continued past the seam), and the arc lengths at which the
// ring crosses the axes +e1, +e2, -e1, -e2 and, after a full turn, +e1. Crossings are found from signs rather
// than angles, because some library functions return different bits on different processors.
struct RingArc {
  LinearTable arc_to_u;
  std::array<double, 5> crossing{};
  double perimeter = 0.0;
};

RingArc ring_arc(const Surface& surface, const Ring& ring, const CrossSection& section) {
  const auto point = [&](int s) -> const Vector3& {
    return ring.points[static_cast<std::size_t>(s % ring_samples)];
  };
  // Returns a value for sample s that changes from negative to positive or zero at crossing q.
  const auto side = [&](int q, int s) {
    const Vector3 axes[4] = {section.e2, -section.e1, -section.e2, section.e1};
    return axes[q % 4].dot(point(s) - ring.centre);
  };
  int start = 0;
  while (start < ring_samples && !(side(0, start) < 0.0 && side(0, start + 1) >= 0.0)) ++start;
  RingArc result;
  double arc = 0.0;
  int next = 0;
  for (int s = start; s <= start + 2 * ring_samples; ++s) {
    result.arc_to_u.from.push_back(arc);
    result.arc_to_u.to.push_back(surface.u.parameter_at(static_cast<double>(s) / ring_samples));
    const double step = (point(s + 1) - point(s)).norm();
    while (next < 5 && side(next, s) < 0.0 && side(next, s + 1) >= 0.0) {
      result.crossing[next] = arc + step * -side(next, s) / (side(next, s + 1) - side(next, s));
      ++next;
    }
    arc += step;
  }
  result.perimeter = ring.perimeter;
  return result;
}

// Computes the arc of a bent section. Its tips replace the crossings of the wide axis, and the midpoints of
// its sides replace the crossings of the narrow axis.
RingArc bent_arc(const Surface& surface, const Ring& ring, const CrossSection& section) {
  const Tips tips = find_tips(ring, section.e1);
  RingArc result;
  double arc = 0.0;
  for (int s = tips.high; s <= tips.high + 2 * ring_samples; ++s) {
    result.arc_to_u.from.push_back(arc);
    result.arc_to_u.to.push_back(surface.u.parameter_at(static_cast<double>(s) / ring_samples));
    if (s % ring_samples == tips.low && result.crossing[2] == 0.0) result.crossing[2] = arc;
    arc += (ring.points[(s + 1) % ring_samples] - ring.points[s % ring_samples]).norm();
  }
  result.crossing[1] = 0.5 * result.crossing[2];
  result.crossing[3] = 0.5 * (result.crossing[2] + ring.perimeter);
  result.crossing[4] = ring.perimeter;
  result.perimeter = ring.perimeter;
  return result;
}

// Largest relative difference between the variances along the two axes at which the directions of the axes
// count as arbitrary, as in a round or square section.
constexpr double nearly_alike = 1e-3;
// Smallest ratio of |sum of z^4| to the sum of |z|^4 at which a ring counts as having corners. Smaller ratios
// are only the ripple of a round ring. Here z is a point of the section as a complex number.
constexpr double min_squareness = 0.02;

// Turns e1 to the midpoint of a side of a square section, in which every direction is a principal axis. The
// fourth moment is a complex number whose angle is four times the angle of a corner. The axis of a round
// section does not change.
void turn_to_sides(const Ring& ring, const Vector3& axis, Vector3& e1) {
  const Vector3 e2 = axis.cross(e1);
  std::complex<double> moment = 0.0;
  double size = 0.0;
  for (const Vector3& p : ring.points) {
    const std::complex<double> position(e1.dot(p - ring.centre), e2.dot(p - ring.centre));
    moment += position * position * position * position;
    size += std::norm(position) * std::norm(position);
  }
  if (!(std::abs(moment) > min_squareness * size)) return;
  const double to_side = 0.25 * (std::arg(moment) + std::numbers::pi);
  e1 = std::cos(to_side) * e1 + std::sin(to_side) * e2;
}

}  // namespace

Ring sample_ring(const Surface& surface, double v) {
  SPOONBILL_ASSERT(surface.u.is_periodic());
  // Blends the control points of the ring and of its derivative with respect to v, with the same bits as
  // evaluate().
  const BasisFunctions along = basis_functions(surface.v, surface.v.into_domain(v));
  std::vector<Vector3> controls, derivatives;
  for (int i = 0; i < surface.net.rows; ++i) {
    Vector3 value = Vector3::Zero(), derivative = Vector3::Zero();
    for (int j = 0; j <= surface.v.degree(); ++j) {
      const Vector3 control = surface.net.point(i, surface.v.control_index(along.span, j));
      value += along.values[0][j] * control;
      derivative += along.values[1][j] * control;
    }
    controls.push_back(value);
    derivatives.push_back(derivative);
  }
  Ring ring;
  BasisFunctions around;
  for (int s = 0; s < ring_samples; ++s) {
    const double u = surface.u.parameter_at(static_cast<double>(s) / ring_samples);
    basis_values(surface.u, surface.u.into_domain(u), around);
    Vector3 point = Vector3::Zero(), derivative = Vector3::Zero();
    for (int i = 0; i <= surface.u.degree(); ++i) {
      const int row = surface.u.control_index(around.span, i);
      point += around.values[0][i] * controls[row];
      derivative += around.values[0][i] * derivatives[row];
    }
    ring.points.push_back(point);
    ring.centre += point / ring_samples;
    ring.along += derivative / ring_samples;
  }
  for (int s = 0; s < ring_samples; ++s) {
    ring.perimeter += (ring.points[(s + 1) % ring_samples] - ring.points[s]).norm();
  }
  return ring;
}

Profile sample_profile(const Surface& surface) {
  SPOONBILL_ASSERT(surface.u.is_periodic() && !surface.v.is_periodic());
  Profile profile;
  Vector3 previous = Vector3::Zero();
  for (int s = 0; s <= along_samples; ++s) {
    const double v = surface.v.parameter_at(static_cast<double>(s) / along_samples);
    const Ring ring = sample_ring(surface, v);
    const double step = s == 0 ? 0.0 : (ring.centre - previous).norm();
    profile.v.push_back(v);
    profile.distance.push_back(s == 0 ? 0.0 : profile.distance.back() + step);
    profile.perimeter.push_back(ring.perimeter);
    profile.centre.push_back(ring.centre);
    previous = ring.centre;
  }
  return profile;
}

Rims near_rims(const Profile& profile) {
  SPOONBILL_ASSERT(!profile.v.empty() && profile.perimeter.size() == profile.distance.size());
  return {near_rim(profile, false), near_rim(profile, true)};
}

Rims shoulder_rims(const Profile& profile) {
  SPOONBILL_ASSERT(!profile.v.empty() && profile.perimeter.size() == profile.distance.size());
  return {shoulder(profile, false), shoulder(profile, true)};
}

Rims further_rims(const Rims& a, const Rims& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

CrossSection principal_axes(const Ring& ring, const Vector3& axis) {
  SPOONBILL_ASSERT(ring.points.size() == ring_samples);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3& p : ring.points) {
    const Vector3 d = (p - ring.centre) - axis * axis.dot(p - ring.centre);
    covariance += d * d.transpose();
  }
  const SymmetricEigen eigen = decompose_symmetric(covariance);
  CrossSection section;
  section.e1 = eigen.vectors.col(2);
  const Eigen::Vector3d& spread = eigen.values;
  if (spread[2] - spread[1] < nearly_alike * spread[2]) turn_to_sides(ring, axis, section.e1);
  // The largest component of the eigenvector is made positive, because the solver's sign is arbitrary.
  Eigen::Index largest = 0;
  section.e1.cwiseAbs().maxCoeff(&largest);
  if (section.e1[largest] < 0.0) section.e1 = -section.e1;
  section.e2 = axis.cross(section.e1);
  double low1 = 0.0, high1 = 0.0, low2 = 0.0, high2 = 0.0;
  for (const Vector3& p : ring.points) {
    const double a = section.e1.dot(p - ring.centre), b = section.e2.dot(p - ring.centre);
    low1 = std::min(low1, a);
    high1 = std::max(high1, a);
    low2 = std::min(low2, b);
    high2 = std::max(high2, b);
  }
  section.width = high1 - low1;
  section.thickness = high2 - low2;
  section.bent = is_bent(ring, section.e1, section.e2);
  if (section.bent) measure_bent(ring, section);
  return section;
}

Extents lattice_extents(const Surface& surface, const Profile& profile, const Rims& rims,
                        const CrossSection& centre_section) {
  SPOONBILL_ASSERT(rims.first <= rims.last && rims.last < profile.v.size());
  constexpr double much = 2.5;
  constexpr std::size_t stations = 24;
  Extents least{centre_section.width, centre_section.thickness}, most = least;
  bool bent = centre_section.bent;
  for (std::size_t s = 0; s <= stations; ++s) {
    const Ring ring = sample_ring(surface, profile.v[rims.first + (rims.last - rims.first) * s / stations]);
    if (!(ring.along.norm() > 0.0)) continue;
    const CrossSection section = principal_axes(ring, ring.along.normalized());
    least = {std::min(least.width, section.width), std::min(least.thickness, section.thickness)};
    most = {std::max(most.width, section.width), std::max(most.thickness, section.thickness)};
    bent = bent || section.bent;
  }
  const auto between = [](double low, double high, double fallback) {
    return low > 0.0 && high > much * low ? std::sqrt(low * high) : fallback;
  };
  return {between(least.width, most.width, centre_section.width),
          between(least.thickness, most.thickness, centre_section.thickness), bent};
}

RingParameters ring_parameters(const Surface& surface, const Ring& ring, const CrossSection& section, int ni,
                               int nj) {
  SPOONBILL_ASSERT(ni >= 2 && nj >= 2);
  SPOONBILL_ASSERT(ring.points.size() == ring_samples);
  const RingArc arc = section.bent ? bent_arc(surface, ring, section) : ring_arc(surface, ring, section);
  const double along_narrow = nj - 1, along_wide = ni - 1;
  std::array<double, 5> corner{};
  for (int q = 0; q < 4; ++q) {
    // The corner joins two sides and divides the arc between two crossings in proportion to the numbers of
    // cells on these sides. The narrow side comes first after a crossing of the wide axis, the wide side
    // after a crossing of the narrow axis.
    const double first = q % 2 == 0 ? along_narrow : along_wide;
    corner[q] =
        arc.crossing[q] + (arc.crossing[q + 1] - arc.crossing[q]) * first / (along_narrow + along_wide);
  }
  corner[4] = corner[0] + arc.perimeter;
  RingParameters result;
  for (int side = 0; side < 4; ++side) {
    const int cells = side % 2 == 0 ? ni - 1 : nj - 1;
    for (int c = 0; c < cells; ++c) {
      result.u.push_back(arc.arc_to_u.at(corner[side] + (corner[side + 1] - corner[side]) * c / cells));
    }
  }
  return result;
}

double ring_position(double s, double t, int ni, int nj) {
  // The ring starts at (+1, +1) and runs to (-1, +1), (-1, -1) and (+1, -1).
  if (t == 1.0 && s > -1.0) return (1.0 - s) * 0.5 * (ni - 1);
  if (s == -1.0 && t > -1.0) return (ni - 1) + (1.0 - t) * 0.5 * (nj - 1);
  if (t == -1.0 && s < 1.0) return (ni - 1) + (nj - 1) + (1.0 + s) * 0.5 * (ni - 1);
  return 2 * (ni - 1) + (nj - 1) + (1.0 + t) * 0.5 * (nj - 1);
}

double ring_parameter_at(const Surface& surface, const RingParameters& ring, double position) {
  SPOONBILL_ASSERT_DEBUG(!ring.u.empty() && position >= 0.0);
  const auto count = static_cast<int>(ring.u.size());
  const int low = static_cast<int>(std::floor(position)) % count;
  const double fraction = position - std::floor(position);
  const double period = surface.u.domain_length();
  double a = ring.u[low], b = ring.u[(low + 1) % count];
  while (b < a) b += period;
  return a + fraction * (b - a);
}

}  // namespace spoonbill
