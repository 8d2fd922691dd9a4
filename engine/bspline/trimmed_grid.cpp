#include "engine/bspline/trimmed_grid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_cells.h"

namespace spoonbill {

namespace {

double v_at(const TrimmedArea::Edge& edge, double u) {
  if (u == edge.from.x()) return edge.from.y();
  if (u == edge.to.x()) return edge.to.y();
  return edge.from.y() + (u - edge.from.x()) / (edge.to.x() - edge.from.x()) * (edge.to.y() - edge.from.y());
}

// A side of a piece of a cell: a v at each of two lines of u.
struct CutSide {
  double v_first, v_last;
};

class Cutter {
 public:
  Cutter(const GridDirection& u, const GridDirection& v, const TrimmedArea& area)
      : u_(u), v_(v), area_(area), cells_(u_, v_, area) {}

  TrimmedGrid cut() {
    for (int i = 0; i < u_.cells(); ++i) {
      for (int j = 0; j < v_.cells(); ++j) take_cell(i, j);
    }
    for (const Piece& piece : pieces_) emit(piece);
    return std::move(result_);
  }

 private:
  struct Piece {
    int i, j;                              // its cell
    std::vector<Eigen::Vector2d> corners;  // counter-clockwise, convex
  };

  void take_cell(int i, int j) {
    const TrimmedCells::State state = cells_.state(i, j);
    const double u0 = u_.at(i), u1 = u_.at(i + 1), v0 = v_.at(j), v1 = v_.at(j + 1);
    if (state == TrimmedCells::State::kept) take_piece(i, j, u0, u1, {v0, v0}, {v1, v1});
    if (state != TrimmedCells::State::cut) return;
    std::set<double> lines{u0, u1};
    for (const TrimmedArea::Edge& edge : cells_.edges(i, j)) lines.insert({edge.from.x(), edge.to.x()});
    for (auto line = lines.begin(); std::next(line) != lines.end(); ++line) {
      take_slab(i, j, *line, *std::next(line));
    }
  }

  // Between two lines of u, edges lie above each other.
  void take_slab(int i, int j, double first, double last) {
    const double v0 = v_.at(j), v1 = v_.at(j + 1);
    std::vector<CutSide> sides{{v0, v0}, {v1, v1}};
    for (const TrimmedArea::Edge& edge : cells_.edges(i, j)) {
      const auto [low, high] = std::minmax(edge.from.x(), edge.to.x());
      if (low > first || high < last) continue;
      sides.push_back({std::clamp(v_at(edge, first), v0, v1), std::clamp(v_at(edge, last), v0, v1)});
    }
    std::sort(sides.begin(), sides.end(),
              [](const CutSide& a, const CutSide& b) { return a.v_first + a.v_last < b.v_first + b.v_last; });
    for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
      const CutSide &low = sides[s], &high = sides[s + 1];
      const double middle = 0.25 * (low.v_first + low.v_last + high.v_first + high.v_last);
      if (area_.contains(0.5 * (first + last), middle)) take_piece(i, j, first, last, low, high);
    }
  }

