#include "engine/fitting/parameterisation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/base/dense_matrices.h"
#include "engine/base/geometry.h"
#include "engine/fitting/harmonic_map.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

constexpr double sheet_fraction = 0.12;
// A surface with outward normals counts as a sheet if the area within its longest boundary loop exceeds this
// fraction of the area of the surface. The limit is larger than sheet_fraction, because the underside of a
// closed body may not have been scanned.
constexpr double outward_sheet_fraction = 0.3;
constexpr double tube_fraction = 0.75;
constexpr double roundness = 0.12;

Vector3 vector_area(const PointGraph& graph, const BoundaryLoop& loop) {
  Vector3 area = Vector3::Zero();
  for (std::size_t k = 0; k < loop.nodes.size(); ++k) {
    const Vector3 a = graph.points_m[loop.nodes[k]] - loop.centre_m;
    area += 0.5 * a.cross(graph.points_m[loop.nodes[(k + 1) % loop.nodes.size()]] - loop.centre_m);
  }
  return area;
}

// Returns the area of each node, estimated from its edge lengths as in a hexagonal lattice.
std::vector<double> node_areas(const PointGraph& graph) {
  std::vector<double> areas(graph.size(), 0.0);
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    const auto near = graph.adjacent(n);
    for (const std::uint32_t other : near) {
      areas[n] +=
          0.6 * (graph.points_m[n] - graph.points_m[other]).squaredNorm() / static_cast<double>(near.size());
    }
  }
  return areas;
}

double total_area(const PointGraph& graph) {
  const std::vector<double> areas = node_areas(graph);
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

// Centroid and principal axes of the surface; the longest axis is the last.
struct Axes {
  Vector3 centre = Vector3::Zero();
  Vector3 squares = Vector3::Zero();  // mean squared extents along the axes, ascending
  Eigen::Matrix3d axes;
};

Axes principal_axes(const PointGraph& graph) {
  Axes result;
  const std::vector<double> areas = node_areas(graph);
  const double area = std::accumulate(areas.begin(), areas.end(), 1e-300);
  for (std::size_t n = 0; n < areas.size(); ++n) result.centre += areas[n] / area * graph.points_m[n];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < areas.size(); ++n) {
    const Vector3 offset = graph.points_m[n] - result.centre;
    spread += areas[n] / area * offset * offset.transpose();
  }
  const SymmetricEigen eigen = decompose_symmetric(spread);
  result.squares = eigen.values;
  result.axes = eigen.vectors;
  return result;
}

void span_holes(FitPoints& island, std::size_t first_loop) {
  for (std::size_t k = first_loop; k < island.boundary_loops.size(); ++k) {
    const Cap cap =
        cap_hole(island.graph, island.boundary_loops[k], static_cast<std::uint32_t>(island.graph.size()));
    add_spanning_nodes(island, cap.points_m, cap.normals, cap.pairs);
  }
}

// Returns the nodes near the axis that are no farther from it than any of their neighbours. They are at least
// 0.4 of the largest radius apart.
std::vector<std::uint32_t> find_axis_nodes(const PointGraph& graph, const Vector3& centre,
                                           const Vector3& axis) {
  std::vector<double> radius(graph.size());
  double widest = 0.0;
  for (std::size_t n = 0; n < graph.size(); ++n) {
    radius[n] = (graph.points_m[n] - centre).cross(axis).norm();
    widest = std::max(widest, radius[n]);
  }
  std::vector<std::uint32_t> order;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    const auto near = graph.adjacent(n);
    const bool lowest = std::all_of(near.begin(), near.end(), [&](auto m) { return radius[m] >= radius[n]; });
    if (lowest && radius[n] < 0.15 * widest) order.push_back(n);
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return radius[a] < radius[b]; });
  std::vector<std::uint32_t> chosen;
  std::vector<bool> covered(graph.size(), false);
  for (const std::uint32_t n : order) {
    if (covered[n]) continue;
    const ShortestPaths paths = shortest_paths(graph, std::array<std::uint32_t, 1>{n});
    for (std::size_t m = 0; m < graph.size(); ++m) covered[m] = covered[m] || paths.length[m] < 0.4 * widest;
    chosen.push_back(n);
  }
  return chosen;
}

// Returns the two nodes where an axis leaves the shape, or nothing if there are not exactly two.
std::optional<ShapeEnds> find_poles(const PointGraph& graph, const Vector3& centre, const Vector3& axis) {
  const std::vector<std::uint32_t> on_axis = find_axis_nodes(graph, centre, axis);
  if (on_axis.size() != 2) return {};
  const auto height = [&](std::uint32_t n) { return (graph.points_m[n] - centre).dot(axis); };
  return height(on_axis[0]) < height(on_axis[1]) ? ShapeEnds{{on_axis[0]}, {on_axis[1]}}
                                                 : ShapeEnds{{on_axis[1]}, {on_axis[0]}};
}

