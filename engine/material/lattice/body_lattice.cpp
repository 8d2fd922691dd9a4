#include "engine/material/lattice/body_lattice.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/text.h"
#include "engine/bspline/tube_rings.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice/layer_volumes.h"
#include "engine/material/lattice/shell_lattice.h"

namespace spoonbill {
namespace {

constexpr int sweeps = 60, halvings = 10;
// The sweeps of unfold() end when no node moves farther than this fraction of the shortest mean edge.
constexpr double still_fraction = 1e-3;
// If the smallest determinant of a corner is below this value, unfold() regularises the terms of all corners.
// The determinant is 1 for a box of the mean edges.
constexpr double min_determinant = 1e-2;

// A cell around a node that unfold() moves: the nodes of the cell, and the number of the corner at which the
// moved node is.
struct CellAround {
  std::array<int, 8> nodes;
  int corner;
};

std::vector<CellAround> cells_around(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.grid_index(node);
  std::vector<CellAround> cells;
  for (int c = 0; c < 8; ++c) {
    std::array<int, 3> first = {at[0] - (c >> 2 & 1), at[1] - (c >> 1 & 1), at[2] - (c & 1)};
    if (mesh.closed) first[0] = (first[0] + mesh.count[0] - 1) % (mesh.count[0] - 1);
    bool exists = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      exists = exists && first[axis] >= 0 && first[axis] + 1 < mesh.count[axis];
    }
    if (!exists) continue;
    CellAround cell{{}, c};
    for (int other = 0; other < 8; ++other) {
      cell.nodes[static_cast<std::size_t>(other)] = mesh.joined(
          mesh.index(first[0] + (other >> 2 & 1), first[1] + (other >> 1 & 1), first[2] + (other & 1)));
    }
    cells.push_back(cell);
  }
  return cells;
}

Vector3 mean_edges(const LatticeMesh& mesh) {
  Vector3 sums = Vector3::Zero(), edges = Vector3::Zero();
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.grid_index(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<int, 3> next = at;
      if (++next[axis] == mesh.count[axis]) continue;
      const auto index = static_cast<Eigen::Index>(axis);
      sums[index] += (mesh.nodes[static_cast<std::size_t>(mesh.index(next[0], next[1], next[2]))] -
                      mesh.nodes[static_cast<std::size_t>(n)])
                         .norm();
      edges[index] += 1.0;
    }
  }
  return sums.cwiseQuotient(edges);
}

// A corner of a cell: its edges, each divided by the mean edge of its axis. `follows` contains the
// derivatives of the edges with respect to the position of the node that unfold() moves, 0 or +-1 divided by
// the mean edge.
struct Corner {
  std::array<Vector3, 3> edges;
  Vector3 follows;
  double determinant() const { return edges[0].dot(edges[1].cross(edges[2])); }
};

// Sum of the terms of unfold() over corners, its gradient and its second derivatives.
struct Sum {
  double value = 0.0;
  Vector3 gradient = Vector3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

void add_term(const Corner& corner, double lift_square, Sum& sum) {
  const auto& [a, b, c] = corner.edges;
  const std::array<Vector3, 3> cofactors = {b.cross(c), c.cross(a), a.cross(b)};
  Vector3 square_gradient = Vector3::Zero(), determinant_gradient = Vector3::Zero();
  double square = 0.0, twice = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double follows = corner.follows[static_cast<Eigen::Index>(axis)];
    square += corner.edges[axis].squaredNorm() / 3.0;
    square_gradient += 2.0 / 3.0 * follows * corner.edges[axis];
    determinant_gradient += follows * cofactors[axis];
    twice += 2.0 / 3.0 * follows * follows;
  }
  const double x = corner.determinant(), root = std::sqrt(x * x + 4.0 * lift_square);
  const double lifted = 0.5 * (x + root), size = std::sqrt(square);
  if (!(lifted > 0.0)) {
    sum.value = std::numeric_limits<double>::infinity();
    return;
  }
  const double power = square * size, slope = lifted / root, bend = 2.0 * lift_square / (root * root * root);
  const Vector3 power_gradient = 1.5 * size * square_gradient;
  sum.value += power / lifted;
  sum.gradient += power_gradient / lifted - power * slope / (lifted * lifted) * determinant_gradient;
  const Eigen::Matrix3d mixed = power_gradient * determinant_gradient.transpose();
  sum.second += (1.5 * size * twice * Eigen::Matrix3d::Identity() +
                 0.75 / size * square_gradient * square_gradient.transpose()) /
                    lifted -
                slope / (lifted * lifted) * (mixed + mixed.transpose()) +
                power * (2.0 * slope * slope / lifted - bend) / (lifted * lifted) * determinant_gradient *
                    determinant_gradient.transpose();
}

