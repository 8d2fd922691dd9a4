#include "engine/inspection/solid_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/surfaces/surface_pair_collider.h"

namespace spoonbill {
namespace {

constexpr std::size_t max_meetings = 100'000, max_reported = 16;
// Spacing of the samples as a fraction of the solid's size, and the largest number of samples along a
// triangle's side.
constexpr double relative_spacing = 0.005;
constexpr int max_along_side = 200;
// Limit on the number of samples, in addition to one for each triangle. While there are more, the spacing
// grows by the factor `spacing_growth`.
constexpr std::size_t max_samples = 500'000;
constexpr double spacing_growth = 1.4;
// Margin between samples and the sides of their triangle, as a fraction of the triangle. A line that starts
// on a side would meet the neighbouring triangle.
constexpr double side_margin = 1e-6;

std::vector<Triangle> triangles_of(const TriangleMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]});
  }
  return triangles;
}

// Returns the point where a side of one triangle passes through the other. If rounding hides that point,
// returns the mean of all corners.
Vector3 find_crossing(const Triangle& first, const Triangle& second) {
  for (const auto& [sides, through] : {std::pair(first, second), std::pair(second, first)}) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const Vector3 side = sides[(k + 1) % sides.size()] - sides[k];
      const auto met = intersect_line_triangle(sides[k], side, through[0], through[1], through[2], 0.0);
      if (met && met->along >= 0.0 && met->along <= 1.0) return sides[k] + met->along * side;
    }
  }
  return (first[0] + first[1] + first[2] + second[0] + second[1] + second[2]) / 6.0;
}

void find_self_intersections(const TriangleMesh& mesh, const LineExits& exits, double error_m,
                             const Progress& progress, SolidCheck& check) {
  const std::vector<std::uint32_t>& order = exits.tree().order();
  std::vector<TriangleCorners> in_order;
  in_order.reserve(order.size());
  for (const std::uint32_t index : order) in_order.push_back(mesh.triangles[index]);
  const MeshIntersections contacts =
      self_intersections(mesh.vertices_m, in_order, exits.tree(), max_meetings, progress);
  check.self_intersections_complete = contacts.complete;
  for (const MeshIntersection& contact : contacts.found) {
    if (!(contact.depth_m > 2.0 * error_m)) continue;
    const Triangle& first = exits.triangles()[order[contact.first]];
    const Triangle& second = exits.triangles()[order[contact.second]];
    check.self_intersections.push_back({find_crossing(first, second), contact.depth_m});
  }
  std::stable_sort(check.self_intersections.begin(), check.self_intersections.end(),
                   [](const auto& a, const auto& b) { return a.depth_m > b.depth_m; });
  check.self_intersections.resize(std::min(check.self_intersections.size(), max_reported));
}

// Walls behind the triangles of a mesh, as a function of two parameters u and v for all triangles. In
// triangle k, u runs from k to k + 1 along the first side, and v from 0 at that side to 1 at the third
// corner.
class Walls {
 public:
  // Triangles whose height is below the error are skipped, because their normals are unreliable.
  Walls(const LineExits& exits, const TriangleMesh& mesh, double error_m)
      : exits_(exits), normals_(mesh), min_height_m_(error_m) {}

  std::vector<PieceCell> cells() const {
    double spacing = relative_spacing * exits_.tree().nodes()[0].box.size();
    while (cell_count(spacing) > max_samples + exits_.triangles().size()) spacing *= spacing_growth;
    std::vector<PieceCell> cells;
    for (std::size_t k = 0; k < exits_.triangles().size(); ++k) {
      const Division division = divide(exits_.triangles()[k], spacing);
      for (int i = 0; i < division.along; ++i) {
        for (int j = 0; j < division.across; ++j) {
          cells.push_back({inside(k, i, division.along), inside(k, i + 1, division.along),
                           inside(0, j, division.across), inside(0, j + 1, division.across)});
        }
      }
    }
    return cells;
  }

  std::optional<WallThickness> at(double u, double v) const {
    const auto k = static_cast<std::uint32_t>(u);
    const double to_b = (1.0 - v) * (u - k), to_c = v;
    const auto& [a, b, c] = exits_.triangles()[k];
    const Vector3 position = a + to_b * (b - a) + to_c * (c - a), inward = -normals_.at(k, to_b, to_c);
    const auto exit = exits_.first(position, inward);
    if (!exit || !exits_through_wall(exits_.triangles()[exit->triangle], inward)) return std::nullopt;
    return WallThickness{exit->distance_m, position, position + exit->distance_m * inward};
  }

 private:
  struct Division {
    int along = 0, across = 0;
  };
  Division divide(const Triangle& triangle, double spacing) const {
    const Vector3 side = triangle[1] - triangle[0], other = triangle[2] - triangle[0];
    const double length = side.norm(), height = length > 0.0 ? side.cross(other).norm() / length : 0.0;
    if (!(height > min_height_m_)) return {};
    return {count_over(length, spacing), count_over(height, spacing)};
  }
  std::size_t cell_count(double spacing) const {
    std::size_t count = 0;
    for (const Triangle& triangle : exits_.triangles()) {
      const Division division = divide(triangle, spacing);
      count += static_cast<std::size_t>(division.along) * static_cast<std::size_t>(division.across);
    }
    return count;
  }
  static int count_over(double length, double spacing) {
    return std::clamp(static_cast<int>(std::ceil(length / spacing)), 1, max_along_side);
  }
  static double inside(std::size_t k, int part, int parts) {
    const double fraction = static_cast<double>(part) / parts;
    return static_cast<double>(k) + std::clamp(fraction, side_margin, 1.0 - side_margin);
  }

  const LineExits& exits_;
  SmoothNormals normals_;
  double min_height_m_;
};

