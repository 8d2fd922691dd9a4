#include "engine/material/lattice/tube_lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/text.h"
#include "engine/bspline/tube_rings.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/lattice_counts.h"
#include "engine/material/lattice/unfolding.h"

namespace spoonbill {
namespace {

// Of the width: flatter bodies have cells that no spring holds open.
constexpr double least_thickness = 1e-4;

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

// How far into a slice its narrow sides make themselves felt: evenly, or where sections are bent, and a
// side's middle lies above its corners, near it alone.
double felt_inside(double share, bool bent) {
  const double rest = 1.0 - share;
  return bent ? rest * rest * rest * rest : rest;
}

// Transfinite (Coons) interpolation of a slice from its ring.
void fill_slice(LatticeMesh& mesh, int k, bool bent) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  const auto at = [&](int i, int j) -> const Vector3& { return mesh.nodes[mesh.index(i, j, k)]; };
  for (int i = 1; i + 1 < ni; ++i) {
    for (int j = 1; j + 1 < nj; ++j) {
      const double a = static_cast<double>(i) / (ni - 1), b = static_cast<double>(j) / (nj - 1);
      const double low = felt_inside(a, bent), high = bent ? felt_inside(1.0 - a, bent) : a;
      const Vector3 sides = low * at(0, j) + high * at(ni - 1, j) + (1 - b) * at(i, 0) + b * at(i, nj - 1);
      const Vector3 corners = low * ((1 - b) * at(0, 0) + b * at(0, nj - 1)) +
                              high * ((1 - b) * at(ni - 1, 0) + b * at(ni - 1, nj - 1));
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
  LinearTable length_to_v;
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

// The block, and the parameters u of its rings.
struct TubeBlock {
  LatticeMesh mesh;
  RingParameters ring;
};

Result<TubeBlock> lay_block(const Surface& surface, const Profile& profile, const Rims& rims,
                            const LatticeRequest& request) {
  if (rims.first >= rims.last) return Error{"surface: too short between its caps for a lattice"};
  const double first_distance = profile.distance[rims.first], last_distance = profile.distance[rims.last];
  const double middle_v = LinearTable{profile.distance, profile.v}.at(0.5 * (first_distance + last_distance));
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
  const Extents extents = lattice_extents(surface, profile, rims, section);
  const Result<std::array<int, 3>> counts =
      lattice_counts(request, {extents.width, extents.thickness, last_distance - first_distance});
  if (!counts.ok()) return counts.error();
  TubeBlock block;
  LatticeMesh& mesh = block.mesh;
  mesh.count = counts.value();
  mesh.nodes.assign(static_cast<std::size_t>(mesh.node_count()), Vector3::Zero());
  block.ring = ring_parameters(surface, middle, section, mesh.count[0], mesh.count[1]);
  const LinearTable distance_to_v{profile.distance, profile.v};
  const int last = mesh.count[2] - 1;
  for (int k = 1; k < last; ++k) {
    fill_ring(surface, block.ring, mesh, k,
              distance_to_v.at(first_distance + (last_distance - first_distance) * k / last));
    fill_slice(mesh, k, extents.bent);
  }
  fill_cap(surface, block.ring, mesh, 0, surface.v.domain_start(), profile.v[rims.first]);
  fill_cap(surface, block.ring, mesh, last, surface.v.domain_end(), profile.v[rims.last]);
  return block;
}

std::vector<int> nodes_inside(const LatticeMesh& mesh) {
  std::vector<int> inside;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto [i, j, k] = mesh.place(n);
    if (mesh.place_of(i, j, k) == NodePlace::in_body) inside.push_back(n);
  }
  return inside;
}

// For a block that folds where it is filled slice by slice: caps up to the shoulders, and the inside from all
// of the hull. The near rim of a narrow nose may lie on a flank as steep as the
// side below. Empty where that folds too.
std::optional<TubeBlock> unfolded_block(const Surface& surface, const Profile& profile,
                                        const LatticeRequest& request) {
  const Rims shoulders = shoulder_rims(profile);
  for (const Rims& rims : {further_rims(near_rims(profile), shoulders), shoulders}) {
    Result<TubeBlock> block = lay_block(surface, profile, rims, request);
    if (!block.ok()) continue;
    fill_from_hull(block->mesh);
    unfold(block->mesh, nodes_inside(block->mesh));
    if (smallest_jacobian_ratio(block->mesh) > 0.0) return std::move(block).value();
  }
  return std::nullopt;
}

}  // namespace

Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch) {
  if (const Status status = check_closed_tube(surface); !status.ok()) return status.error();
  const Profile profile = sample_profile(surface);
  Result<TubeBlock> block = lay_block(surface, profile, near_rims(profile), request);
  if (!block.ok()) return block.error();
  if (const Status status = check_cells(block->mesh); !status.ok()) {
    std::optional<TubeBlock> unfolded = unfolded_block(surface, profile, request);
    if (!unfolded) return status.error();
    block = std::move(*unfolded);
  }
  LatticeMesh mesh = std::move(block->mesh);
  place_turns(surface, block->ring, mesh);
  if (request.feature_map) order_by_feature_map(mesh, *request.feature_map, watch);
  return mesh;
}

}  // namespace spoonbill
