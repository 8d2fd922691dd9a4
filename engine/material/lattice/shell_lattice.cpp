#include "engine/material/lattice/shell_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/bspline/tube_rings.h"
#include "engine/material/lattice/lattice_counts.h"
#include "engine/material/lattice/shell_surface.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

using Place = ShellSurface::Place;

// How finely lengths and volumes are measured: chords of so many parts of a direction.
constexpr int length_stations = 200, lines = 16, volume_stations = 48;
// What is this far from the farthest is as far: the start of a ring must not hang on rounding.
constexpr double as_far = 1.0 - 1e-6;

// Arc length from the first station on, the mean over the lines, against the stations' shares.
template <class PlaceOf>
LinearTable length_to_share(const ShellSurface& face, const std::vector<double>& stations,
                           const std::vector<double>& over, const PlaceOf& place_of) {
  LinearTable table{{0.0}, {stations.front()}};
  for (std::size_t s = 1; s < stations.size(); ++s) {
    double sum = 0.0;
    for (const double line : over) {
      sum += (face.position_m(place_of(stations[s], line)) - face.position_m(place_of(stations[s - 1], line)))
                 .norm();
    }
    table.from.push_back(table.from.back() + sum / static_cast<double>(over.size()));
    table.to.push_back(stations[s]);
  }
  return table;
}

LinearTable across_table(const ShellSurface& face, const std::vector<double>& over) {
  return length_to_share(face, face.across_shares(length_stations), over, [](double across, double line) {
    return Place{across, line};
  });
}

LinearTable along_table(const ShellSurface& face, const std::vector<double>& over) {
  return length_to_share(face, face.along_shares(length_stations), over, [](double along, double line) {
    return Place{line, along};
  });
}

// The share of a turn of the direction (x, y). By a quotient of polynomials and not by a library's arc
// tangent, whose bits differ among processors; off by at most 0.0006.
double turn_of(double x, double y) {
  const auto eighths = [](double slope) { return slope * (1.0 + 0.3476 * (1.0 - slope)); };
  const double a = std::abs(x), b = std::abs(y);
  if (!(a + b > 0.0)) return 0.0;
  const double quarter = b <= a ? 0.125 * eighths(b / a) : 0.25 - 0.125 * eighths(a / b);
  const double half = x < 0.0 ? 0.5 - quarter : quarter;
  return y < 0.0 ? 1.0 - half : half;
}

// Where the nodes of a layer lie on the face, and how large the face is.
class Spread {
 public:
  explicit Spread(const ShellSurface& face) : face_(&face) {
    if (face.form() == ShellSurface::Form::bowl) {
      lay_bowl();
    } else {
      across_ = across_table(face, face.along_shares(lines));
      along_ = along_table(face, face.across_shares(lines));
      size_ = {across_.from.back(), along_.from.back()};
    }
  }

  // Along i and k.
  const std::array<double, 2>& size_m() const { return size_; }

  // `s` and `t` run from 0 to 1 over i and k.
  Place at(double s, double t) const {
    if (face_->form() == ShellSurface::Form::bowl) return in_bowl(2.0 * s - 1.0, 2.0 * t - 1.0);
    const double across = face_->handedness() > 0.0 ? s : 1.0 - s;
    return {across_.at(across * across_.from.back()), along_.at(t * along_.from.back())};
  }

 private:
  // From the point of the rim that is farthest from its middle, so that the grid lies along a long bowl.
  void lay_bowl() {
    across_ = across_table(*face_, {1.0});
    along_ = along_table(*face_, face_->across_shares(lines));
    Vector3 middle = Vector3::Zero();
    for (const double share : across_.to) {
      middle += face_->position_m({share, 1.0}) / static_cast<double>(across_.to.size());
    }
    const auto distance = [&](std::size_t s) {
      return (face_->position_m({across_.to[s], 1.0}) - middle).norm();
    };
    double farthest = 0.0;
    for (std::size_t s = 0; s < across_.to.size(); ++s) farthest = std::max(farthest, distance(s));
    std::size_t first = 0;
    while (distance(first) < as_far * farthest) ++first;
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

  // A square laid over a disc so that its lines stay smooth (Nowell, "Mapping a square to a circle", 2005).
  Place in_bowl(double s, double t) const {
    const double x = s * std::sqrt(1.0 - 0.5 * t * t), y = t * std::sqrt(1.0 - 0.5 * s * s);
    return {across_at(turn_of(x, y)), along_.at(std::sqrt(x * x + y * y) * along_.from.back())};
  }

  const ShellSurface* face_;
  LinearTable across_, along_;
  std::array<double, 2> size_{};
  double start_m_ = 0.0;
};

// The surface's points and normals under the nodes of a layer, by i and k.
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
      // Nodes of one place are so to the last bit.
      const int from = closed && i == rows - 1 ? 0 : i;
      const Place place =
          spread.at(static_cast<double>(from) / (rows - 1), static_cast<double>(k) / (columns - 1));
      nodes.points.push_back(face.position_m(place));
      nodes.normals.push_back(face.normal(place));
      const bool turns = face.form() != ShellSurface::Form::sheet;
      nodes.turns.push_back(turns ? place.across - std::floor(place.across) : 0.0);
    }
  }
  return nodes;
}

