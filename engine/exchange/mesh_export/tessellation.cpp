#include "engine/exchange/mesh_export/tessellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

// Largest height of a triangle that counts as a sliver, and largest distance between vertices that are
// merged.
constexpr double smallest_height_m = 1e-9;
constexpr std::size_t no_triangle = std::numeric_limits<std::size_t>::max();

bool is_degenerate(const TriangleCorners& corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

double length_m(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.vertices_m[a] - mesh.vertices_m[b]).norm();
}

bool is_sliver(const TriangleMesh& mesh, const TriangleCorners& corners) {
  const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                &c = mesh.vertices_m[corners[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return (b - a).cross(c - a).norm() <= smallest_height_m * longest;
}

// Rotates the corners so that the first two are the ends of the longest edge.
TriangleCorners rotate_longest_first(const TriangleMesh& mesh, TriangleCorners corners) {
  const double first = length_m(mesh, corners[0], corners[1]),
               second = length_m(mesh, corners[1], corners[2]),
               third = length_m(mesh, corners[2], corners[0]);
  const int turns = first >= second && first >= third ? 0 : second >= third ? 1 : 2;
  std::rotate(corners.begin(), corners.begin() + turns, corners.end());
  return corners;
}

void drop_degenerate(TriangleMesh& mesh) {
  std::erase_if(mesh.triangles, is_degenerate);
}

void merge_near_corners(TriangleMesh& mesh) {
  std::vector<std::uint32_t> representative(mesh.vertices_m.size());
  std::iota(representative.begin(), representative.end(), 0U);
  const auto root = [&](std::uint32_t vertex) {
    while (representative[vertex] != vertex) {
      vertex = representative[vertex] = representative[representative[vertex]];
    }
    return vertex;
  };
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = root(corners[k]), b = root(corners[(k + 1) % 3]);
      if (length_m(mesh, a, b) <= smallest_height_m) representative[std::max(a, b)] = std::min(a, b);
    }
  }
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = root(corner);
  }
  drop_degenerate(mesh);
}

std::uint32_t find_apex(const TriangleCorners& corners, std::uint32_t from, std::uint32_t to) {
  for (const std::uint32_t corner : corners) {
    if (corner != from && corner != to) return corner;
  }
  return from;
}

// Remover of slivers by edge flips.
class SliverRemover {
 public:
  explicit SliverRemover(TriangleMesh& mesh) : mesh_(mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (is_sliver(mesh, mesh.triangles[t])) queue_.push_back(t);
    }
    if (queue_.empty()) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) add_edges(t);
  }

  // Flips edges of slivers until no sliver is left, no flip is possible, or the limit is reached. A sliver
  // beside another one is postponed.
  void run() {
    const std::size_t flip_limit = flips_per_sliver * queue_.size();
    std::size_t idle = 0, flips = 0;
    while (!queue_.empty() && idle < queue_.size() && flips < flip_limit) {
      const std::size_t t = queue_.front();
      queue_.pop_front();
      if (resolve(t)) {
        ++flips;
        idle = 0;
      } else {
        queue_.push_back(t);
        ++idle;
      }
    }
  }

 private:
  static constexpr std::size_t flips_per_sliver = 8;

  static std::uint64_t key(std::uint32_t from, std::uint32_t to) { return (std::uint64_t{from} << 32U) | to; }
  std::size_t owner(std::uint32_t from, std::uint32_t to) const {
    const auto found = owner_.find(key(from, to));
    return found == owner_.end() ? no_triangle : found->second;
  }
  void add_edges(std::size_t t) {
    const TriangleCorners& corners = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) owner_[key(corners[k], corners[(k + 1) % 3])] = t;
  }
  void remove_edges(std::size_t t) {
    const TriangleCorners& corners = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) owner_.erase(key(corners[k], corners[(k + 1) % 3]));
  }
  void replace(std::size_t t, const TriangleCorners& corners) {
    mesh_.triangles[t] = corners;
    add_edges(t);
    if (is_sliver(mesh_, corners)) queue_.push_back(t);
  }

  // Flips the longest edge of a sliver, or removes the sliver if this edge is on the boundary. Returns false
  // if neither is possible.
  bool resolve(std::size_t t) {
    if (!is_sliver(mesh_, mesh_.triangles[t]) || is_degenerate(mesh_.triangles[t])) return true;
    const auto [p, q, between] = rotate_longest_first(mesh_, mesh_.triangles[t]);
    const std::size_t neighbour = owner(q, p);
    if (neighbour == no_triangle) {
      remove_edges(t);
      mesh_.triangles[t] = {p, p, p};
      return true;
    }
    const std::uint32_t apex = find_apex(mesh_.triangles[neighbour], p, q);
    const bool edge_exists = owner(between, apex) != no_triangle || owner(apex, between) != no_triangle;
    if (apex == between || edge_exists || is_sliver(mesh_, mesh_.triangles[neighbour])) return false;
    remove_edges(t);
    remove_edges(neighbour);
    replace(t, {between, p, apex});
    replace(neighbour, {apex, q, between});
    return true;
  }

  TriangleMesh& mesh_;
  std::deque<std::size_t> queue_;
  std::unordered_map<std::uint64_t, std::size_t> owner_;  // triangle of each directed edge
};