// The cell corners whose terms in unfold() depend on a given node. The node is the corner itself, or the
// other end of one of the corner's three edges.
class Around {
 public:
  Around(const LatticeMesh& mesh, int node, const Vector3& mean_edge)
      : mesh_(&mesh), cells_(cells_around(mesh, node)), mean_edge_(&mean_edge) {}

  template <class Visit>
  void visit(const Visit& visit) const {
    for (const CellAround& cell : cells_) {
      visit(corner(cell, cell.corner, 7));
      for (const int bit : {4, 2, 1}) visit(corner(cell, cell.corner ^ bit, bit));
    }
  }

  Sum sum(double lift_square) const {
    Sum sum;
    visit([&](const Corner& corner) { add_term(corner, lift_square, sum); });
    return sum;
  }

  double min_determinant() const {
    double least = std::numeric_limits<double>::infinity();
    visit([&](const Corner& corner) { least = std::min(least, corner.determinant()); });
    return least;
  }

 private:
  // `moving` is a bit mask of the axes whose edge at the corner `at` has an end at the node that unfold()
  // moves.
  Corner corner(const CellAround& cell, int at, int moving) const {
    const auto node = [&](int corner) -> const Vector3& {
      return mesh_->nodes[static_cast<std::size_t>(cell.nodes[static_cast<std::size_t>(corner)])];
    };
    Corner result{{}, Vector3::Zero()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int bit = 4 >> axis;
      const double edge = (*mean_edge_)[static_cast<Eigen::Index>(axis)];
      result.edges[axis] = (node(at | bit) - node(at & ~bit)) / edge;
      if ((moving & bit) == 0) continue;
      result.follows[static_cast<Eigen::Index>(axis)] = ((cell.corner & bit) != 0 ? 1.0 : -1.0) / edge;
    }
    return result;
  }

  const LatticeMesh* mesh_;
  std::vector<CellAround> cells_;
  const Vector3* mean_edge_;
};

// Returns Newton's step, with a diagonal shift if the second derivatives are not positive definite.
Vector3 newton_step(const Sum& sum) {
  constexpr int tries = 7;
  const double size = sum.second.diagonal().cwiseAbs().sum();
  double added = 0.0;
  for (int attempt = 0; attempt < tries; ++attempt) {
    const Eigen::LLT<Eigen::Matrix3d> factor(sum.second + added * size * Eigen::Matrix3d::Identity());
    if (factor.info() == Eigen::Success) return -factor.solve(sum.gradient);
    added = attempt == 0 ? 1e-2 : 4.0 * added;
  }
  return -sum.gradient / size;
}

// Moves a node so that the sum of the terms around it decreases. Returns the distance moved, or 0 if no step
// decreases the sum.
double move_node(const Around& around, double lift_square, Vector3& node) {
  const Sum sum = around.sum(lift_square);
  if (!std::isfinite(sum.value)) return 0.0;
  const Vector3 before = node, step = newton_step(sum);
  if (!step.allFinite()) return 0.0;
  double fraction = 1.0;
  for (int halving = 0; halving <= halvings; ++halving, fraction *= 0.5) {
    node = before + fraction * step;
    if (around.sum(lift_square).value < sum.value) return fraction * step.norm();
  }
  node = before;
  return 0.0;
}

// Sets every node that is not on the hull by the Boolean sum of linear interpolations between the three pairs
// of faces (Gordon and Hall 1973), or between two pairs in a closed block, which has no faces at its seam.
void fill_from_hull(LatticeMesh& mesh) {
  const std::array<int, 3> last = {mesh.count[0] - 1, mesh.count[1] - 1, mesh.count[2] - 1};
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.grid_index(n);
    if (mesh.node_location(at[0], at[1], at[2]) != NodeLocation::in_body) continue;
    Vector3 point = Vector3::Zero();
    // Faces are at an end of one axis, edges of two and corners of three. The Boolean sum adds faces,
    // subtracts edges and adds corners.
    for (int ends = 1; ends < 27; ++ends) {
      const std::array<int, 3> end = {ends / 9, ends / 3 % 3, ends % 3};  // 0: not at an end of this axis
      if (mesh.closed && end[0] != 0) continue;
      double weight = -1.0;
      std::array<int, 3> from = at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (end[axis] == 0) continue;
        const double fraction = static_cast<double>(at[axis]) / last[axis];
        weight *= end[axis] == 1 ? fraction - 1.0 : -fraction;
        from[axis] = end[axis] == 1 ? 0 : last[axis];
      }
      point += weight * mesh.nodes[static_cast<std::size_t>(mesh.index(from[0], from[1], from[2]))];
    }
    mesh.nodes[static_cast<std::size_t>(n)] = point;
  }
}

