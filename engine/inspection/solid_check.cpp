#include "engine/inspection/solid_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/inspection/exact_wall.h"
#include "engine/inspection/piece_sampling.h"

namespace spoonbill {
namespace {

constexpr std::size_t most_meetings = 100'000, most_told = 16;
// Samples lie this share of the size apart, though not more of them than that along a side of a triangle.
constexpr double sample_share = 0.005;
constexpr int most_along_side = 200;
// Beside one in each triangle; more are made wider.
constexpr std::size_t most_samples = 500'000;
constexpr double wider = 1.4;
// Of a triangle, kept off its sides, where a line meets what lies beside it.
constexpr double off_sides = 1e-6;

std::vector<Triangle> triangles_of(const TriangleMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]});
  }
  return triangles;
}

// Where a side of one goes through the other; between their middles where rounding hides that.
Vector3 place_of(const Triangle& first, const Triangle& second) {
  for (const auto& [sides, through] : {std::pair(first, second), std::pair(second, first)}) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const Vector3 way = sides[(k + 1) % sides.size()] - sides[k];
      const auto met = intersect_line_triangle(sides[k], way, through[0], through[1], through[2], 0.0);
      if (met && met->along >= 0.0 && met->along <= 1.0) return sides[k] + met->along * way;
    }
  }
  return (first[0] + first[1] + first[2] + second[0] + second[1] + second[2]) / 6.0;
}

void find_self_meetings(const TriangleMesh& mesh, const LineExits& exits, double error_m,
                        const Progress& progress, SolidCheck& check) {
  const std::vector<std::uint32_t>& order = exits.tree().order();
  std::vector<TriangleCorners> in_order;
  in_order.reserve(order.size());
  for (const std::uint32_t index : order) in_order.push_back(mesh.triangles[index]);
  const MeshIntersections meetings =
      self_intersections(mesh.vertices_m, in_order, exits.tree(), most_meetings, progress);
  check.self_meetings_complete = meetings.complete;
  for (const MeshIntersection& meeting : meetings.found) {
    if (!(meeting.depth_m > 2.0 * error_m)) continue;
    const Triangle& first = exits.triangles()[order[meeting.first]];
    const Triangle& second = exits.triangles()[order[meeting.second]];
    check.self_intersections.push_back({place_of(first, second), meeting.depth_m});
  }
  std::stable_sort(check.self_intersections.begin(), check.self_intersections.end(),
                   [](const auto& a, const auto& b) { return a.depth_m > b.depth_m; });
  check.self_intersections.resize(std::min(check.self_intersections.size(), most_told));
}

// All triangles side by side over one parameter plane: triangle k spans u from k to k + 1 along its first
// side and v from 0 there to 1 at its third corner.
class Walls {
 public:
  // What is less high than the error is too narrow to tell which way it faces.
  Walls(const LineExits& exits, const TriangleMesh& mesh, double error_m)
      : exits_(exits), normals_(mesh), least_height_m_(error_m) {}