void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> new_index(mesh.vertices_m.size(), 0);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) new_index[corner] = 1;
  }
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < new_index.size(); ++v) {
    if (new_index[v] == 0) continue;
    mesh.vertices_m[count] = mesh.vertices_m[v];
    new_index[v] = count++;
  }
  mesh.vertices_m.resize(count);
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = new_index[corner];
  }
}

// Removes slivers, triangles whose height is at most a nanometre. They result from cutting cells along trim
// loops. Corners that are close together are merged. The longest edge of any other sliver is flipped, so that
// no gap opens.
void remove_slivers(TriangleMesh& mesh) {
  merge_near_corners(mesh);
  SliverRemover(mesh).run();
  drop_degenerate(mesh);
  drop_unused_vertices(mesh);
}

// Distance below which coordinates count as equal, because files round them.
constexpr double coincidence_m = 1e-9;
// Fraction of the chord error that the curvature along each of the two directions may use; the rest is for
// the twist.
constexpr double direction_fraction = 0.4;
// Smallest fraction of the chord error that remains for the cells; the edges of trim loops may use the rest.
constexpr double smallest_cell_fraction = 0.5;

// Number of cells into which each knot span of one direction is divided.
using Cuts = std::vector<int>;

std::vector<double> subdivide(const std::vector<double>& pieces, const Cuts& cuts) {
  std::vector<double> parameters;
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    for (int i = 0; i < cuts[k]; ++i) {
      parameters.push_back(pieces[k] + (pieces[k + 1] - pieces[k]) * i / cuts[k]);
    }
  }
  parameters.push_back(pieces.back());
  return parameters;
}

struct Cells {
  std::vector<double> u_pieces, v_pieces;
  Cuts u_cuts, v_cuts;

  std::size_t triangles() const {
    double rows = 0.0, columns = 0.0;
    for (const int count : u_cuts) rows += count;
    for (const int count : v_cuts) columns += count;
    return static_cast<std::size_t>(std::min(2.0 * rows * columns, 1e18));
  }
};

int count_cuts(double bulge, double allowed) {
  return std::max(1, static_cast<int>(std::min(std::ceil(std::sqrt(bulge / allowed)), 1e6)));
}