// Moves the nodes of `movable`, one at a time in sweeps, to minimise the sum over the corners of
// |S|^3 / (3^1.5 h(det S)). S has the corner's edges as columns, each divided by the block's mean edge in its
// direction. h(x) = (x + sqrt(x^2 + 4 d^2)) / 2 keeps the sum finite while cells are folded (Escobar et al.
// 2003; Knupp 2001 for the measure).
//
// For d = 0 a corner's term is convex in the position of a node, since det S is affine in it. `movable` must
// contain representatives of joined nodes only (LatticeMesh::joined()). The result is deterministic; the
// caller checks for remaining folds.
void unfold(LatticeMesh& mesh, const std::vector<int>& movable) {
  const Vector3 mean_edge = mean_edges(mesh);
  std::vector<Around> around;
  around.reserve(movable.size());
  for (const int node : movable) around.emplace_back(mesh, node, mean_edge);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double least = std::numeric_limits<double>::infinity(), farthest = 0.0;
    for (const Around& one : around) least = std::min(least, one.min_determinant());
    const double lift_square = least < min_determinant ? min_determinant * (min_determinant - least) : 0.0;
    for (std::size_t m = 0; m < movable.size(); ++m) {
      Vector3& node = mesh.nodes[static_cast<std::size_t>(movable[m])];
      farthest = std::max(farthest, move_node(around[m], lift_square, node));
      mesh.nodes[static_cast<std::size_t>(mesh.twin(movable[m]))] = node;
    }
    if (least > 0.0 && farthest < still_fraction * mean_edge.minCoeff()) break;
  }
}

// Returns the smallest Jacobian determinant at the corners and the eight Gauss points of all cells, each
// divided by its cell's volume; -1 if a cell has no positive volume.
double smallest_mesh_jacobian_ratio(const LatticeMesh& mesh) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0), high = 1.0 - low;
  double smallest = std::numeric_limits<double>::infinity();
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        const CellCorners cell = mesh.cell(i, j, k);
        const double volume = cell_volume(cell);
        if (!(volume > 0.0)) return -1.0;
        smallest = std::min(smallest, smallest_jacobian_ratio(cell));
        for (int c = 0; c < 8; ++c) {
          const Eigen::Matrix3d jacobian = trilinear_jacobian(
              cell, (c & 4) != 0 ? high : low, (c & 2) != 0 ? high : low, (c & 1) != 0 ? high : low);
          smallest = std::min(smallest, jacobian.determinant() / volume);
        }
      }
    }
  }
  return smallest;
}

// Smallest ratio of a tube's thickness to its width at half its length. The cells of a flatter body could
// collapse, because no spring would resist it.
constexpr double min_thickness_ratio = 1e-4;

// Position of a node in its slice, in polar form. The direction from the slice's centre is given as the
// surface parameter u, arbitrary at the centre. The radius is 0 at the centre and 1 on the surface.
struct Outward {
  double u = 0.0;
  double radius = 0.0;
};

Outward find_outward(const Surface& surface, const RingParameters& ring, const LatticeMesh& mesh, int i,
                     int j) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  const double s = 2.0 * i / (ni - 1) - 1.0, t = 2.0 * j / (nj - 1) - 1.0;
  const double radius = std::max(std::abs(s), std::abs(t));
  if (!(radius > 0.0)) return {ring.u[0], 0.0};
  const double on_s = std::abs(s) == radius ? std::copysign(1.0, s) : s / radius;
  const double on_t = std::abs(t) == radius ? std::copysign(1.0, t) : t / radius;
  return {ring_parameter_at(surface, ring, ring_position(on_s, on_t, ni, nj)), radius};
}

