#include "engine/material/lattice/shell_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/result.h"
#include "engine/base/text.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/tube_rings.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

// Surface of a shell as a function of two fractions of its domain: one around or across the shell, the other
// along it. Immutable. The B-spline surface passed to make() must outlive it.
class ShellSurface {
 public:
  // Kind of shell, see shell_lattice.h.
  enum class Form { sheet, ring, bowl };

  // Fails if the surface has none of the forms in `Form`. The error message gives the reason.
  static Result<ShellSurface> make(const Surface& surface);

  Form form() const { return form_; }
  // Fractions from 0 to 1. `across` runs around a ring or bowl; `along` starts at the pole of a bowl.
  struct Position {
    double across = 0.0, along = 0.0;
  };
  Vector3 position_m(const Position& at) const;
  Vector3 normal(const Position& at) const;
  // Returns 1 if normal, across and along form a right-handed frame in this order, -1 otherwise.
  double handedness() const { return (swapped_ ? -1.0 : 1.0) * (pole_at_end_ ? -1.0 : 1.0); }

  // Returns fractions from 0 to 1, both included, that cut every polynomial piece into the same number of
  // parts. There are at least `least` parts in total.
  std::vector<double> across_fractions(int least) const;
  std::vector<double> along_fractions(int least) const;

 private:
  explicit ShellSurface(const Surface& surface) : surface_(&surface) {}
  struct Parameters {
    double u, v;
  };
  Parameters parameters(const Position& at) const;
  const KnotVector& across_knots() const { return swapped_ ? surface_->v : surface_->u; }
  const KnotVector& along_knots() const { return swapped_ ? surface_->u : surface_->v; }
  bool is_point(const std::vector<Position>& line) const;

  const Surface* surface_;
  Form form_ = Form::sheet;
  bool swapped_ = false, pole_at_end_ = false;
};

constexpr int edge_samples = 32;
// Edges shorter than this fraction of the control net's extent count as points.
constexpr double point_fraction = 1e-6;

std::vector<double> piece_fractions(const KnotVector& knots, int least) {
  const std::vector<double> breaks = knots.breakpoints();
  const int pieces = static_cast<int>(breaks.size()) - 1, parts = (least + pieces - 1) / pieces;
  const double start = breaks.front(), length = breaks.back() - start;
  std::vector<double> fractions;
  for (int piece = 0; piece < pieces; ++piece) {
    const auto at = static_cast<std::size_t>(piece);
    for (int part = 0; part < parts; ++part) {
      fractions.push_back((breaks[at] + (breaks[at + 1] - breaks[at]) * part / parts - start) / length);
    }
  }
  fractions.push_back(1.0);
  return fractions;
}

double extent(const ControlNet& net) {
  double extent = 0.0;
  for (const std::vector<double>* axis : {&net.x, &net.y, &net.z}) {
    const auto [low, high] = std::minmax_element(axis->begin(), axis->end());
    extent = std::max(extent, *high - *low);
  }
  return extent;
}

Result<ShellSurface> ShellSurface::make(const Surface& surface) {
  const bool around_u = surface.u.is_periodic(), around_v = surface.v.is_periodic();
  if (around_u && around_v) {
    return Error{
        ErrorCode::unsupported,
        "surface: is closed in u and v; a shell can be closed in one direction only, so open the other",
        "surface"};
  }
  ShellSurface face(surface);
  face.swapped_ = around_v;
  face.form_ = around_u || around_v ? Form::ring : Form::sheet;
  int points = 0;
  for (const double end : {0.0, 1.0}) {
    std::vector<Position> rim, side;
    for (int s = 0; s <= edge_samples; ++s) {
      const double fraction = static_cast<double>(s) / edge_samples;
      rim.push_back({fraction, end});
      side.push_back({end, fraction});
    }
    if (face.is_point(rim)) {
      ++points;
      face.pole_at_end_ = end == 1.0;
    }
    if (face.form_ == Form::sheet && face.is_point(side)) ++points;
  }
  if (points > 0 && face.form_ == Form::sheet) {
    return Error{
        ErrorCode::degenerate,
        "surface: an edge of a shell that is open in u and v shrinks to a point; give it some length, or "
        "close the surface around that point",
        "surface"};
  }
  if (points > 1) {
    return Error{
        ErrorCode::unsupported,
        "surface: a shell can have a pole at one end only; open the other, or leave shell_thickness_mm out "
        "for a solid body",
        "surface"};
  }
  if (points == 1 && face.swapped_) {
    return Error{ErrorCode::unsupported, "surface: a shell's pole must be at an end of v; swap u and v",
                 "surface"};
  }
  if (points == 1) face.form_ = Form::bowl;
  return face;
}

