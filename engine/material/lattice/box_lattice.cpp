#include "engine/material/lattice/box_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/strip_volumes.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/tube_rings.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {
namespace {

// Smallest ratio of a body's thickness to its length. The cells of a flatter body could collapse, because no
// spring would resist it.
constexpr double min_cell_thickness_ratio = 1e-4;
constexpr int samples_a_side = 5;

struct CellPosition {
  std::array<int, 3> cell;
  Vector3 local;  // position in the cell, 0 to 1 in each coordinate
};

CellPosition locate(const LatticeMesh& box, const Vector3& point) {
  const Vector3 low = box.nodes.front(), size = box.nodes.back() - low;
  CellPosition in;
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = box.count[axis] - 1;
    const double along = (point[axis] - low[axis]) / size[axis] * cells;
    in.cell[axis] = std::clamp(static_cast<int>(std::floor(along)), 0, cells - 1);
    in.local[axis] = along - in.cell[axis];
  }
  return in;
}

double inside_fraction(const ShellDistance& solid, const CellCorners& corners) {
  const Vector3 centre = 0.5 * (corners[0] + corners[7]);
  const double at_centre = solid.at(centre).distance_m, reach = (centre - corners[0]).norm();
  if (std::abs(at_centre) >= reach) return at_centre < 0.0 ? 1.0 : 0.0;
  int inside_count = 0;
  for (int s = 0; s < samples_a_side * samples_a_side * samples_a_side; ++s) {
    const auto fraction = [](int index) { return (index + 0.5) / samples_a_side; };
    const Vector3 point =
        trilinear(corners, fraction(s / (samples_a_side * samples_a_side)),
                  fraction(s / samples_a_side % samples_a_side), fraction(s % samples_a_side));
    inside_count += solid.at(point).distance_m < 0.0 ? 1 : 0;
  }
  return static_cast<double>(inside_count) / (samples_a_side * samples_a_side * samples_a_side);
}

// Sets LatticeMesh::node_locations. A node is in the body if all eight cells around it are filled, on the
// shell if only some of them are filled or exist, and outside the body if none is filled.
void set_node_locations(LatticeMesh& box) {
  box.node_locations.assign(static_cast<std::size_t>(box.node_count()), NodeLocation::outside_body);
  for (int n = 0; n < box.node_count(); ++n) {
    const std::array<int, 3> at = box.grid_index(n);
    int cells = 0;
    for (int c = 0; c < 8; ++c) {
      const std::array<int, 3> cell = {at[0] - (c >> 2 & 1), at[1] - (c >> 1 & 1), at[2] - (c & 1)};
      bool exists = true;
      for (int axis = 0; axis < 3; ++axis) exists &= cell[axis] >= 0 && cell[axis] < box.count[axis] - 1;
      if (exists && box.is_filled(cell[0], cell[1], cell[2])) ++cells;
    }
    NodeLocation& location = box.node_locations[static_cast<std::size_t>(n)];
    if (cells > 0) location = cells == 8 ? NodeLocation::in_body : NodeLocation::on_shell;
  }
}

}  // namespace

Result<LatticeMesh> box_lattice(const ShellDistance& inside, double volume_m3,
                                std::span<const Vector3> skin_m, std::array<int, 3> counts) {
  SPOONBILL_ASSERT(volume_m3 > 0.0);
  SPOONBILL_ASSERT(counts[0] >= 2 && counts[1] >= 2 && counts[2] >= 2);
  const Box& bounds = inside.bounds();
  const Vector3 size = bounds.high - bounds.low;
  if (!(size.minCoeff() >= min_cell_thickness_ratio * size.maxCoeff())) {
    return Error{ErrorCode::degenerate,
                 "mesh: it is " + number_text(size.minCoeff() * 1e3) + " mm thick and " +
                     number_text(size.maxCoeff() * 1e3) +
                     " mm long, which is too flat for a lattice; make the thickness at least 1/10000 of the "
                     "length",
                 "mesh"};
  }
  LatticeMesh box = box_mesh(size, counts);
  for (Vector3& node : box.nodes) node += bounds.low;
  box.filled.assign(box.cell_count(), false);
  for (const Vector3& point : skin_m) {
    const auto [i, j, k] = locate(box, point).cell;
    box.filled[box.cell_index(i, j, k)] = true;
  }
  box.cell_fractions.assign(box.cell_count(), void_fraction);
  double volume = 0.0;
  for (int k = 0; k + 1 < counts[2]; ++k) {
    for (int i = 0; i + 1 < counts[0]; ++i) {
      for (int j = 0; j + 1 < counts[1]; ++j) {
        const CellCorners corners = box.cell(i, j, k);
        const double fraction = inside_fraction(inside, corners);
        const std::size_t cell = box.cell_index(i, j, k);
        box.filled[cell] = box.filled[cell] || fraction > 0.0;
        if (box.filled[cell]) box.cell_fractions[cell] = std::max(fraction, min_filled_fraction);
        volume += box.cell_fractions[cell] * cell_volume(corners);
      }
    }
  }
  for (double& fraction : box.cell_fractions) fraction *= volume_m3 / volume;
  set_node_locations(box);
  return box;
}