// Returns the two nodes where an axis leaves the shape, or nothing if there are not exactly two. The axis is
// the short one for a round, flat shape (bowl, plate), and the long one for any other shape.
std::optional<ShapeEnds> find_axis_poles(const PointGraph& graph) {
  const Axes axes = principal_axes(graph);
  const bool is_disc = axes.squares[2] - axes.squares[1] < roundness * axes.squares[2] &&
                       axes.squares[1] - axes.squares[0] > roundness * axes.squares[2];
  return find_poles(graph, axes.centre, axes.axes.col(is_disc ? 0 : 2));
}

// Returns true if the normals point away from the centroid, as they do on a closed shape that was scanned
// only from outside.
bool faces_outwards(const FitPoints& island) {
  const Axes axes = principal_axes(island.graph);
  const std::vector<double> areas = node_areas(island.graph);
  double volume = 0.0;
  for (std::size_t n = 0; n < areas.size(); ++n) {
    volume += areas[n] * (island.graph.points_m[n] - axes.centre).dot(island.node_normals[n]);
  }
  return volume >= 0.0;  // the sum is zero without normals
}

void flip_normals(FitPoints& island) {
  for (Vector3& normal : island.scan.normals) normal = -normal;
  for (Vector3& normal : island.node_normals) normal = -normal;
}

Result<Parameterisation> start_closed(FitPoints& island) {
  if (!faces_outwards(island)) flip_normals(island);
  span_holes(island, 0);
  const ShapeEnds ends = find_axis_poles(island.graph).value_or(farthest_ends(island.graph));
  auto uv = harmonic_tube_map(island.graph, ends);
  if (!uv) return uv.error();
  uv.value()[ends.start.front()] = {0.0, 0.0};
  uv.value()[ends.end.front()] = {0.0, 1.0};
  return Parameterisation{ShapeKind::closed, std::move(uv).value()};
}

Result<Parameterisation> start_tube(FitPoints& island) {
  if (island.boundary_loops.size() < 2) {
    return Error(ErrorCode::mismatch,
                 "a tube needs two open ends, " + std::to_string(island.boundary_loops.size()) +
                     " were found; try --kind closed",
                 "kind");
  }
  const ShapeEnds ends{island.boundary_loops[0].nodes, island.boundary_loops[1].nodes};
  span_holes(island, 2);
  auto uv = harmonic_tube_map(island.graph, ends);
  if (!uv) return uv.error();
  return Parameterisation{ShapeKind::tube, std::move(uv).value()};
}

// Returns the indices, within the boundary loop, of the nodes that become the corners of the parameter
// domain. They are the nodes farthest from the centre along the diagonals of the principal plane.
std::array<std::size_t, 4> find_corners(const PointGraph& graph, const BoundaryLoop& loop) {
  const Axes axes = principal_axes(graph);
  std::array<std::size_t, 4> corners{};
  static constexpr std::array<std::array<double, 2>, 4> diagonals{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  const double wide = std::sqrt(axes.squares[2]), narrow = std::sqrt(axes.squares[1]);
  for (std::size_t c = 0; c < 4; ++c) {
    double most = -1e300;
    for (std::size_t k = 0; k < loop.nodes.size(); ++k) {
      const Vector3 offset = graph.points_m[loop.nodes[k]] - axes.centre;
      const double out = diagonals[c][0] * offset.dot(axes.axes.col(2)) / wide +
                         diagonals[c][1] * offset.dot(axes.axes.col(1)) / narrow;
      if (out <= most) continue;
      most = out;
      corners[c] = k;
    }
  }
  return corners;
}

// Parameterises a sheet by projection onto its principal plane. This works well if the sheet is a height
// field over that plane.
Parameterisation start_sheet_on_plane(const FitPoints& island) {
  const Axes axes = principal_axes(island.graph);
  Parameterisation start;
  Box2 box;
  for (const Vector3& point : island.graph.points_m) {
    const Vector2 parameter((point - axes.centre).dot(axes.axes.col(2)),
                            (point - axes.centre).dot(axes.axes.col(1)));
    start.uv.push_back(parameter);
    box.include(parameter);
  }
  for (Vector2& parameter : start.uv)
    parameter = (parameter - box.low).cwiseQuotient(box.extent().cwiseMax(1e-12));
  return start;
}

Result<Parameterisation> start_sheet(FitPoints& island) {
  if (island.boundary_loops.empty()) return start_sheet_on_plane(island);
  span_holes(island, 1);
  std::array<std::size_t, 4> corners = find_corners(island.graph, island.boundary_loops[0]);
  // Sorts the corners into the order of the loop.
  BoundaryLoop loop = island.boundary_loops[0];
  const std::size_t count = loop.nodes.size();
  const auto ahead = [&](std::size_t c) { return (corners[c] + count - corners[0]) % count; };
  if (ahead(1) > ahead(3)) {
    std::reverse(loop.nodes.begin(), loop.nodes.end());
    for (std::size_t& corner : corners) corner = count - 1 - corner;
  }
  if (!(0 < ahead(1) && ahead(1) < ahead(2) && ahead(2) < ahead(3))) return start_sheet_on_plane(island);
  auto uv = harmonic_square_map(island.graph, loop.nodes, corners);
  if (!uv) return uv.error();
  return Parameterisation{ShapeKind::sheet, std::move(uv).value()};
}

}  // namespace