bool ShellSurface::is_point(const std::vector<Position>& line) const {
  const Vector3 first = position_m(line.front());
  double farthest = 0.0;
  for (const Position& at : line) farthest = std::max(farthest, (position_m(at) - first).norm());
  return farthest <= point_fraction * extent(surface_->net);
}

ShellSurface::Parameters ShellSurface::parameters(const Position& at) const {
  const auto to_parameter = [](const KnotVector& knots, double fraction) {
    if (fraction == 1.0 && !knots.is_periodic()) return knots.domain_end();
    return knots.parameter_at(fraction);
  };
  const double along = form_ == Form::bowl && pole_at_end_ ? 1.0 - at.along : at.along;
  const double first = to_parameter(across_knots(), at.across), second = to_parameter(along_knots(), along);
  return swapped_ ? Parameters{second, first} : Parameters{first, second};
}

Vector3 ShellSurface::position_m(const Position& at) const {
  const auto [u, v] = parameters(at);
  return position(*surface_, u, v);
}

Vector3 ShellSurface::normal(const Position& at) const {
  const auto [u, v] = parameters(at);
  return unit_normal(*surface_, u, v);
}

std::vector<double> ShellSurface::across_fractions(int least) const {
  SPOONBILL_ASSERT(least >= 1);
  return piece_fractions(across_knots(), least);
}

std::vector<double> ShellSurface::along_fractions(int least) const {
  SPOONBILL_ASSERT(least >= 1);
  std::vector<double> fractions = piece_fractions(along_knots(), least);
  if (form_ != Form::bowl || !pole_at_end_) return fractions;
  for (double& fraction : fractions) fraction = 1.0 - fraction;
  std::reverse(fractions.begin(), fractions.end());
  return fractions;
}

using Position = ShellSurface::Position;

// Smallest numbers of parts per direction into which the surface is cut. `length_stations` is for measuring
// arc lengths, and `volume_stations` for computing volumes. `lines` is for choosing the lines over which arc
// lengths are averaged.
constexpr int length_stations = 200, lines = 16, volume_stations = 48;
// A point of a bowl's rim counts as the farthest from the rim's centre if its distance is at least this
// fraction of the largest distance. The start of the grid thus does not depend on rounding.
constexpr double farthest_tolerance = 1.0 - 1e-6;

// Returns a table from arc length to the fractions `stations`. The arc length is averaged over the lines at
// the fractions `over`.
template <class PositionAt>
LinearTable length_to_fraction(const ShellSurface& face, const std::vector<double>& stations,
                               const std::vector<double>& over, const PositionAt& position_at) {
  LinearTable table{{0.0}, {stations.front()}};
  for (std::size_t s = 1; s < stations.size(); ++s) {
    double sum = 0.0;
    for (const double line : over) {
      sum += (face.position_m(position_at(stations[s], line)) -
              face.position_m(position_at(stations[s - 1], line)))
                 .norm();
    }
    table.from.push_back(table.from.back() + sum / static_cast<double>(over.size()));
    table.to.push_back(stations[s]);
  }
  return table;
}