CellPoint point_in_box(const LatticeMesh& box, const Vector3& point_m) {
  const auto [cell, local] = locate(box, point_m);
  CellPoint point;
  for (int c = 0; c < 8; ++c) {
    const std::array<int, 3> bit = {c >> 2 & 1, c >> 1 & 1, c & 1};
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= bit[axis] == 1 ? local[axis] : 1.0 - local[axis];
    point.nodes[c] = box.index(cell[0] + bit[0], cell[1] + bit[1], cell[2] + bit[2]);
    point.weights[c] = weight;
  }
  return point;
}

EmbeddedPoint embed_in_box(const LatticeMesh& box, const Vector3& point_m) {
  const CellPoint in_cell = point_in_box(box, point_m);
  EmbeddedPoint point;
  point.count = 8;
  for (int c = 0; c < 8; ++c) {
    point.node[c] = in_cell.nodes[c];
    point.weight[c] = static_cast<float>(in_cell.weights[c]);
  }
  return point;
}

namespace {

constexpr double edge_cells = 2.0 / 3.0;
constexpr std::size_t min_pieces = 8;

double shortest_edge_m(const LatticeMesh& box) {
  const CellCorners cell = box.cell(0, 0, 0);
  return std::min({(cell[4] - cell[0]).norm(), (cell[2] - cell[0]).norm(), (cell[1] - cell[0]).norm()});
}

// Drops parameters as long as no step becomes longer than `longest_m` and at least `min_pieces` steps remain.
// `step_m(from, to)` returns the largest distance between the surface's points at two parameters, which are
// given by their indices.
template <class StepOf>
std::vector<double> thin_out(const std::vector<double>& parameters, double longest_m, const StepOf& step_m) {
  const std::size_t last = parameters.size() - 1, most = std::max<std::size_t>(last / min_pieces, 1);
  std::vector<double> result = {parameters[0]};
  for (std::size_t from = 0, to = 1; to <= last; ++to) {
    const bool skips = to < last && to + 1 - from <= most && step_m(from, to + 1) <= longest_m;
    if (skips) continue;
    result.push_back(parameters[to]);
    from = to;
  }
  return result;
}

ClosedSkin coarse_skin(const Surface& surface, double longest_m) {
  const std::vector<double> u = skin_parameters(surface.u), v = skin_parameters(surface.v);
  std::vector<Vector3> samples;
  samples.reserve(u.size() * v.size());
  for (const double at_u : u) {
    for (const double at_v : v) samples.push_back(position(surface, at_u, at_v));
  }
  const auto distance_m = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    return (samples[i * v.size() + j] - samples[k * v.size() + l]).norm();
  };
  const auto over_u = [&](std::size_t from, std::size_t to) {
    double longest = 0.0;
    for (std::size_t j = 0; j < v.size(); ++j) longest = std::max(longest, distance_m(from, j, to, j));
    return longest;
  };
  const auto over_v = [&](std::size_t from, std::size_t to) {
    double longest = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) longest = std::max(longest, distance_m(i, from, i, to));
    return longest;
  };
  return sample_skin(surface, thin_out(u, longest_m, over_u), thin_out(v, longest_m, over_v));
}