ShapeKind classify_shape(const FitPoints& island) {
  if (island.boundary_loops.empty()) return ShapeKind::closed;
  const double area = total_area(island.graph);
  if (island.boundary_loops.size() > 1) {
    const ShortestPaths paths = shortest_paths(island.graph, island.boundary_loops[0].nodes);
    double between = 0.0;
    for (const std::uint32_t node : island.boundary_loops[1].nodes)
      between = std::max(between, paths.length[node]);
    const double around = area / std::max(between, 1e-12);
    if (std::isfinite(between) && island.boundary_loops[1].length_m > tube_fraction * around &&
        island.boundary_loops[0].length_m < around / tube_fraction &&
        island.boundary_loops[0].length_m > tube_fraction * around) {
      return ShapeKind::tube;
    }
  }
  const double fraction = vector_area(island.graph, island.boundary_loops[0]).norm() / area;
  return fraction > (faces_outwards(island) ? outward_sheet_fraction : sheet_fraction) ? ShapeKind::sheet
                                                                                       : ShapeKind::closed;
}

void span_all_holes(FitPoints& island) {
  span_holes(island, 0);
  island.boundary_loops.clear();
}

Result<Parameterisation> initial_parameterisation(FitPoints& island, ShapeKind kind) {
  switch (kind) {
    case ShapeKind::closed:
      return start_closed(island);
    case ShapeKind::tube:
      return start_tube(island);
    default:
      return start_sheet(island);
  }
}

namespace {

constexpr double axis_roundness = 0.1;
// Limits of a thin wall: its largest thickness as a fraction of the shape's size, and the smallest thickness,
// in raster cells, at which its two faces can be separated.
constexpr double thin_fraction = 0.1;
constexpr double separable_cells = 3.0;
// The cell size is chosen so that filled raster cells have about this many points each, if the profile is
// three times as long as the shape is large.
constexpr double points_per_cell = 12.0;
constexpr double face_fraction = 0.2;  // largest depth of points on a face, relative to the wall's thickness
// Depth below the outline, as a fraction of the wall's thickness. If half of the points are deeper, all
// points may belong to a single noisy face.
constexpr double between_fraction = 0.25;
constexpr double covered_fraction = 0.85;
constexpr int least_cell_points = 2;  // smallest number of points in a filled cell
constexpr int dilation = 2;           // number of cells by which filled cells are dilated
// A column of cells is near the axis if its distance from the axis is below this fraction of the raster's
// width.
constexpr double near_axis_fraction = 0.05;

struct Axis {
  Vector3 centre = Vector3::Zero(), along = Vector3::UnitZ(), first = Vector3::UnitX();
  Vector3 second() const { return along.cross(first); }
};

std::optional<Axis> find_round_axis(const std::vector<Vector3>& points_m) {
  Axis axis;
  const auto count = static_cast<double>(points_m.size());
  for (const Vector3& point : points_m) axis.centre += point / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3& point : points_m) {
    spread += (point - axis.centre) * (point - axis.centre).transpose() / count;
  }
  const SymmetricEigen eigen = decompose_symmetric(spread);
  const Vector3& squares = eigen.values;
  const bool flat = squares[2] - squares[1] < axis_roundness * squares[2];
  const bool slender = squares[1] - squares[0] < axis_roundness * squares[1];
  if (flat == slender) return {};
  axis.along = eigen.vectors.col(flat ? 0 : 2);
  axis.first = eigen.vectors.col(1);
  return axis;
}