// The thickness at which an edge of the far side would shrink to nothing.
double thickness_limit_m(const FaceNodes& nodes) {
  double limit = std::numeric_limits<double>::infinity();
  const auto take = [&](std::size_t a, std::size_t b) {
    const Vector3 edge = nodes.points[b] - nodes.points[a], turn = nodes.normals[b] - nodes.normals[a];
    if (edge.dot(turn) > 0.0) limit = std::min(limit, edge.squaredNorm() / edge.dot(turn));
  };
  for (int i = 0; i < nodes.rows; ++i) {
    for (int k = 0; k < nodes.columns; ++k) {
      if (i + 1 < nodes.rows) take(nodes.index(i, k), nodes.index(i + 1, k));
      if (k + 1 < nodes.columns) take(nodes.index(i, k), nodes.index(i, k + 1));
    }
  }
  return limit;
}

Status check_normals(const FaceNodes& nodes) {
  for (const Vector3& normal : nodes.normals) {
    if (!(normal.squaredNorm() > 0.5)) {
      return Error{
          "surface: has no normal in some place, where a shell has no thickness; spread its control "
          "points there"};
    }
  }
  return {};
}

double volume_between(const ShellSurface& face, double thickness_m, const std::vector<double>& across,
                      const std::vector<double>& along) {
  struct Pair {
    Vector3 near, far;
  };
  const auto row_of = [&](double share) {
    std::vector<Pair> row;
    for (const double other : along) {
      const Vector3 point = face.position_m({share, other});
      row.push_back({point, point - thickness_m * face.normal({share, other})});
    }
    return row;
  };
  double volume = 0.0;
  std::vector<Pair> before = row_of(across.front());
  for (std::size_t a = 1; a < across.size(); ++a) {
    std::vector<Pair> row = row_of(across[a]);
    for (std::size_t b = 1; b < row.size(); ++b) {
      volume += cell_volume({before[b - 1].near, before[b].near, before[b - 1].far, before[b].far,
                             row[b - 1].near, row[b].near, row[b - 1].far, row[b].far});
    }
    before = std::move(row);
  }
  return std::abs(volume);
}

std::vector<double> halved(const std::vector<double>& shares) {
  std::vector<double> finer;
  for (std::size_t s = 0; s + 1 < shares.size(); ++s) {
    finer.push_back(shares[s]);
    finer.push_back(0.5 * (shares[s] + shares[s + 1]));
  }
  finer.push_back(shares.back());
  return finer;
}

// Chords miss the volume by the square of their length: extrapolated from two lengths (Richardson 1911).
double shell_volume_m3(const ShellSurface& face, double thickness_m) {
  const std::vector<double> across = face.across_shares(volume_stations),
                            along = face.along_shares(volume_stations);
  const double coarse = volume_between(face, thickness_m, across, along);
  const double fine = volume_between(face, thickness_m, halved(across), halved(along));
  return (4.0 * fine - coarse) / 3.0;
}

LatticeMesh mesh_of(const FaceNodes& nodes, double thickness_m, const std::array<int, 3>& counts,
                    bool closed) {
  LatticeMesh mesh;
  mesh.count = counts;
  mesh.closed = closed;
  mesh.thin = true;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto [i, j, k] = mesh.place(n);
    const std::size_t at = nodes.index(i, k);
    mesh.nodes.emplace_back(nodes.points[at] - thickness_m * j / (counts[1] - 1) * nodes.normals[at]);
    mesh.turns.push_back(nodes.turns[at]);
  }
  return mesh;
}

// So that the cells together have that volume.
void take_shares(double volume_m3, LatticeMesh& mesh) {
  double of_cells = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) of_cells += cell_volume(mesh.cell(i, j, k));
    }
  }
  mesh.cell_shares.assign(mesh.cell_count(), volume_m3 / of_cells);
}

}  // namespace

Result<LatticeMesh> shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request) {
  const Range<double> range_mm{1e3 * shell_thickness_range_m.low, 1e3 * shell_thickness_range_m.high};
  if (const Status status = check_range("shell_thickness_mm", 1e3 * thickness_m, range_mm); !status.ok()) {
    return status.error();
  }
  if (request.feature_map) {
    return Error{"lattice: feature_map: a shell has no inside to spread nodes in; leave it out"};
  }
  const Result<ShellSurface> face = ShellSurface::make(surface);
  if (!face.ok()) return face.error();
  const Spread spread(face.value());
  const bool closed = face->form() == ShellSurface::Form::ring;
  if (!(spread.size_m()[0] > 0.0 && spread.size_m()[1] > 0.0)) {
    return Error{"surface: has no length in one direction; spread its control points"};
  }
  const Result<std::array<int, 3>> counts =
      shell_counts(request, {spread.size_m()[0], thickness_m, spread.size_m()[1]}, closed);
  if (!counts.ok()) return counts.error();
  const FaceNodes nodes = face_nodes(face.value(), spread, counts.value()[0], counts.value()[2]);
  if (const Status status = check_normals(nodes); !status.ok()) return status.error();
  const double limit_m = thickness_limit_m(nodes);
  if (!(thickness_m < limit_m)) {
    return Error{"shell_thickness_mm: " + number_text(1e3 * thickness_m) +
                 " mm folds over where the surface is curved; use less than " +
                 number_text(std::floor(1e5 * limit_m) / 100.0) + " mm"};
  }
  LatticeMesh mesh = mesh_of(nodes, thickness_m, counts.value(), closed);
  if (const Status status = check_cells(mesh); !status.ok()) {
    return Error{status.error().message + ", or a smaller shell_thickness_mm"};
  }
  take_shares(shell_volume_m3(face.value(), thickness_m), mesh);
  return mesh;
}

}  // namespace spoonbill
