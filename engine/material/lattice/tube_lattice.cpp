#include "engine/material/lattice/tube_lattice.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/material/lattice/share_table.h"
#include "engine/number_text.h"

namespace spoonbill {
namespace {

constexpr int ring_samples = 256;
constexpr int along_samples = 400;
// Of the width: flatter bodies have cells that no spring holds open.
constexpr double least_thickness = 1e-4;
// Of the radius: how little the points of a ring lie out along their normals where it is pressed flat, by
// rounding of positions and normals.
constexpr double flat = 1e-9;

double along(const KnotVector& knots, double share) {
  return knots.domain_start() + share * (knots.domain_end() - knots.domain_start());
}

struct Ring {
  std::vector<Vector3> points;  // ring_samples, the seam not repeated
  Vector3 centre = Vector3::Zero();
  Vector3 along = Vector3::Zero();  // how the centre moves with v
  double perimeter = 0.0;
};

Ring sample_ring(const Surface& surface, double v) {
  Ring ring;
  for (int s = 0; s < ring_samples; ++s) {
    const SurfacePoint point = evaluate(surface, along(surface.u, static_cast<double>(s) / ring_samples), v);
    ring.points.push_back(point.position_m);
    ring.centre += point.position_m / ring_samples;
    ring.along += point.dv / ring_samples;
  }
  for (int s = 0; s < ring_samples; ++s) {
    ring.perimeter += (ring.points[(s + 1) % ring_samples] - ring.points[s]).norm();
  }
  return ring;
}

// The body's middle line: v against distance from the first pole, and each station's perimeter.
struct Profile {
  std::vector<double> v, distance, perimeter;
};

Profile sample_profile(const Surface& surface) {
  Profile profile;
  Vector3 previous = Vector3::Zero();
  for (int s = 0; s <= along_samples; ++s) {
    const double v = along(surface.v, static_cast<double>(s) / along_samples);
    const Ring ring = sample_ring(surface, v);
    const double step = s == 0 ? 0.0 : (ring.centre - previous).norm();
    profile.v.push_back(v);
    profile.distance.push_back(s == 0 ? 0.0 : profile.distance.back() + step);
    profile.perimeter.push_back(ring.perimeter);
    previous = ring.centre;
  }
  return profile;
}

// Where a cap ends and the side begins, from one pole: the first station whose perimeter reaches the given
// share of the largest one nearby (within a tenth of the length).
constexpr double rim_share = 0.85;

std::size_t find_rim(const Profile& profile, bool from_end) {
  const auto station = [&](std::size_t s) { return from_end ? profile.v.size() - 1 - s : s; };
  const double near = 0.1 * profile.distance.back();
  double largest = 0.0;
  for (std::size_t s = 0; s < profile.v.size(); ++s) {
    if (std::abs(profile.distance[station(s)] - profile.distance[station(0)]) > near) break;
    largest = std::max(largest, profile.perimeter[station(s)]);
  }
  std::size_t s = 0;
  while (profile.perimeter[station(s)] < rim_share * largest) ++s;
  return station(s);
}

// The parameters u of the ring's four corners and of the nodes between them. Corner 0 lies between +e1 and
// +e2.
struct RingParameters {
  std::vector<double> u;  // 2 (ni - 1) + 2 (nj - 1), from the corner (ni - 1, nj - 1) on, in the sense of u
};

struct CrossSection {
  Vector3 e1, e2;  // the wide and the narrow axis
  double width = 0.0, thickness = 0.0;
};

CrossSection principal_axes(const Ring& ring, const Vector3& axis) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3& p : ring.points) {
    const Vector3 d = (p - ring.centre) - axis * axis.dot(p - ring.centre);
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  CrossSection section;
  section.e1 = solver.eigenvectors().col(2);
  // The sign is the eigenvector's largest component's, so that it does not hang on the solver's whim.
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
  return section;
}

// Counts that suit the middle make slender cells elsewhere where an extent differs much along the body, as of
// a spoon: then the one between its least and its greatest.
struct Extents {
  double width, thickness;
};

Extents extents_to_fill(const Surface& surface, const Profile& profile, std::size_t first, std::size_t last,
                        const CrossSection& middle) {
  constexpr double much = 2.5;
  constexpr std::size_t stations = 24;
  Extents least{middle.width, middle.thickness}, most = least;
  for (std::size_t s = 0; s <= stations; ++s) {
    const Ring ring = sample_ring(surface, profile.v[first + (last - first) * s / stations]);
    if (!(ring.along.norm() > 0.0)) continue;
    const CrossSection section = principal_axes(ring, ring.along.normalized());
    least = {std::min(least.width, section.width), std::min(least.thickness, section.thickness)};
    most = {std::max(most.width, section.width), std::max(most.thickness, section.thickness)};
  }
  const auto between = [](double low, double high, double usual) {
    return low > 0.0 && high > much * low ? std::sqrt(low * high) : usual;
  };
  return {between(least.width, most.width, middle.width),
          between(least.thickness, most.thickness, middle.thickness)};
}

// The ring's arc length as a table to u (unwrapped past the seam), and the arc lengths at which the ring
// crosses +e1, +e2, -e1, -e2 and +e1 again. Found by signs alone: no library function whose bits differ among
// processors.
struct RingArc {
  ShareTable arc_to_u;
  std::array<double, 5> crossing{};
  double perimeter = 0.0;
};

RingArc ring_arc(const Surface& surface, const Ring& ring, const CrossSection& section) {
  const auto point = [&](int s) -> const Vector3& {
    return ring.points[static_cast<std::size_t>(s % ring_samples)];
  };
  // Positive after the crossing number q, negative before it.
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
    result.arc_to_u.to.push_back(along(surface.u, static_cast<double>(s) / ring_samples));
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

RingParameters ring_parameters(const Surface& surface, const Ring& ring, const CrossSection& section, int ni,
                               int nj) {
  const RingArc arc = ring_arc(surface, ring, section);
  const double along_narrow = nj - 1, along_wide = ni - 1;
  std::array<double, 5> corner{};
  for (int q = 0; q < 4; ++q) {
    // From the crossing of a wide axis to a corner runs half a narrow side, from a narrow axis half a wide
    // one.
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

// The ring position of the boundary node (i, j), or of a fractional place on the boundary of the unit square.
double ring_position(double s, double t, int ni, int nj) {
  // s, t in [-1, 1] with max(|s|, |t|) = 1; the ring starts at (+1, +1), runs to (-1, +1), (-1, -1), (+1,
  // -1).
  if (t == 1.0 && s > -1.0) return (1.0 - s) * 0.5 * (ni - 1);
  if (s == -1.0 && t > -1.0) return (ni - 1) + (1.0 - t) * 0.5 * (nj - 1);
  if (t == -1.0 && s < 1.0) return (ni - 1) + (nj - 1) + (1.0 + s) * 0.5 * (ni - 1);
  return 2 * (ni - 1) + (nj - 1) + (1.0 + t) * 0.5 * (nj - 1);
}

double ring_parameter_at(const Surface& surface, const RingParameters& ring, double position) {
  const auto count = static_cast<int>(ring.u.size());
  const int low = static_cast<int>(std::floor(position)) % count;
  const double share = position - std::floor(position);
  const double period = surface.u.domain_end() - surface.u.domain_start();
  double a = ring.u[low], b = ring.u[(low + 1) % count];
  while (b < a) b += period;
  return a + share * (b - a);
}

// The parameter u of the ring's point towards which a node of a slice lies from the middle, any in the
// middle, and how far out it lies, 0 to 1.
struct Outward {
  double u = 0.0;
  double radius = 0.0;
};

Outward outward_of(const Surface& surface, const RingParameters& ring, const LatticeMesh& mesh, int i,
                   int j) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  const double s = 2.0 * i / (ni - 1) - 1.0, t = 2.0 * j / (nj - 1) - 1.0;
  const double radius = std::max(std::abs(s), std::abs(t));
  if (!(radius > 0.0)) return {ring.u[0], 0.0};
  const double on_s = std::abs(s) == radius ? std::copysign(1.0, s) : s / radius;
  const double on_t = std::abs(t) == radius ? std::copysign(1.0, t) : t / radius;
  return {ring_parameter_at(surface, ring, ring_position(on_s, on_t, ni, nj)), radius};
}

// Transfinite (Coons) interpolation of a slice from its ring.
void fill_slice(LatticeMesh& mesh, int k) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  const auto at = [&](int i, int j) -> const Vector3& { return mesh.nodes[mesh.index(i, j, k)]; };
  for (int i = 1; i + 1 < ni; ++i) {
    for (int j = 1; j + 1 < nj; ++j) {
      const double a = static_cast<double>(i) / (ni - 1), b = static_cast<double>(j) / (nj - 1);
      const Vector3 sides = (1 - a) * at(0, j) + a * at(ni - 1, j) + (1 - b) * at(i, 0) + b * at(i, nj - 1);
      const Vector3 corners = (1 - a) * ((1 - b) * at(0, 0) + b * at(0, nj - 1)) +
                              a * ((1 - b) * at(ni - 1, 0) + b * at(ni - 1, nj - 1));
      mesh.nodes[mesh.index(i, j, k)] = sides - corners;
    }
  }
}

// Where around the tube a node of any slice lies.
void place_turns(const Surface& surface, const RingParameters& ring, LatticeMesh& mesh) {
  mesh.turns.assign(mesh.nodes.size(), 0.0);
  const double start = surface.u.domain_start(), period = surface.u.domain_end() - start;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.place(n);
    const Outward out = outward_of(surface, ring, mesh, at[0], at[1]);
    if (!(out.radius > 0.0)) continue;
    const double turns = (out.u - start) / period;
    mesh.turns[static_cast<std::size_t>(n)] = turns - std::floor(turns);
  }
}

// Nodes of an end slice: the ring, and inside it the cap, by polar coordinates about the pole.
void fill_cap(const Surface& surface, const RingParameters& ring, LatticeMesh& mesh, int k, double pole_v,
              double rim_v) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  ShareTable length_to_v;
  double length = 0.0;
  Vector3 previous = evaluate(surface, ring.u[0], pole_v).position_m;
  for (int s = 0; s <= 64; ++s) {
    const double v = pole_v + (rim_v - pole_v) * s / 64.0;
    const Vector3 point = evaluate(surface, ring.u[0], v).position_m;
    length += (point - previous).norm();
    previous = point;
    length_to_v.from.push_back(length);
    length_to_v.to.push_back(v);
  }
  for (int i = 0; i < ni; ++i) {
    for (int j = 0; j < nj; ++j) {
      const Outward out = outward_of(surface, ring, mesh, i, j);
      mesh.nodes[mesh.index(i, j, k)] =
          evaluate(surface, out.u, length_to_v.at(out.radius * length)).position_m;
    }
  }
}