// Returns the weight of a slice's narrow side in fill_slice(). `fraction` is the distance from this side, as
// a fraction of the slice's width. The weight is linear, except in a bent section. There the centre of a
// narrow side is at the rim of the bend, higher than the side's corners, so the weight is concentrated near
// the side.
double side_influence(double fraction, bool bent) {
  const double rest = 1.0 - fraction;
  return bent ? rest * rest * rest * rest : rest;
}

// Fills the inside of a slice from the nodes around it by transfinite (Coons) interpolation.
void fill_slice(LatticeMesh& mesh, int k, bool bent) {
  const int ni = mesh.count[0], nj = mesh.count[1];
  const auto at = [&](int i, int j) -> const Vector3& { return mesh.nodes[mesh.index(i, j, k)]; };
  for (int i = 1; i + 1 < ni; ++i) {
    for (int j = 1; j + 1 < nj; ++j) {
      const double a = static_cast<double>(i) / (ni - 1), b = static_cast<double>(j) / (nj - 1);
      const double low = side_influence(a, bent), high = bent ? side_influence(1.0 - a, bent) : a;
      const Vector3 sides = low * at(0, j) + high * at(ni - 1, j) + (1 - b) * at(i, 0) + b * at(i, nj - 1);
      const Vector3 corners = low * ((1 - b) * at(0, 0) + b * at(0, nj - 1)) +
                              high * ((1 - b) * at(ni - 1, 0) + b * at(ni - 1, nj - 1));
      mesh.nodes[mesh.index(i, j, k)] = sides - corners;
    }
  }
}

// Sets each node's position around the tube.
void set_turns(const Surface& surface, const RingParameters& ring, LatticeMesh& mesh) {
  mesh.turns.assign(mesh.nodes.size(), 0.0);
  const double start = surface.u.domain_start(), period = surface.u.domain_end() - start;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.grid_index(n);
    const Outward out = find_outward(surface, ring, mesh, at[0], at[1]);
    if (!(out.radius > 0.0)) continue;
    const double turns = (out.u - start) / period;
    mesh.turns[static_cast<std::size_t>(n)] = turns - std::floor(turns);
  }
}

// Sets all nodes of an end slice on the cap of the tube, by polar coordinates about the pole. The cap ends at
// `rim_v`.
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
      const Outward out = find_outward(surface, ring, mesh, i, j);
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

// A block of nodes in a tube, with the surface parameters of its slices and of the nodes around them.
struct TubeBlock {
  LatticeMesh mesh;
  TubeStations stations;
};

Result<TubeBlock> make_block(const Surface& surface, const Profile& profile, const Rims& rims,
                             const LatticeRequest& request) {
  if (rims.first >= rims.last)
    return Error{ErrorCode::degenerate, "surface: too short between its caps for a lattice; lengthen it",
                 "surface"};
  const double first_distance = profile.distance[rims.first], last_distance = profile.distance[rims.last];
  const double centre_v = LinearTable{profile.distance, profile.v}.at(0.5 * (first_distance + last_distance));
  const Ring centre_ring = sample_ring(surface, centre_v);
  // The section is perpendicular to the tube's direction at the section's centre. The line between the tube's
  // ends would not do, because the ends of a coil may be anywhere.
  if (!(centre_ring.along.norm() > 0.0)) {
    return Error{ErrorCode::degenerate,
                 "surface: its rings coincide along v at half its length; spread its control points there",
                 "surface"};
  }
  const CrossSection section = principal_axes(centre_ring, centre_ring.along.normalized());
  if (!(section.thickness >= min_thickness_ratio * section.width)) {
    return Error{
        ErrorCode::degenerate,
        "surface: at half its length it is " + number_text(section.thickness * 1e3) + " mm thick and " +
            number_text(section.width * 1e3) +
            " mm wide, which is too flat for a lattice; make the thickness at least 1/10000 of the width",
        "surface"};
  }
  const Extents extents = lattice_extents(surface, profile, rims, section);
  const Result<std::array<int, 3>> counts =
      lattice_counts(request, {extents.width, extents.thickness, last_distance - first_distance});
  if (!counts.ok()) return counts.error();
  TubeBlock block;
  LatticeMesh& mesh = block.mesh;
  mesh.count = counts.value();
  mesh.nodes.assign(static_cast<std::size_t>(mesh.node_count()), Vector3::Zero());
  RingParameters& ring = block.stations.ring;
  ring = ring_parameters(surface, centre_ring, section, mesh.count[0], mesh.count[1]);
  const LinearTable distance_to_v{profile.distance, profile.v};
  const int last = mesh.count[2] - 1;
  std::vector<double>& v = block.stations.v;
  v.push_back(surface.v.domain_start());
  for (int k = 1; k < last; ++k) {
    v.push_back(distance_to_v.at(first_distance + (last_distance - first_distance) * k / last));
    fill_ring(surface, ring, mesh, k, v.back());
    fill_slice(mesh, k, extents.bent);
  }
  v.push_back(surface.v.domain_end());
  fill_cap(surface, ring, mesh, 0, v.front(), profile.v[rims.first]);
  fill_cap(surface, ring, mesh, last, v.back(), profile.v[rims.last]);
  return block;
}