  std::vector<PieceCell> cells() const {
    double spacing = sample_share * exits_.tree().nodes()[0].box.size();
    while (cell_count(spacing) > most_samples + exits_.triangles().size()) spacing *= wider;
    std::vector<PieceCell> cells;
    for (std::size_t k = 0; k < exits_.triangles().size(); ++k) {
      const Cut cut = cut_of(exits_.triangles()[k], spacing);
      for (int i = 0; i < cut.along; ++i) {
        for (int j = 0; j < cut.across; ++j) {
          cells.push_back({inside(k, i, cut.along), inside(k, i + 1, cut.along), inside(0, j, cut.across),
                           inside(0, j + 1, cut.across)});
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
  struct Cut {
    int along = 0, across = 0;
  };
  Cut cut_of(const Triangle& triangle, double spacing) const {
    const Vector3 side = triangle[1] - triangle[0], other = triangle[2] - triangle[0];
    const double length = side.norm(), height = length > 0.0 ? side.cross(other).norm() / length : 0.0;
    if (!(height > least_height_m_)) return {};
    return {count_over(length, spacing), count_over(height, spacing)};
  }
  std::size_t cell_count(double spacing) const {
    std::size_t count = 0;
    for (const Triangle& triangle : exits_.triangles()) {
      const Cut cut = cut_of(triangle, spacing);
      count += static_cast<std::size_t>(cut.along) * static_cast<std::size_t>(cut.across);
    }
    return count;
  }
  static int count_over(double length, double spacing) {
    return std::clamp(static_cast<int>(std::ceil(length / spacing)), 1, most_along_side);
  }
  static double inside(std::size_t k, int part, int parts) {
    const double share = static_cast<double>(part) / parts;
    return static_cast<double>(k) + std::clamp(share, off_sides, 1.0 - off_sides);
  }

  const LineExits& exits_;
  SmoothNormals normals_;
  double least_height_m_;
};

// The thinnest cells by their middles that the surfaces agree with, and what they tell of a place; by the
// mesh alone where they agree with none.
class Thinnest {
 public:
  Thinnest(const Walls& walls, const ExactWalls& exact) : walls_(walls), exact_(exact) {}

  std::optional<WallThickness> found(const Progress& progress) {
    const std::vector<PieceCell> cells = walls_.cells();
    const auto order = thinnest_first(cells, progress);
    std::vector<PieceCell> chosen = chosen_of(cells, order);
    is_exact_ = !chosen.empty();
    const std::size_t by_mesh = is_exact_ ? 0 : std::min(most_chosen, order.size());
    for (std::size_t k = 0; k < by_mesh; ++k) chosen.push_back(cells[order[k].second]);
    const ParameterPlace place = least_place(chosen, [&](double u, double v) {
      const auto wall = at(u, v);
      return wall ? wall->thickness_m : std::numeric_limits<double>::infinity();
    });
    return std::isfinite(place.value) ? at(place.u, place.v) : std::nullopt;
  }

 private:
  static constexpr std::size_t most_chosen = 12, most_asked = 20'000, cells_between_looks = 1024;
  using Order = std::vector<std::pair<double, std::size_t>>;

  Order thinnest_first(const std::vector<PieceCell>& cells, const Progress& progress) const {
    Order order;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(cells.size());
      if (k % cells_between_looks == 0 && !progress.report(share)) return {};
      const auto wall = walls_.at(cells[k].middle_u(), cells[k].middle_v());
      if (wall) order.emplace_back(wall->thickness_m, k);
    }
    std::sort(order.begin(), order.end());
    return order;
  }

  std::vector<PieceCell> chosen_of(const std::vector<PieceCell>& cells, const Order& order) const {
    std::vector<PieceCell> chosen;
    for (std::size_t k = 0; k < std::min(most_asked, order.size()) && chosen.size() < most_chosen; ++k) {
      const PieceCell& cell = cells[order[k].second];
      if (exact_.at(*walls_.at(cell.middle_u(), cell.middle_v()))) chosen.push_back(cell);
    }
    return chosen;
  }

  std::optional<WallThickness> at(double u, double v) const {
    const auto wall = walls_.at(u, v);
    return wall && is_exact_ ? exact_.at(*wall) : wall;
  }

  const Walls& walls_;
  const ExactWalls& exact_;
  bool is_exact_ = false;
};

}  // namespace

std::optional<SolidCheck> check_solid(const TriangleMesh& mesh, const std::vector<const Surface*>& surfaces,
                                      double error_m, const Progress& progress) {
  SPOONBILL_ASSERT(error_m >= 0.0 && !mesh.triangles.empty());
  SolidCheck check;
  bool goes_on = true;
  const Progress asked([&](double fraction) { return goes_on = goes_on && progress.report(fraction); });
  const LineExits exits(triangles_of(mesh));
  find_self_meetings(mesh, exits, error_m, asked.part(0.1, 0.1), check);
  if (!asked.report(0.1)) return std::nullopt;
  const Walls walls(exits, mesh, error_m);
  const ExactWalls exact(surfaces, error_m);
  check.thinnest = Thinnest(walls, exact).found(asked.part(0.1, 1.0));
  return goes_on ? std::optional(check) : std::nullopt;
}

}  // namespace spoonbill