// Search for the thinnest wall. It first measures the walls of the mesh at the centres of all cells, and
// chooses the cells with the thinnest walls among those that agree with the exact surfaces. It is then
// refined in these cells. If no cell agrees, the mesh alone is used.
class ThinnestWallSearch {
 public:
  ThinnestWallSearch(const Walls& walls, const ExactWalls& exact) : walls_(walls), exact_(exact) {}

  std::optional<WallThickness> find(const Progress& progress) {
    const std::vector<PieceCell> cells = walls_.cells();
    const auto order = sort_by_thickness(cells, progress);
    std::vector<PieceCell> chosen = choose_cells(cells, order);
    uses_exact_walls_ = !chosen.empty();
    const std::size_t mesh_cells = uses_exact_walls_ ? 0 : std::min(max_chosen, order.size());
    for (std::size_t k = 0; k < mesh_cells; ++k) chosen.push_back(cells[order[k].second]);
    const ParameterMinimum found = find_minimum(chosen, [&](double u, double v) {
      const auto wall = at(u, v);
      return wall ? wall->thickness_m : std::numeric_limits<double>::infinity();
    });
    return std::isfinite(found.value) ? at(found.u, found.v) : std::nullopt;
  }

 private:
  static constexpr std::size_t max_chosen = 12, max_tested = 20'000, cells_between_reports = 1024;
  using Order = std::vector<std::pair<double, std::size_t>>;

  Order sort_by_thickness(const std::vector<PieceCell>& cells, const Progress& progress) const {
    Order order;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double fraction = static_cast<double>(k) / static_cast<double>(cells.size());
      if (k % cells_between_reports == 0 && !progress.report(fraction)) return {};
      const auto wall = walls_.at(cells[k].centre_u(), cells[k].centre_v());
      if (wall) order.emplace_back(wall->thickness_m, k);
    }
    std::sort(order.begin(), order.end());
    return order;
  }

  std::vector<PieceCell> choose_cells(const std::vector<PieceCell>& cells, const Order& order) const {
    std::vector<PieceCell> chosen;
    for (std::size_t k = 0; k < std::min(max_tested, order.size()) && chosen.size() < max_chosen; ++k) {
      const PieceCell& cell = cells[order[k].second];
      if (exact_.at(*walls_.at(cell.centre_u(), cell.centre_v()))) chosen.push_back(cell);
    }
    return chosen;
  }

  std::optional<WallThickness> at(double u, double v) const {
    const auto wall = walls_.at(u, v);
    return wall && uses_exact_walls_ ? exact_.at(*wall) : wall;
  }

  const Walls& walls_;
  const ExactWalls& exact_;
  bool uses_exact_walls_ = false;
};

}  // namespace

std::optional<SolidCheck> check_solid(const TriangleMesh& mesh, const std::vector<const Surface*>& surfaces,
                                      double error_m, const Progress& progress) {
  SPOONBILL_ASSERT(error_m >= 0.0 && !mesh.triangles.empty());
  SolidCheck check;
  bool continues = true;
  const Progress watched([&](double fraction) { return continues = continues && progress.report(fraction); });
  const LineExits exits(triangles_of(mesh));
  find_self_intersections(mesh, exits, error_m, watched.part(0.1, 0.1), check);
  if (!watched.report(0.1)) return std::nullopt;
  const Walls walls(exits, mesh, error_m);
  const ExactWalls exact(surfaces, error_m);
  check.thinnest = ThinnestWallSearch(walls, exact).find(watched.part(0.1, 1.0));
  return continues ? std::optional(check) : std::nullopt;
}

namespace {

// With this number of levels, cells are a quarter of an element wide, as for collisions in reports.
constexpr int levels = 2;

std::optional<BodyOverlap> find_overlap(const SurfacePairCollider& collider, const PairResult& result) {
  const std::vector<PairContact>& contacts = collider.contacts();
  if (!result.touching || contacts.empty()) return std::nullopt;
  const auto deepest = std::max_element(
      contacts.begin(), contacts.end(),
      [](const PairContact& one, const PairContact& other) { return one.depth_m < other.depth_m; });
  return BodyOverlap{0, 0, result.contained, deepest->depth_m, deepest->pair.first_m};
}

}  // namespace

std::optional<BodyOverlaps> find_body_overlaps(const std::vector<const Surface*>& bodies,
                                               const Progress& progress) {
  std::vector<Box> boxes;
  boxes.reserve(bodies.size());
  for (const Surface* body : bodies) {
    const Box box = bounding_box(body->net);
    boxes.push_back({box.low.array() - touch_tolerance_m, box.high.array() + touch_tolerance_m});
  }
  BodyOverlaps overlaps;
  const std::vector<BodyPair> pairs = BodyTree(boxes).near_pairs();
  double done = 0.0;
  for (const auto& [first, second] : pairs) {
    if (!progress.report(done++ / static_cast<double>(pairs.size()))) return std::nullopt;
    const Surface &a = *bodies[first], &b = *bodies[second];
    const auto grid_a = make_nested_grid(a.u, a.v, levels), grid_b = make_nested_grid(b.u, b.v, levels);
    if (!grid_a || !grid_b) {
      overlaps.complete = false;
      continue;
    }
    SurfacePairCollider collider(grid_a.value(), grid_b.value());
    PairQuery query;
    query.first_closed = query.second_closed = true;
    const PairResult result = collider.collide(a, b, query);
    overlaps.complete = overlaps.complete && !result.overflow;
    if (auto overlap = find_overlap(collider, result)) {
      overlap->first = first;
      overlap->second = second;
      overlaps.found.push_back(*overlap);
    }
  }
  return overlaps;
}

}  // namespace spoonbill