LinearTable across_table(const ShellSurface& face, const std::vector<double>& over) {
  return length_to_fraction(face, face.across_fractions(length_stations), over,
                            [](double across, double line) {
                              return Position{across, line};
                            });
}

LinearTable along_table(const ShellSurface& face, const std::vector<double>& over) {
  return length_to_fraction(face, face.along_fractions(length_stations), over, [](double along, double line) {
    return Position{line, along};
  });
}

// Returns the angle of the direction (x, y) in turns, with an error of at most 0.0006 turns. A rational
// function replaces the library's arc tangent, whose bits differ between processors.
double angle_in_turns(double x, double y) {
  const auto eighths = [](double slope) { return slope * (1.0 + 0.3476 * (1.0 - slope)); };
  const double a = std::abs(x), b = std::abs(y);
  if (!(a + b > 0.0)) return 0.0;
  const double quarter = b <= a ? 0.125 * eighths(b / a) : 0.25 - 0.125 * eighths(a / b);
  const double half = x < 0.0 ? 0.5 - quarter : quarter;
  return y < 0.0 ? 1.0 - half : half;
}

// Distribution of the nodes of one layer over a shell's surface by arc length, and the size of this surface.
class Spread {
 public:
  explicit Spread(const ShellSurface& face) : face_(&face) {
    if (face.form() == ShellSurface::Form::bowl) {
      lay_bowl();
    } else {
      across_ = across_table(face, face.along_fractions(lines));
      along_ = along_table(face, face.across_fractions(lines));
      size_ = {across_.from.back(), along_.from.back()};
    }
  }

  // Extents along i and k, m.
  const std::array<double, 2>& size_m() const { return size_; }

  // Returns the surface location of a node; `s` and `t` run from 0 to 1 over i and k.
  Position at(double s, double t) const {
    if (face_->form() == ShellSurface::Form::bowl) return in_bowl(2.0 * s - 1.0, 2.0 * t - 1.0);
    const double across = face_->handedness() > 0.0 ? s : 1.0 - s;
    return {across_.at(across * across_.from.back()), along_.at(t * along_.from.back())};
  }

 private:
  // Starts the grid at the point of the rim that is farthest from the rim's centre, so that the grid is
  // aligned with a long bowl.
  void lay_bowl() {
    across_ = across_table(*face_, {1.0});
    along_ = along_table(*face_, face_->across_fractions(lines));
    Vector3 centre = Vector3::Zero();
    for (const double fraction : across_.to) {
      centre += face_->position_m({fraction, 1.0}) / static_cast<double>(across_.to.size());
    }
    const auto distance = [&](std::size_t s) {
      return (face_->position_m({across_.to[s], 1.0}) - centre).norm();
    };
    double farthest = 0.0;
    for (std::size_t s = 0; s < across_.to.size(); ++s) farthest = std::max(farthest, distance(s));
    std::size_t first = 0;
    while (distance(first) < farthest_tolerance * farthest) ++first;
    start_m_ = across_.from[first];
    const auto over = [&](double turn) {
      const double one = along_table(*face_, {across_at(turn)}).from.back();
      return one + along_table(*face_, {across_at(turn + 0.5)}).from.back();
    };
    size_ = {over(0.0), over(0.25)};
  }

  double across_at(double turn) const {
    const double around = start_m_ / across_.from.back() - face_->handedness() * turn;
    return across_.at((around - std::floor(around)) * across_.from.back());
  }

  // Maps a square to a disc with smooth grid lines (Nowell, "Mapping a square to a circle", 2005).
  Position in_bowl(double s, double t) const {
    const double x = s * std::sqrt(1.0 - 0.5 * t * t), y = t * std::sqrt(1.0 - 0.5 * s * s);
    return {across_at(angle_in_turns(x, y)), along_.at(std::sqrt(x * x + y * y) * along_.from.back())};
  }

