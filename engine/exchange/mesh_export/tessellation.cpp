#include "engine/exchange/mesh_export/tessellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/exchange/mesh_export/slivers.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

// What a file rounds away of coordinates.
constexpr double coincidence_m = 1e-9;
// Of the chord error, for the bend along one direction; the twist takes what is left.
constexpr double share_of_a_direction = 0.4;
// Of the chord error, what cells have at least where the edges of loops take the rest.
constexpr double least_share_of_cells = 0.5;

// Into how many cells each polynomial piece is cut.
using Cuts = std::vector<int>;

std::vector<double> cut(const std::vector<double>& pieces, const Cuts& cuts) {
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

int cuts_for(double bulge, double allowed) {
  return std::max(1, static_cast<int>(std::min(std::ceil(std::sqrt(bulge / allowed)), 1e6)));
}

Cells first_cells(const Surface& surface, const SurfaceBounds& bounds, double chord_m) {
  Cells cells{surface.u.breakpoints(), surface.v.breakpoints(), {}, {}};
  cells.u_cuts.assign(static_cast<std::size_t>(bounds.elements_u()), 1);
  cells.v_cuts.assign(static_cast<std::size_t>(bounds.elements_v()), 1);
  const double allowed = share_of_a_direction * chord_m;
  for (int a = 0; a < bounds.elements_u(); ++a) {
    for (int b = 0; b < bounds.elements_v(); ++b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      const double u_length = cells.u_pieces[i + 1] - cells.u_pieces[i];
      const double v_length = cells.v_pieces[j + 1] - cells.v_pieces[j];
      cells.u_cuts[i] = std::max(cells.u_cuts[i], cuts_for(bounds.bulge(a, b, u_length, 0.0), allowed));
      cells.v_cuts[j] = std::max(cells.v_cuts[j], cuts_for(bounds.bulge(a, b, 0.0, v_length), allowed));
    }
  }
  return cells;
}

// The points of a grid of cells, and what its triangles leave of the surface.
struct Sheet {
  Grid grid;
  GridSamples<double> samples;

  Vector3 point(std::size_t i, std::size_t j) const {
    const std::size_t k = i * grid.v.parameters.size() + j;
    return {samples.x[k], samples.y[k], samples.z[k]};
  }
};

Result<Sheet> sheet_of(const Surface& surface, const Cells& cells) {
  auto grid =
      make_grid(surface.u, surface.v, cut(cells.u_pieces, cells.u_cuts), cut(cells.v_pieces, cells.v_cuts));
  if (!grid) return grid.error();
  Sheet sheet{std::move(grid).value(), {}};
  sheet.samples.resize(sheet.grid.u.parameters.size() * sheet.grid.v.parameters.size());
  GridEvaluator<double> evaluator(sheet.grid, best_instruction_set());
  evaluator.points(surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), sheet.samples);
  return sheet;
}