// Distance from the axis and height along the axis, for each point.
struct AxisProfile {
  std::vector<Vector2> positions;
  Box2 box;  // box of the positions, extended to the axis
};

AxisProfile compute_profile(const std::vector<Vector3>& points_m, const Axis& axis) {
  AxisProfile profile;
  profile.box.low.x() = profile.box.high.x() = 0.0;
  for (const Vector3& point : points_m) {
    const Vector3 path = point - axis.centre;
    const double height = path.dot(axis.along);
    const Vector2 position((path - height * axis.along).norm(), height);
    profile.positions.push_back(position);
    profile.box.include(position);
  }
  return profile;
}

// Raster of the half plane beside the axis. The axis is the left side of column 0; the other sides have a
// margin.
class ProfileRaster {
 public:
  ProfileRaster(const AxisProfile& profile, double cell_m) : cell_m_(cell_m), low_(profile.box.low) {
    constexpr int margin = dilation + 2;
    low_.y() -= margin * cell_m;
    columns_ = static_cast<int>((profile.box.high.x() - profile.box.low.x()) / cell_m) + 1 + margin;
    rows_ = static_cast<int>((profile.box.high.y() - low_.y()) / cell_m) + 1 + margin;
    std::vector<int> counts(static_cast<std::size_t>(columns_) * rows_, 0);
    for (const Vector2& position : profile.positions) ++counts[index(to_column(position), to_row(position))];
    filled_.assign(counts.size(), false);
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        // Rings near the axis are short and have few points. A single point there therefore counts, and fills
        // all cells between it and the axis.
        const bool near_axis = column < near_axis_fraction * columns_;
        if (counts[index(column, row)] < (near_axis ? 1 : least_cell_points)) continue;
        for (int c = near_axis ? 0 : column; c <= column; ++c) fill_around(c, row);
      }
    }
    flood_outside();
  }

  // outline() returns the cell edges between filled and outside cells, from the axis back to the axis, or
  // nothing if the path does not return to the axis. area() returns the enclosed area in square metres.
  std::vector<Vector2> outline() const;
  double area() const {
    return cell_m_ * cell_m_ * static_cast<double>(std::count(outside_.begin(), outside_.end(), false));
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  int to_column(const Vector2& position) const { return static_cast<int>(position.x() / cell_m_); }
  int to_row(const Vector2& position) const { return static_cast<int>((position.y() - low_.y()) / cell_m_); }
  bool inside(int column, int row) const {
    return column >= 0 && column < columns_ && row >= 0 && row < rows_ && !outside_[index(column, row)];
  }

  void fill_around(int column, int row) {
    for (int dc = -dilation; dc <= dilation; ++dc) {
      for (int dr = -dilation; dr <= dilation; ++dr) {
        if (dc * dc + dr * dr > dilation * dilation + 1) continue;
        const int c = std::clamp(column + dc, 0, columns_ - 1), r = std::clamp(row + dr, 0, rows_ - 1);
        filled_[index(c, r)] = true;
      }
    }
  }

  void flood_outside() {
    outside_.assign(filled_.size(), false);
    std::vector<std::array<int, 2>> waiting{{columns_ - 1, rows_ - 1}};
    outside_[index(columns_ - 1, rows_ - 1)] = true;
    while (!waiting.empty()) {
      const auto [column, row] = waiting.back();
      waiting.pop_back();
      static constexpr std::array<std::array<int, 2>, 4> steps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
      for (const auto& [dc, dr] : steps) {
        const int c = column + dc, r = row + dr;
        if (c < 0 || c >= columns_ || r < 0 || r >= rows_ || filled_[index(c, r)] || outside_[index(c, r)]) {
          continue;
        }
        outside_[index(c, r)] = true;
        waiting.push_back({c, r});
      }
    }
  }

  double cell_m_;
  Vector2 low_;
  int columns_ = 0, rows_ = 0;
  std::vector<bool> filled_, outside_;
};

std::vector<Vector2> ProfileRaster::outline() const {
  // `row` and `column` are those of the cell to the upper right of the present corner. The path keeps filled
  // cells on its right and starts at the top filled cell on the axis.
  int row = rows_;
  while (row > 0 && !inside(0, row - 1)) --row;
  if (row == 0) return {};
  int column = 0, dc = 1, dr = 0;
  std::vector<Vector2> path;
  const auto put = [&] { path.emplace_back(cell_m_ * column, low_.y() + cell_m_ * row); };
  put();
  for (std::size_t step = 0; step < 4 * filled_.size(); ++step) {
    column += dc;
    row += dr;
    put();
    if (column == 0) return path;
    // Tests one of the two cells ahead of the corner: the cell to the left or to the right of the path.
    const auto ahead = [&](bool left) {
      const int side = left ? 1 : -1;
      // Direction (x, y) of the tested cell from the corner; each component is 1 or -1.
      const int x = dc + side * -dr, y = dr + side * dc;
      return inside(x > 0 ? column : column - 1, y > 0 ? row : row - 1);
    };
    const int old_dc = dc, old_dr = dr;
    if (ahead(true)) {
      dc = -old_dr, dr = old_dc;  // turns left
    } else if (!ahead(false)) {
      dc = old_dr, dr = -old_dc;  // turns right
    }
  }
  return {};
}