Cells initial_cells(const Surface& surface, const SurfaceBounds& bounds, double chord_m) {
  Cells cells{surface.u.breakpoints(), surface.v.breakpoints(), {}, {}};
  cells.u_cuts.assign(static_cast<std::size_t>(bounds.elements_u()), 1);
  cells.v_cuts.assign(static_cast<std::size_t>(bounds.elements_v()), 1);
  const double allowed = direction_fraction * chord_m;
  for (int a = 0; a < bounds.elements_u(); ++a) {
    for (int b = 0; b < bounds.elements_v(); ++b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      const double u_length = cells.u_pieces[i + 1] - cells.u_pieces[i];
      const double v_length = cells.v_pieces[j + 1] - cells.v_pieces[j];
      cells.u_cuts[i] = std::max(cells.u_cuts[i], count_cuts(bounds.bulge(a, b, u_length, 0.0), allowed));
      cells.v_cuts[j] = std::max(cells.v_cuts[j], count_cuts(bounds.bulge(a, b, 0.0, v_length), allowed));
    }
  }
  return cells;
}

// Grid of cells and the points of the surface at its corners.
struct Sheet {
  Grid grid;
  GridSamples<double> samples;

  Vector3 point(std::size_t i, std::size_t j) const {
    const std::size_t k = i * grid.v.parameters.size() + j;
    return {samples.x[k], samples.y[k], samples.z[k]};
  }
};

Result<Sheet> sample_sheet(const Surface& surface, const Cells& cells) {
  auto grid = make_grid(surface.u, surface.v, subdivide(cells.u_pieces, cells.u_cuts),
                        subdivide(cells.v_pieces, cells.v_cuts));
  if (!grid) return grid.error();
  Sheet sheet{std::move(grid).value(), {}};
  sheet.samples.resize(sheet.grid.u.parameters.size() * sheet.grid.v.parameters.size());
  GridEvaluator<double> evaluator(sheet.grid, best_instruction_set());
  evaluator.points(surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), sheet.samples);
  return sheet;
}

// Returns, for each polynomial piece of the surface, the largest error of its cells in metres. If a stop is
// requested, the errors not yet measured are 0.
Eigen::MatrixXd measure_errors(const Sheet& sheet, const SurfaceBounds& bounds, const Cells& cells,
                               const Progress& progress) {
  Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(bounds.elements_u(), bounds.elements_v());
  std::size_t i = 0;
  for (int a = 0; a < bounds.elements_u(); ++a) {
    if (!progress.report(0.0)) break;
    for (int k = 0; k < cells.u_cuts[static_cast<std::size_t>(a)]; ++k, ++i) {
      std::size_t j = 0;
      for (int b = 0; b < bounds.elements_v(); ++b) {
        for (int l = 0; l < cells.v_cuts[static_cast<std::size_t>(b)]; ++l, ++j) {
          const double h_u = sheet.grid.u.parameters[i + 1] - sheet.grid.u.parameters[i];
          const double h_v = sheet.grid.v.parameters[j + 1] - sheet.grid.v.parameters[j];
          const Vector3 twist =
              sheet.point(i, j) - sheet.point(i + 1, j) - sheet.point(i, j + 1) + sheet.point(i + 1, j + 1);
          errors(a, b) = std::max(errors(a, b), bounds.bulge(a, b, h_u, h_v) + 0.25 * twist.norm());
        }
      }
    }
  }
  return errors;
}

void refine(const Eigen::MatrixXd& errors, double chord_m, Cells& cells) {
  const auto more = [](int& count, double worst, double allowed) {
    if (worst <= allowed) return;
    const double factor = std::clamp(std::sqrt(worst / allowed), 1.0, 4.0);
    count = std::max(count + 1, static_cast<int>(std::ceil(count * factor)));
  };
  for (Eigen::Index a = 0; a < errors.rows(); ++a) {
    more(cells.u_cuts[static_cast<std::size_t>(a)], errors.row(a).maxCoeff(), chord_m);
  }
  for (Eigen::Index b = 0; b < errors.cols(); ++b) {
    more(cells.v_cuts[static_cast<std::size_t>(b)], errors.col(b).maxCoeff(), chord_m);
  }
}