// Of each polynomial piece, the largest error of its cells; of those that come after a stop, none.
Eigen::MatrixXd errors_of(const Sheet& sheet, const SurfaceBounds& bounds, const Cells& cells,
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

// The vertices of a sheet: those of a seam or a pole are one, as find_closing() has it.
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

  // The place in the grid of the vertex that stands for (i, j).
  std::size_t vertex(std::size_t i, std::size_t j) const {
    if (u_closed_ && i == rows_ - 1) i = 0;
    if (v_closed_ && j == columns_ - 1) j = 0;
    if ((first_row_ && i == 0) || (last_row_ && i == rows_ - 1)) j = 0;
    if ((first_column_ && j == 0) || (last_column_ && j == columns_ - 1)) i = 0;
    return i * columns_ + j;
  }

  // How far a point is from the vertex that stands for it; 0 where that is what a file rounds away.
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

using Places = std::array<std::size_t, 3>;

void add_triangle(std::size_t p, std::size_t q, std::size_t r, std::vector<Places>& triangles) {
  if (p != q && q != r && r != p) triangles.push_back({p, q, r});
}

void add_cell(const Sheet& sheet, const Welding& welding, std::size_t i, std::size_t j,
              std::vector<Places>& triangles) {
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

std::vector<Places> whole_cells(const Sheet& sheet, const Welding& welding) {
  std::vector<Places> triangles;
  for (std::size_t i = 0; i + 1 < sheet.grid.u.parameters.size(); ++i) {
    for (std::size_t j = 0; j + 1 < sheet.grid.v.parameters.size(); ++j) {
      add_cell(sheet, welding, i, j, triangles);
    }
  }
  return triangles;
}

// Triangles between places, of which those of the sheet come first and `more` follow.
TriangleMesh mesh_of(const Sheet& sheet, const std::vector<Vector3>& more,
                     const std::vector<Places>& triangles) {
  const std::size_t columns = sheet.grid.v.parameters.size(), samples = sheet.samples.x.size();
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> index(samples + more.size(), none);
  TriangleMesh mesh;
  for (const Places& places : triangles) {
    TriangleCorners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t place = places[k];
      if (index[place] == none) {
        index[place] = static_cast<std::uint32_t>(mesh.vertices_m.size());
        mesh.vertices_m.push_back(place < samples ? sheet.point(place / columns, place % columns)
                                                  : more[place - samples]);
      }
      corners[k] = index[place];
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

TriangleMesh kept_mesh(const Sheet& sheet, const Welding& welding, const TrimmedArea& area) {
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
  const auto place = [&](std::size_t number) {
    return number < samples ? welding.vertex(number / columns, number % columns) : number;
  };
  std::vector<Places> triangles;
  for (const auto& corners : cut.triangles) {
    add_triangle(place(corners[0]), place(corners[1]), place(corners[2]), triangles);
  }
  return mesh_of(sheet, more, triangles);
}

// How far the polygons that stand for loops can be from them.
double trim_edge_error_m(const Surface& surface, const std::vector<TrimLoop>& trims) {
  double share = 0.0;
  for (const TrimLoop& loop : trims) share = std::max(share, polygon_error_fraction(loop, surface.u, surface.v));
  return share * stretch_bound_m(surface);
}

Result<Tessellation> finished(const Sheet& sheet, const Surface& surface, const std::vector<TrimLoop>& trims,
                              double chord_error_m) {
  const Welding welding(sheet, surface);
  TriangleMesh whole = mesh_of(sheet, {}, whole_cells(sheet, welding));
  const bool is_inside_out = welding.closed() && enclosed_volume_m3(whole) < 0.0;
  Tessellation result{std::move(whole), welding.closed(), chord_error_m + welding.largest_move_m()};
  if (!trims.empty()) {
    const auto area = TrimmedArea::make(surface.u, surface.v, trims);
    if (!area) return area.error();
    result.mesh = kept_mesh(sheet, welding, area.value());
    remove_slivers(result.mesh);
    result.closed = false;
  }
  if (is_inside_out) {
    for (TriangleCorners& corners : result.mesh.triangles) std::swap(corners[1], corners[2]);
  }
  return result;
}

}  // namespace

Result<Tessellation> tessellate(const Surface& surface, const std::vector<TrimLoop>& trims, double chord_m,
                                std::size_t triangle_limit, const Progress& progress) {
  SPOONBILL_ASSERT(chord_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const double edges_m = trim_edge_error_m(surface, trims);
  const double allowed_m = std::max(chord_m - edges_m, least_share_of_cells * chord_m);
  SurfaceBounds bounds(surface.u, surface.v);
  bounds.update(surface.net);
  Cells cells = first_cells(surface, bounds, allowed_m);
  for (;;) {
    if (cells.triangles() > triangle_limit) {
      return Error{"a chord error of " + number_text(1e3 * chord_m) + " mm would take more than " +
                   std::to_string(triangle_limit) + " triangles; choose a larger --chord"};
    }
    const auto sheet = sheet_of(surface, cells);
    if (!sheet) return sheet.error();
    const Eigen::MatrixXd errors = errors_of(sheet.value(), bounds, cells, progress);
    if (!progress.report(0.0)) return Progress::stopped();
    if (const double largest = errors.maxCoeff(); largest <= allowed_m) {
      return finished(sheet.value(), surface, trims, largest + edges_m);
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

}  // namespace spoonbill