// Returns the skin of a body in a box of cells. Its points are among the samples of make_skin(), with at
// least eight steps per direction. Where the samples are dense enough, the points are at most two thirds of a
// cell's shortest edge apart. A round body loses only thin slivers of its volume.
//
// `coordinates_at` returns the body coordinates of (u, v). The points are in filled cells if all samples of
// make_skin() are.
BodySkin make_body_skin(const Surface& surface, const LatticeMesh& box,
                        const std::function<BodyCoordinates(double u, double v)>& coordinates_at) {
  SPOONBILL_ASSERT(static_cast<bool>(coordinates_at));
  const ClosedSkin coarse = coarse_skin(surface, edge_cells * shortest_edge_m(box));
  BodySkin skin;
  skin.triangles = coarse.mesh.triangles;
  skin.points.reserve(coarse.mesh.vertices_m.size());
  for (const Vector3& point : coarse.mesh.vertices_m) skin.points.push_back(point_in_box(box, point));
  skin.triangle_centres.reserve(coarse.triangle_centres.size());
  for (const auto& [u, v] : coarse.triangle_centres) skin.triangle_centres.push_back(coordinates_at(u, v));
  return skin;
}

Status check_thick(const ClosedSkin& skin, double volume_m3, double size_m) {
  double area = 0.0;
  for (const TriangleCorners& t : skin.mesh.triangles) {
    const std::vector<Vector3>& at = skin.mesh.vertices_m;
    area += triangle_area(at[t[0]], at[t[1]], at[t[2]]);
  }
  const double thickness = 2.0 * volume_m3 / area;
  if (thickness >= min_cell_thickness_ratio * size_m) return {};
  return Error{ErrorCode::degenerate,
               "surface: it is " + number_text(thickness * 1e3) + " mm thick and " +
                   number_text(size_m * 1e3) +
                   " mm long, which is too flat for a lattice; make the thickness at least 1/10000 of the "
                   "length",
               "surface"};
}

// Returns the position along the body as a function of v: the fraction of its length, or of a full turn for a
// ring.
LinearTable fractions_along(const Surface& surface) {
  if (surface.v.is_periodic()) return {{surface.v.domain_start(), surface.v.domain_end()}, {0.0, 1.0}};
  const Profile profile = sample_profile(surface);
  LinearTable fractions{profile.v, profile.distance};
  for (double& distance : fractions.to) distance /= profile.distance.back();
  return fractions;
}

// Body coordinates of points on the surface, and of other points by the nearest sample of the surface.
class SurfaceCoordinates {
 public:
  SurfaceCoordinates(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside)
      : skin_(skin),
        inside_(inside),
        along_(fractions_along(surface)),
        start_(surface.u.domain_start()),
        period_(surface.u.domain_end() - start_) {}

  BodyCoordinates on_surface(double u, double v) const {
    const double turns = (u - start_) / period_;
    return {along_.at(v), turns - std::floor(turns), 0.0};
  }

  BodyCoordinates at(const Vector3& point) const {
    const TriangleCorners& corners = skin_.mesh.triangles[inside_.nearest_triangle(point)];
    const auto squared = [&](std::uint32_t corner) {
      return (skin_.mesh.vertices_m[corner] - point).squaredNorm();
    };
    const std::uint32_t nearest = *std::min_element(
        corners.begin(), corners.end(),
        [&](std::uint32_t one, std::uint32_t other) { return squared(one) < squared(other); });
    BodyCoordinates location = on_surface(skin_.u[nearest], skin_.v[nearest]);
    location.depth_m = std::max(0.0, -inside_.at(point).distance_m);
    return location;
  }

 private:
  const ClosedSkin& skin_;
  const ShellDistance& inside_;
  LinearTable along_;
  double start_, period_;
};

void set_node_coordinates(const SurfaceCoordinates& coordinates, LatticeMesh& box) {
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t n = 0; n < box.nodes.size(); ++n) {
    const bool outside = box.node_locations[n] == NodeLocation::outside_body;
    const BodyCoordinates location =
        outside ? BodyCoordinates{undefined, undefined, undefined} : coordinates.at(box.nodes[n]);
    box.along.push_back(location.along);
    box.turns.push_back(location.around);
    box.depth_m.push_back(location.depth_m);
  }
}

// Sets the body coordinates of all cells' centres. Even a void cell gets the coordinates of the nearest
// surface sample. It thus has the material of the body beside it and does not stiffen softer material.
void set_cell_coordinates(const SurfaceCoordinates& coordinates, LatticeMesh& box) {
  box.cell_centres.resize(box.cell_count());
  for (int k = 0; k + 1 < box.count[2]; ++k) {
    for (int i = 0; i + 1 < box.count[0]; ++i) {
      for (int j = 0; j + 1 < box.count[1]; ++j) {
        box.cell_centres[box.cell_index(i, j, k)] =
            coordinates.at(trilinear(box.cell(i, j, k), 0.5, 0.5, 0.5));
      }
    }
  }
}