// Map from the corners of the cells to the vertices of the mesh. Corners that coincide at a seam or a pole
// have the same vertex.
class Welding {
 public:
  Welding(const Sheet& sheet, const Surface& surface)
      : sheet_(sheet), rows_(sheet.grid.u.parameters.size()), columns_(sheet.grid.v.parameters.size()) {
    const Closing closing = find_closing(surface);
    u_closed_ = closing.u.apart_m <= closing_tolerance_m;
    v_closed_ = closing.v.apart_m <= closing_tolerance_m;
    first_row_ = is_pole(surface.u, closing.u.first_width_m);
    last_row_ = is_pole(surface.u, closing.u.last_width_m);
    first_column_ = is_pole(surface.v, closing.v.first_width_m);
    last_column_ = is_pole(surface.v, closing.v.last_width_m);
  }

  bool closed() const {
    return (u_closed_ || (first_row_ && last_row_)) && (v_closed_ || (first_column_ && last_column_));
  }

  // Returns the index of the grid point that replaces the corner (i, j) of the cells.
  std::size_t vertex(std::size_t i, std::size_t j) const {
    if (u_closed_ && i == rows_ - 1) i = 0;
    if (v_closed_ && j == columns_ - 1) j = 0;
    if ((first_row_ && i == 0) || (last_row_ && i == rows_ - 1)) j = 0;
    if ((first_column_ && j == 0) || (last_column_ && j == columns_ - 1)) i = 0;
    return i * columns_ + j;
  }

  // Returns the largest distance of a corner of the cells from the grid point that replaces it; 0 if this
  // distance is within the rounding of files.
  double largest_move_m() const {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t j = 0; j < columns_; ++j) {
        const std::size_t k = vertex(i, j);
        if (k == i * columns_ + j) continue;
        largest_m =
            std::max(largest_m, (sheet_.point(i, j) - sheet_.point(k / columns_, k % columns_)).norm());
      }
    }
    return largest_m > coincidence_m ? largest_m : 0.0;
  }

 private:
  static bool is_pole(const KnotVector& across, double width_m) {
    return !across.is_periodic() && width_m <= closing_tolerance_m;
  }

  const Sheet& sheet_;
  std::size_t rows_, columns_;
  bool u_closed_ = false, v_closed_ = false;
  bool first_row_ = false, last_row_ = false, first_column_ = false, last_column_ = false;
};

using GridTriangle = std::array<std::size_t, 3>;

void add_triangle(std::size_t p, std::size_t q, std::size_t r, std::vector<GridTriangle>& triangles) {
  if (p != q && q != r && r != p) triangles.push_back({p, q, r});
}

void add_cell(const Sheet& sheet, const Welding& welding, std::size_t i, std::size_t j,
              std::vector<GridTriangle>& triangles) {
  const std::size_t a = welding.vertex(i, j), b = welding.vertex(i + 1, j), c = welding.vertex(i + 1, j + 1),
                    d = welding.vertex(i, j + 1);
  const double rising = (sheet.point(i, j) - sheet.point(i + 1, j + 1)).squaredNorm();
  const double falling = (sheet.point(i + 1, j) - sheet.point(i, j + 1)).squaredNorm();
  if (rising <= falling) {
    add_triangle(a, b, c, triangles);
    add_triangle(a, c, d, triangles);
  } else {
    add_triangle(a, b, d, triangles);
    add_triangle(b, c, d, triangles);
  }
}

std::vector<GridTriangle> triangulate_cells(const Sheet& sheet, const Welding& welding) {
  std::vector<GridTriangle> triangles;
  for (std::size_t i = 0; i + 1 < sheet.grid.u.parameters.size(); ++i) {
    for (std::size_t j = 0; j + 1 < sheet.grid.v.parameters.size(); ++j) {
      add_cell(sheet, welding, i, j, triangles);
    }
  }
  return triangles;
}