  const ShellSurface* face_;
  LinearTable across_, along_;
  std::array<double, 2> size_{};
  double start_m_ = 0.0;
};

// Points of the surface from which the nodes are offset, with the surface's normals and the positions around
// the shell. All are indexed by i and k.
struct FaceNodes {
  int rows, columns;
  std::vector<Vector3> points, normals;
  std::vector<double> turns;

  std::size_t index(int i, int k) const { return static_cast<std::size_t>(i * columns + k); }
};

FaceNodes face_nodes(const ShellSurface& face, const Spread& spread, int rows, int columns) {
  FaceNodes nodes{rows, columns, {}, {}, {}};
  const bool closed = face.form() == ShellSurface::Form::ring;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      // The last row of a closed face repeats the first, so that joined nodes are equal to the last bit.
      const int from = closed && i == rows - 1 ? 0 : i;
      const Position position =
          spread.at(static_cast<double>(from) / (rows - 1), static_cast<double>(k) / (columns - 1));
      nodes.points.push_back(face.position_m(position));
      nodes.normals.push_back(face.normal(position));
      const bool turns = face.form() != ShellSurface::Form::sheet;
      nodes.turns.push_back(turns ? position.across - std::floor(position.across) : 0.0);
    }
  }
  return nodes;
}

// Returns the smallest thickness at which an edge of the offset face would vanish, m.
double thickness_limit_m(const FaceNodes& nodes) {
  double limit = std::numeric_limits<double>::infinity();
  const auto limit_by_edge = [&](std::size_t a, std::size_t b) {
    const Vector3 edge = nodes.points[b] - nodes.points[a], turn = nodes.normals[b] - nodes.normals[a];
    if (edge.dot(turn) > 0.0) limit = std::min(limit, edge.squaredNorm() / edge.dot(turn));
  };
  for (int i = 0; i < nodes.rows; ++i) {
    for (int k = 0; k < nodes.columns; ++k) {
      if (i + 1 < nodes.rows) limit_by_edge(nodes.index(i, k), nodes.index(i + 1, k));
      if (k + 1 < nodes.columns) limit_by_edge(nodes.index(i, k), nodes.index(i, k + 1));
    }
  }
  return limit;
}

Status check_normals(const FaceNodes& nodes) {
  for (const Vector3& normal : nodes.normals) {
    if (!(normal.squaredNorm() > 0.5)) {
      return Error{ErrorCode::degenerate,
                   "surface: has no normal at some point, so the shell has no thickness; spread its control "
                   "points there",
                   "surface"};
    }
  }
  return {};
}

double volume_between(const ShellSurface& face, double thickness_m, const std::vector<double>& across,
                      const std::vector<double>& along) {
  struct Pair {
    Vector3 near, far;
  };
  const auto make_row = [&](double fraction) {
    std::vector<Pair> row;
    for (const double other : along) {
      const Vector3 point = face.position_m({fraction, other});
      row.push_back({point, point - thickness_m * face.normal({fraction, other})});
    }
    return row;
  };
  double volume = 0.0;
  std::vector<Pair> before = make_row(across.front());
  for (std::size_t a = 1; a < across.size(); ++a) {
    std::vector<Pair> row = make_row(across[a]);
    for (std::size_t b = 1; b < row.size(); ++b) {
      volume += cell_volume({before[b - 1].near, before[b].near, before[b - 1].far, before[b].far,
                             row[b - 1].near, row[b].near, row[b - 1].far, row[b].far});
    }
    before = std::move(row);
  }
  return std::abs(volume);
}

std::vector<double> halve_fractions(const std::vector<double>& fractions) {
  std::vector<double> finer;
  for (std::size_t s = 0; s + 1 < fractions.size(); ++s) {
    finer.push_back(fractions[s]);
    finer.push_back(0.5 * (fractions[s] + fractions[s + 1]));
  }
  finer.push_back(fractions.back());
  return finer;
}