  void take_piece(int i, int j, double first, double last, const CutSide& low, const CutSide& high) {
    Piece piece{i, j, {}};
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(first, low.v_first), Eigen::Vector2d(last, low.v_last),
          Eigen::Vector2d(last, high.v_last), Eigen::Vector2d(first, high.v_first)}) {
      if (piece.corners.empty() || corner != piece.corners.back()) piece.corners.push_back(corner);
    }
    if (piece.corners.front() == piece.corners.back()) piece.corners.pop_back();
    if (piece.corners.size() < 3) return;
    for (const Eigen::Vector2d& corner : piece.corners) {
      // Where two grid lines cross every piece has a corner.
      if (u_.line_at(corner.x()) >= 0 && v_.line_at(corner.y()) >= 0) continue;
      on_u_line_[u_.joined(corner.x())].insert(corner.y());
      if (v_.line_at(corner.y()) >= 0) on_v_line_[v_.joined(corner.y())].insert(corner.x());
    }
    pieces_.push_back(std::move(piece));
  }

  // With the corners that neighbours have on its sides; around its middle where there are any.
  void emit(const Piece& piece) {
    std::vector<std::uint32_t> ring;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (std::size_t c = 0; c < piece.corners.size(); ++c) {
      const Eigen::Vector2d& from = piece.corners[c];
      middle += from / static_cast<double>(piece.corners.size());
      ring.push_back(vertex(piece, from));
      add_between(piece, from, piece.corners[(c + 1) % piece.corners.size()], ring);
    }
    if (ring.size() == piece.corners.size()) {
      for (std::size_t c = 1; c + 1 < ring.size(); ++c) add_triangle(ring[0], ring[c], ring[c + 1]);
      return;
    }
    const std::uint32_t centre = vertex(piece, middle);
    for (std::size_t c = 0; c < ring.size(); ++c) add_triangle(centre, ring[c], ring[(c + 1) % ring.size()]);
  }

  void add_between(const Piece& piece, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   std::vector<std::uint32_t>& ring) {
    const bool upright = from.x() == to.x();
    if (!upright && from.y() != to.y()) return;
    const auto& on_line = upright ? on_u_line_ : on_v_line_;
    const auto line = on_line.find(upright ? u_.joined(from.x()) : v_.joined(from.y()));
    if (line == on_line.end()) return;
    const int axis = upright ? 1 : 0;
    const auto [low, high] = std::minmax(from[axis], to[axis]);
    std::vector<double> between(line->second.upper_bound(low), line->second.lower_bound(high));
    if (from[axis] > to[axis]) std::reverse(between.begin(), between.end());
    for (const double at : between) {
      ring.push_back(vertex(piece, upright ? Eigen::Vector2d(from.x(), at) : Eigen::Vector2d(at, from.y())));
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    result_.triangles.push_back({a, b, c});
  }

  std::uint32_t sample(int i, int j) const {
    return static_cast<std::uint32_t>((i % u_.samples()) * v_.samples() + j % v_.samples());
  }

  std::uint32_t vertex(const Piece& piece, const Eigen::Vector2d& at) {
    const int line_u = u_.line_at(at.x()), line_v = v_.line_at(at.y());
    if (line_u >= 0 && line_v >= 0) return sample(line_u, line_v);
    const auto [known, added] = numbers_.try_emplace({u_.joined(at.x()), v_.joined(at.y())},
                                                     static_cast<std::uint32_t>(u_.samples() * v_.samples()) +
                                                         static_cast<std::uint32_t>(result_.vertices.size()));
    if (!added) return known->second;
    const int i = piece.i, j = piece.j;
    const double s = (at.x() - u_.at(i)) / (u_.at(i + 1) - u_.at(i));
    const double t = (at.y() - v_.at(j)) / (v_.at(j + 1) - v_.at(j));
    result_.vertices.push_back({at.x(),
                                at.y(),
                                {sample(i, j), sample(i + 1, j), sample(i + 1, j + 1), sample(i, j + 1)},
                                {(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t}});
    return known->second;
  }

  const GridLines u_, v_;
  const TrimmedArea& area_;
  const TrimmedCells cells_;
  std::vector<Piece> pieces_;
  std::map<double, std::set<double>> on_u_line_, on_v_line_;
  std::map<std::pair<double, double>, std::uint32_t> numbers_;
  TrimmedGrid result_;
};

}  // namespace

TrimmedGrid trim_grid(const GridDirection& u, const GridDirection& v, const TrimmedArea& area) {
  return Cutter(u, v, area).cut();
}

double kept_area_share(const Surface& surface, const TrimmedArea& area) {
  constexpr int halvings = 3;
  const auto grid = make_grid(surface.u, surface.v, nested_parameters(surface.u, 1, halvings).parameters,
                              nested_parameters(surface.v, 1, halvings).parameters);
  if (!grid) return area.kept_share();
  const TrimmedGrid trimmed = trim_grid(grid->u, grid->v, area);
  std::vector<Vector3> points;
  for (const double u : grid->u.parameters) {
    for (const double v : grid->v.parameters) points.push_back(position(surface, u, v));
  }
  const auto twice_area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (points[b] - points[a]).cross(points[c] - points[a]).norm();
  };
  double whole = 0.0, kept = 0.0;
  const auto columns = static_cast<std::size_t>(grid->columns());
  for (std::size_t i = 0; i + 1 < grid->u.parameters.size(); ++i) {
    for (std::size_t j = 0; j + 1 < columns; ++j) {
      const std::size_t a = i * columns + j;
      whole += twice_area(a, a + columns, a + columns + 1) + twice_area(a, a + columns + 1, a + 1);
    }
  }
  for (const CutVertex& cut : trimmed.vertices) points.push_back(position(surface, cut.u, cut.v));
  for (const auto& [a, b, c] : trimmed.triangles) kept += twice_area(a, b, c);
  return whole > 0.0 ? std::min(1.0, kept / whole) : area.kept_share();
}

}  // namespace spoonbill