std::vector<int> nodes_inside(const LatticeMesh& mesh) {
  std::vector<int> inside;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto [i, j, k] = mesh.grid_index(n);
    if (mesh.node_location(i, j, k) == NodeLocation::in_body) inside.push_back(n);
  }
  return inside;
}

// Builds a block for a body whose cells fold if the block is filled slice by slice. The interior is filled
// from the whole hull and unfolded. The first attempt uses caps up to the near rims or the shoulders (see
// Rims), whichever are farther from the pole. The second attempt uses caps up to the shoulders, because the
// near rim of a narrow nose may be on a flank as steep as the side. Returns nothing if both blocks fold.
std::optional<TubeBlock> make_unfolded_block(const Surface& surface, const Profile& profile,
                                             const LatticeRequest& request) {
  const Rims shoulders = shoulder_rims(profile);
  for (const Rims& rims : {further_rims(near_rims(profile), shoulders), shoulders}) {
    Result<TubeBlock> block = make_block(surface, profile, rims, request);
    if (!block.ok()) continue;
    fill_from_hull(block->mesh);
    unfold(block->mesh, nodes_inside(block->mesh));
    if (smallest_mesh_jacobian_ratio(block->mesh) > 0.0) return std::move(block).value();
  }
  return std::nullopt;
}

}  // namespace

Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch) {
  if (const Status status = check_closed_tube(surface); !status.ok()) return status.error();
  const Profile profile = sample_profile(surface);
  Result<TubeBlock> block = make_block(surface, profile, near_rims(profile), request);
  if (!block.ok()) return block.error();
  if (const Status status = check_cells(block->mesh); !status.ok()) {
    std::optional<TubeBlock> unfolded = make_unfolded_block(surface, profile, request);
    if (!unfolded) return status.error();
    block = std::move(*unfolded);
  }
  LatticeMesh mesh = std::move(block->mesh);
  set_turns(surface, block->stations.ring, mesh);
  if (request.feature_map) order_by_feature_map(mesh, *request.feature_map, watch);
  scale_layers_to(tube_layer_volumes_m3(surface, block->stations, mesh), mesh);
  return mesh;
}

Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch) {
  if (surface.v.is_periodic() || request.cells == LatticeCells::box) {
    if (Status closed = check_closed(surface); !closed) return closed.error();
    return surface_in_box(surface, request);
  }
  Result<LatticeMesh> along = tube_lattice(surface, request, watch);
  if (along || !check_closed(surface)) return along;
  Result<LatticeMesh> about = surface_in_box(surface, request);
  return about ? about : along;
}

Result<LatticeMesh> rigid_frame(const Body& body) {
  const Box box = find_bounds(body);
  if (!(box.size() > 0.0)) {
    return Error{ErrorCode::degenerate, "all points of the body coincide; give it an extent",
                 body.mesh ? "mesh" : "control_points_mm"};
  }
  // A flat surface needs a cell that is not flat.
  const Vector3 extent = box.extent().cwiseMax(0.1 * box.size());
  LatticeMesh frame = box_mesh(extent, {2, 2, 2});
  for (Vector3& node : frame.nodes) node += box.centre() - 0.5 * extent;
  frame.is_frame = true;
  frame.node_locations.assign(frame.nodes.size(), NodeLocation::outside_body);
  return frame;
}

Result<LatticeMesh> make_body_lattice(const Body& body, const FeatureMapWatch& watch) {
  if (body.kind != BodyKind::deformable) {
    const bool may_be_open = body.mesh || body.shell_thickness_m;
    const Status closed = may_be_open ? Status() : check_closed(body.surface);
    return closed.ok() ? rigid_frame(body) : closed.error();
  }
  if (body.shell_thickness_m) return shell_lattice(body.surface, *body.shell_thickness_m, body.lattice);
  return solid_lattice(body.surface, body.lattice, watch);
}

}  // namespace spoonbill