// Returns the mesh of triangles between grid points. Indices beyond the points of the sheet refer to `more`.
TriangleMesh make_mesh(const Sheet& sheet, const std::vector<Vector3>& more,
                       const std::vector<GridTriangle>& triangles) {
  const std::size_t columns = sheet.grid.v.parameters.size(), samples = sheet.samples.x.size();
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> index(samples + more.size(), none);
  TriangleMesh mesh;
  for (const GridTriangle& corners_in_grid : triangles) {
    TriangleCorners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t point = corners_in_grid[k];
      if (index[point] == none) {
        index[point] = static_cast<std::uint32_t>(mesh.vertices_m.size());
        mesh.vertices_m.push_back(point < samples ? sheet.point(point / columns, point % columns)
                                                  : more[point - samples]);
      }
      corners[k] = index[point];
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

// Returns the triangles of the part of the surface that remains after trimming.
TriangleMesh make_trimmed_mesh(const Sheet& sheet, const Welding& welding, const TrimmedArea& area) {
  const std::size_t columns = sheet.grid.v.parameters.size(), samples = sheet.samples.x.size();
  const TrimmedGrid cut = trim_grid(sheet.grid.u, sheet.grid.v, area);
  std::vector<Vector3> more;
  for (const CutVertex& vertex : cut.vertices) {
    Vector3 point = Vector3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      point += vertex.weights[k] * sheet.point(vertex.corners[k] / columns, vertex.corners[k] % columns);
    }
    more.push_back(point);
  }
  const auto vertex_index = [&](std::size_t number) {
    return number < samples ? welding.vertex(number / columns, number % columns) : number;
  };
  std::vector<GridTriangle> triangles;
  for (const auto& corners : cut.triangles) {
    add_triangle(vertex_index(corners[0]), vertex_index(corners[1]), vertex_index(corners[2]), triangles);
  }
  return make_mesh(sheet, more, triangles);
}

// Returns an upper bound of the distance between trim loops and the polygons that replace them, in metres.
double trim_edge_error_m(const Surface& surface, const std::vector<TrimLoop>& trims) {
  double fraction = 0.0;
  for (const TrimLoop& loop : trims) {
    fraction = std::max(fraction, polygon_error_fraction(loop, surface.u, surface.v));
  }
  return fraction * stretch_bound_m(surface);
}

Result<Tessellation> make_tessellation(const Sheet& sheet, const Surface& surface,
                                       const std::vector<TrimLoop>& trims, double chord_error_m) {
  const Welding welding(sheet, surface);
  TriangleMesh whole = make_mesh(sheet, {}, triangulate_cells(sheet, welding));
  const bool is_inside_out = welding.closed() && enclosed_volume_m3(whole) < 0.0;
  Tessellation result{std::move(whole), welding.closed(), chord_error_m + welding.largest_move_m()};
  if (!trims.empty()) {
    const auto area = TrimmedArea::make(surface.u, surface.v, trims);
    if (!area) return area.error();
    result.mesh = make_trimmed_mesh(sheet, welding, area.value());
    remove_slivers(result.mesh);
    result.closed = false;
  }
  if (is_inside_out) {
    for (TriangleCorners& corners : result.mesh.triangles) std::swap(corners[1], corners[2]);
  }
  return result;
}

// When a mesh is thickened, triangles with at most this fraction of its area may turn over. Slivers may turn
// over because of rounding.
constexpr double turned_fraction = 1e-3;

Vector3 twice_area(const std::vector<Vector3>& points_m, const TriangleCorners& corners) {
  return (points_m[corners[1]] - points_m[corners[0]]).cross(points_m[corners[2]] - points_m[corners[0]]);
}

// Returns the normals of vertices, weighted by area because slivers along a trim have no reliable normal.
std::vector<Vector3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices_m.size(), Vector3::Zero());
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 area = twice_area(mesh.vertices_m, corners);
    for (const std::uint32_t corner : corners) normals[corner] += area;
  }
  for (Vector3& normal : normals) normal.stableNormalize();
  return normals;
}