void fill_ring(const Surface& surface, const RingParameters& ring, LatticeMesh& mesh, int k, double v) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  for (int i = 0; i < ni; ++i) {
    for (int j = 0; j < nj; ++j) {
      if (i != 0 && j != 0 && i != ni - 1 && j != nj - 1) continue;
      const double position = ring_position(2.0 * i / (ni - 1) - 1.0, 2.0 * j / (nj - 1) - 1.0, ni, nj);
      const double u = ring_parameter_at(surface, ring, position);
      mesh.nodes[mesh.index(i, j, k)] = evaluate(surface, u, v).position_m;
    }
  }
}

}  // namespace

Status check_closed_tube(const Surface& surface) {
  if (!surface.u.is_periodic()) return Error{"surface: u must be periodic for a closed body"};
  if (surface.v.is_periodic()) {
    return Error{"surface: v must be open, with a pole at both ends, for a closed body"};
  }
  const Ring first = sample_ring(surface, surface.v.domain_start());
  const Ring last = sample_ring(surface, surface.v.domain_end());
  const double size = (last.centre - first.centre).norm();
  if (!(size > 0.0)) return Error{"surface: the poles at both ends of v coincide; the body has no length"};
  if (first.perimeter > 1e-6 * size || last.perimeter > 1e-6 * size) {
    return Error{"surface: both ends of v must be poles (all control points of the edge in one place)"};
  }
  const double middle = along(surface.v, 0.5);
  const Ring ring = sample_ring(surface, middle);
  double outward = 0.0, radius = 0.0;
  for (int s = 0; s < ring_samples; s += 8) {
    const double u = along(surface.u, static_cast<double>(s) / ring_samples);
    outward += unit_normal(surface, u, middle).dot(ring.points[s] - ring.centre);
    radius += (ring.points[s] - ring.centre).norm();
  }
  if (!(std::abs(outward) > flat * radius)) {
    return Error{"surface: flat in the middle, where it encloses no volume; a body must be thick everywhere"};
  }
  if (!(outward > 0.0)) {
    return Error{"surface: normals point inward; reverse the order of the control points in u"};
  }
  return {};
}

Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch) {
  if (const Status status = check_closed_tube(surface); !status.ok()) return status.error();
  const Profile profile = sample_profile(surface);
  const std::size_t first_rim = find_rim(profile, false), last_rim = find_rim(profile, true);
  if (first_rim >= last_rim) return Error{"surface: too short between its caps for a lattice"};
  const double first_distance = profile.distance[first_rim], last_distance = profile.distance[last_rim];
  const double middle_v = ShareTable{profile.distance, profile.v}.at(0.5 * (first_distance + last_distance));
  const Ring middle = sample_ring(surface, middle_v);
  // Not from rim to rim: a coil's ends may lie anywhere.
  if (!(middle.along.norm() > 0.0)) {
    return Error{"surface: its rings do not move along v in the middle; spread its control points there"};
  }
  const CrossSection section = principal_axes(middle, middle.along.normalized());
  if (!(section.thickness >= least_thickness * section.width)) {
    return Error{"surface: " + number_text(section.thickness * 1e3) + " mm thick in the middle where it is " +
                 number_text(section.width * 1e3) +
                 " mm wide: too flat for a lattice; make it at least a ten-thousandth as thick"};
  }
  const Extents extents = extents_to_fill(surface, profile, first_rim, last_rim, section);
  const Result<std::array<int, 3>> counts =
      lattice_counts(request, {extents.width, extents.thickness, last_distance - first_distance});
  if (!counts.ok()) return counts.error();
  LatticeMesh mesh;
  mesh.count = counts.value();
  mesh.nodes.assign(static_cast<std::size_t>(mesh.node_count()), Vector3::Zero());
  const RingParameters ring = ring_parameters(surface, middle, section, mesh.count[0], mesh.count[1]);
  const ShareTable distance_to_v{profile.distance, profile.v};
  const int last = mesh.count[2] - 1;
  for (int k = 1; k < last; ++k) {
    fill_ring(surface, ring, mesh, k,
              distance_to_v.at(first_distance + (last_distance - first_distance) * k / last));
    fill_slice(mesh, k);
  }
  fill_cap(surface, ring, mesh, 0, surface.v.domain_start(), profile.v[first_rim]);
  fill_cap(surface, ring, mesh, last, surface.v.domain_end(), profile.v[last_rim]);
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  place_turns(surface, ring, mesh);
  if (request.feature_map) order_by_feature_map(mesh, *request.feature_map, watch);
  return mesh;
}

}  // namespace spoonbill