// Bisects a triangle across its longest edge until no edge is longer than half a cell, and adds the
// midpoints.
void add_midpoints(const std::array<Vector3, 3>& corners, const Vector3& cell_m,
                   std::vector<Vector3>& points) {
  constexpr double longest_cells = 0.5;
  std::size_t longest = 0;
  std::array<double, 3> cells{};
  for (std::size_t c = 0; c < 3; ++c) {
    cells[c] = (corners[(c + 1) % 3] - corners[c]).cwiseQuotient(cell_m).norm();
    if (cells[c] > cells[longest]) longest = c;
  }
  if (!(cells[longest] > longest_cells)) return;
  const Vector3 &from = corners[longest], &to = corners[(longest + 1) % 3],
                &across = corners[(longest + 2) % 3];
  points.emplace_back(0.5 * (from + to));
  const Vector3 centre = points.back();
  add_midpoints({from, centre, across}, cell_m, points);
  add_midpoints({centre, to, across}, cell_m, points);
}

// Returns points on the skin, dense enough to hit every cell that the skin passes through, except where the
// skin only cuts off a corner.
std::vector<Vector3> sample_skin(const ClosedSkin& skin, const Vector3& size,
                                 const std::array<int, 3>& counts) {
  const Vector3 cell_m = size.cwiseQuotient(Vector3(counts[0] - 1, counts[1] - 1, counts[2] - 1));
  std::vector<Vector3> points = skin.mesh.vertices_m;
  const std::vector<Vector3>& at = skin.mesh.vertices_m;
  for (const TriangleCorners& t : skin.mesh.triangles) {
    add_midpoints({at[t[0]], at[t[1]], at[t[2]]}, cell_m, points);
  }
  return points;
}

// Returns whether the body is thinner than two cells at a point of the skin. It is thin there if the line
// straight inwards leaves the body within two cells, through a side that faces the opposite direction to
// within 45 degrees. A face beyond a sharp edge may be closer, but is not an opposite side.
bool is_thin_at(const ShellDistance& inside, const Vector3& skin_m, const Vector3& normal, double cell_m) {
  constexpr double far_side = -std::numbers::sqrt2 / 2.0;
  constexpr int bisections = 20;
  const auto at = [&](double cells) { return inside.at(skin_m - cells * cell_m * normal); };
  for (const double cells : {1.0, 2.0}) {
    if (at(cells).distance_m < 0.0) continue;
    double in = 0.0, out = cells;
    for (int k = 0; k < bisections; ++k) {
      const double centre = 0.5 * (in + out);
      (at(centre).distance_m < 0.0 ? in : out) = centre;
    }
    return at(out).gradient.dot(normal) < far_side;
  }
  return false;
}

bool is_slender(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside, double cell_m) {
  for (std::size_t vertex = 0; vertex < skin.u.size(); ++vertex) {
    const Vector3 normal = unit_normal(surface, skin.u[vertex], skin.v[vertex]);
    if (is_thin_at(inside, skin.mesh.vertices_m[vertex], normal, cell_m)) return true;
  }
  return false;
}

}  // namespace

Result<LatticeMesh> surface_in_box(const Surface& surface, const LatticeRequest& request) {
  const ClosedSkin skin = make_skin(surface);
  const double volume = compute_closed_volume_m3(surface);
  const ShellDistance inside(skin.mesh.vertices_m, skin.mesh.triangles, ShellDistance::Kind::solid);
  const Vector3 size = inside.bounds().high - inside.bounds().low;
  if (Status thick = check_thick(skin, volume, size.maxCoeff()); !thick) return thick.error();
  const Result<std::array<int, 3>> counts = lattice_counts(request, size);
  if (!counts) return counts.error();
  Result<LatticeMesh> box =
      box_lattice(inside, volume, sample_skin(skin, size, counts.value()), counts.value());
  if (!box) return box;
  const SurfaceCoordinates coordinates(surface, skin, inside);
  set_node_coordinates(coordinates, box.value());
  set_cell_coordinates(coordinates, box.value());
  box->skin =
      make_body_skin(surface, box.value(), [&](double u, double v) { return coordinates.on_surface(u, v); });
  box->slender = is_slender(surface, skin, inside, box->mean_edge());
  return box;
}

}  // namespace spoonbill