// Returns the volume of the shell, m^3. The error of chords falls with the square of their length, so the
// results for two lengths are extrapolated (Richardson 1911).
double shell_volume_m3(const ShellSurface& face, double thickness_m) {
  const std::vector<double> across = face.across_fractions(volume_stations),
                            along = face.along_fractions(volume_stations);
  const double coarse = volume_between(face, thickness_m, across, along);
  const double fine = volume_between(face, thickness_m, halve_fractions(across), halve_fractions(along));
  return (4.0 * fine - coarse) / 3.0;
}

LatticeMesh make_mesh(const FaceNodes& nodes, double thickness_m, const std::array<int, 3>& counts,
                      bool closed) {
  LatticeMesh mesh;
  mesh.count = counts;
  mesh.closed = closed;
  mesh.thin = true;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto [i, j, k] = mesh.grid_index(n);
    const std::size_t at = nodes.index(i, k);
    mesh.nodes.emplace_back(nodes.points[at] - thickness_m * j / (counts[1] - 1) * nodes.normals[at]);
    mesh.turns.push_back(nodes.turns[at]);
  }
  return mesh;
}

// Gives all cells the same fraction, so that the lattice has the given volume.
void set_cell_fractions(double volume_m3, LatticeMesh& mesh) {
  double cell_volume_sum = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) cell_volume_sum += cell_volume(mesh.cell(i, j, k));
    }
  }
  mesh.cell_fractions.assign(mesh.cell_count(), volume_m3 / cell_volume_sum);
}

}  // namespace

Result<LatticeMesh> shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request) {
  const Range<double> range_mm{1e3 * shell_thickness_range_m.low, 1e3 * shell_thickness_range_m.high};
  if (const Status status = check_range("shell_thickness_mm", 1e3 * thickness_m, range_mm); !status.ok()) {
    return status.error();
  }
  if (request.feature_map) {
    return Error{ErrorCode::inconsistent,
                 "lattice: feature_map: a shell has no inside to spread nodes in; remove feature_map",
                 "feature_map"};
  }
  if (request.cells == LatticeCells::box) {
    return Error{ErrorCode::inconsistent,
                 "lattice: cells: a shell has layers of cells of its own; remove cells", "cells"};
  }
  const Result<ShellSurface> face = ShellSurface::make(surface);
  if (!face.ok()) return face.error();
  const Spread spread(face.value());
  const bool closed = face->form() == ShellSurface::Form::ring;
  if (!(spread.size_m()[0] > 0.0 && spread.size_m()[1] > 0.0)) {
    return Error{ErrorCode::degenerate, "surface: has no length in one direction; spread its control points",
                 "surface"};
  }
  const Result<std::array<int, 3>> counts =
      shell_counts(request, {spread.size_m()[0], thickness_m, spread.size_m()[1]}, closed);
  if (!counts.ok()) return counts.error();
  const FaceNodes nodes = face_nodes(face.value(), spread, counts.value()[0], counts.value()[2]);
  if (const Status status = check_normals(nodes); !status.ok()) return status.error();
  const double limit_m = thickness_limit_m(nodes);
  if (!(thickness_m < limit_m)) {
    return Error{ErrorCode::self_intersecting,
                 "shell_thickness_mm: a shell of " + number_text(1e3 * thickness_m) +
                     " mm folds over where the surface is curved; use less than " +
                     number_text(std::floor(1e5 * limit_m) / 100.0) + " mm",
                 "shell_thickness_mm"};
  }
  LatticeMesh mesh = make_mesh(nodes, thickness_m, counts.value(), closed);
  if (const Status status = check_cells(mesh); !status.ok()) {
    return Error{status.error().code, status.error().message + ", or a smaller shell_thickness_mm",
                 status.error().field};
  }
  set_cell_fractions(shell_volume_m3(face.value(), thickness_m), mesh);
  return mesh;
}

}  // namespace spoonbill