// Smooths the path, which follows the steps of the raster.
std::vector<Vector2> smooth_path(const std::vector<Vector2>& path) {
  std::vector<Vector2> smoothed = path;
  constexpr int reach = 3;
  const int last = static_cast<int>(path.size()) - 1;
  for (int k = 1; k < last; ++k) {
    const int near = std::min({reach, k, last - k});
    Vector2 sum = Vector2::Zero();
    for (int m = k - near; m <= k + near; ++m) sum += path[static_cast<std::size_t>(m)];
    smoothed[static_cast<std::size_t>(k)] = sum / (2 * near + 1);
  }
  return smoothed;
}

// Returns, for each corner, the fraction of the path's length at which it is.
std::vector<double> path_fractions(const std::vector<Vector2>& path) {
  std::vector<double> fractions(path.size(), 0.0);
  for (std::size_t k = 1; k < path.size(); ++k)
    fractions[k] = fractions[k - 1] + (path[k] - path[k - 1]).norm();
  const double length = fractions.back();
  for (double& fraction : fractions) fraction /= length;
  return fractions;
}

double path_length(const std::vector<Vector2>& path) {
  double length = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) length += (path[k] - path[k - 1]).norm();
  return length;
}

// Divides the domain of (u, v) into cells and returns the fraction of cells that have a point no deeper than
// `reach` below the outline. The fraction is small for wavy sheets, which fill the profile only because
// points from all sides of the axis are projected onto it.
double face_coverage(const std::vector<Vector2>& uv, const std::vector<double>& depths, double reach) {
  constexpr int sectors = 8, lengths = 16;
  std::array<bool, sectors * lengths> seen{};
  for (std::size_t p = 0; p < uv.size(); ++p) {
    if (depths[p] > reach) continue;
    const int sector = std::min(sectors - 1, static_cast<int>(uv[p].x() * sectors));
    const int length = std::min(lengths - 1, static_cast<int>(uv[p].y() * lengths));
    seen[static_cast<std::size_t>(sector * lengths + length)] = true;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
}

}  // namespace

std::optional<ProfileMap> map_profile(const std::vector<Vector3>& points_m) {
  const auto axis = find_round_axis(points_m);
  if (!axis) return {};
  const AxisProfile profile = compute_profile(points_m, *axis);
  const double size = (profile.box.high - profile.box.low).norm();
  const double cell = size * std::clamp(3.0 * points_per_cell / static_cast<double>(points_m.size()),
                                        1.0 / 250.0, 1.0 / 80.0);
  const ProfileRaster raster(profile, cell);
  const std::vector<Vector2> path = smooth_path(raster.outline());
  if (path.size() < 20) return {};
  const double thickness = 2.0 * raster.area() / path_length(path) - 2.0 * dilation * cell;
  if (thickness > thin_fraction * size || thickness < separable_cells * cell) return {};
  std::vector<Vector3> corners;
  corners.reserve(path.size());
  for (const Vector2& position : path) corners.emplace_back(position.x(), position.y(), 0.0);
  const NearestPoints nearest(corners);
  const std::vector<double> fractions = path_fractions(path);
  Parameterisation start;
  start.kind = ShapeKind::closed;
  std::vector<double> depths;
  for (std::size_t p = 0; p < points_m.size(); ++p) {
    const Vector3 out = points_m[p] - axis->centre;
    const double turn = std::atan2(out.dot(axis->second()), out.dot(axis->first)) / (2.0 * std::numbers::pi);
    const auto found = nearest.nearest({profile.positions[p].x(), profile.positions[p].y(), 0.0});
    start.uv.emplace_back(turn - std::floor(turn), fractions[found.index]);
    depths.push_back(found.distance - dilation * cell);
  }
  if (face_coverage(start.uv, depths, face_fraction * thickness + 1.5 * cell) < covered_fraction) return {};
  return ProfileMap{std::move(start), median(depths) > between_fraction * thickness};
}

}  // namespace spoonbill