// Returns the directed edges that belong to only one triangle.
std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary_edges(const TriangleMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> open;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      if (open.erase({to, from}) == 0) open.insert({from, to});
    }
  }
  return {open.begin(), open.end()};
}

}  // namespace

Result<Tessellation> tessellate(const Surface& surface, const std::vector<TrimLoop>& trims, double chord_m,
                                std::size_t triangle_limit, const Progress& progress) {
  SPOONBILL_ASSERT(chord_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const double edge_error_m = trim_edge_error_m(surface, trims);
  const double allowed_m = std::max(chord_m - edge_error_m, smallest_cell_fraction * chord_m);
  SurfaceBounds bounds(surface.u, surface.v);
  bounds.update(surface.net);
  Cells cells = initial_cells(surface, bounds, allowed_m);
  for (;;) {
    if (cells.triangles() > triangle_limit) {
      return Error{ErrorCode::too_many, "a chord error of " + number_text(1e3 * chord_m) +
                                            " mm needs more than " + std::to_string(triangle_limit) +
                                            " triangles; choose a larger --chord"};
    }
    const auto sheet = sample_sheet(surface, cells);
    if (!sheet) return sheet.error();
    const Eigen::MatrixXd errors = measure_errors(sheet.value(), bounds, cells, progress);
    if (!progress.report(0.0)) return Progress::stopped();
    if (const double largest = errors.maxCoeff(); largest <= allowed_m) {
      return make_tessellation(sheet.value(), surface, trims, largest + edge_error_m);
    }
    refine(errors, allowed_m, cells);
  }
}

double enclosed_volume_m3(const TriangleMesh& mesh) {
  if (mesh.vertices_m.empty()) return 0.0;
  const Vector3 origin = mesh.vertices_m.front();
  double sum = 0.0;
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[corners[0]] - origin, b = mesh.vertices_m[corners[1]] - origin,
                  c = mesh.vertices_m[corners[2]] - origin;
    sum += a.dot(b.cross(c));
  }
  return sum / 6.0;
}

Result<TriangleMesh> thicken_mesh(const TriangleMesh& outer, double thickness_m) {
  SPOONBILL_ASSERT(thickness_m > 0.0);
  const auto count = static_cast<std::uint32_t>(outer.vertices_m.size());
  TriangleMesh shell = outer;
  const std::vector<Vector3> normals = vertex_normals(outer);
  for (std::uint32_t v = 0; v < count; ++v) {
    shell.vertices_m.emplace_back(outer.vertices_m[v] - thickness_m * normals[v]);
  }
  double area = 0.0, turned_area = 0.0;
  Vector3 turned_m = Vector3::Zero();
  for (const TriangleCorners& corners : outer.triangles) {
    const TriangleCorners inner = {corners[0] + count, corners[2] + count, corners[1] + count};
    const Vector3 normal = twice_area(shell.vertices_m, corners);
    area += normal.norm();
    if (!(twice_area(shell.vertices_m, inner).dot(normal) < 0.0)) {
      if (turned_area == 0.0) turned_m = outer.vertices_m[corners[0]];
      turned_area += normal.norm();
    }
    shell.triangles.push_back(inner);
  }
  if (turned_area > turned_fraction * area) {
    return Error{ErrorCode::self_intersecting, "a shell of " + number_text(1e3 * thickness_m) +
                                                   " mm is thicker than the radius of curvature at " +
                                                   position_text(turned_m)};
  }
  for (const auto& [from, to] : boundary_edges(outer)) {
    shell.triangles.push_back({to, from, from + count});
    shell.triangles.push_back({to, from + count, to + count});
  }
  return shell;
}

}  // namespace spoonbill
