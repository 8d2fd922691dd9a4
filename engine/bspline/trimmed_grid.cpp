#include "engine/bspline/trimmed_grid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace spoonbill {

namespace {

// Of the domain: nearer to a grid line a corner of a loop is moved onto it, so that no sliver is cut off.
constexpr double snap_share = 1e-9;

struct Lines {
  std::vector<double> at;  // both ends of the domain included
  int count = 0;           // of samples: one fewer where the last line is the first again
  double snap = 0.0;

  explicit Lines(const GridDirection& direction)
      : at(direction.parameters), count(static_cast<int>(direction.parameters.size())) {
    const KnotVector& knots = direction.knots;
    if (knots.is_periodic() && at.back() < knots.domain_end()) at.push_back(knots.domain_end());
    snap = snap_share * (knots.domain_end() - knots.domain_start());
  }
  int cells() const { return static_cast<int>(at.size()) - 1; }
  bool wraps() const { return cells() == count; }
  double start() const { return at.front(); }
  double end() const { return at.back(); }

  double snapped(double parameter) const {
    const auto after = std::lower_bound(at.begin(), at.end(), parameter);
    if (after != at.end() && *after - parameter <= snap) return *after;
    if (after != at.begin() && parameter - *(after - 1) <= snap) return *(after - 1);
    return parameter;
  }
  // The cell that holds it; of a line, the one after it.
  int cell_of(double parameter) const {
    const auto after = std::upper_bound(at.begin(), at.end(), parameter) - at.begin();
    return std::clamp(static_cast<int>(after) - 1, 0, cells() - 1);
  }
  // The number of the line that stands there; -1: none.
  int line_at(double parameter) const {
    const auto found = std::lower_bound(at.begin(), at.end(), parameter);
    return found != at.end() && *found == parameter ? static_cast<int>(found - at.begin()) : -1;
  }
  // The same for both sides of a seam.
  double joined(double parameter) const { return wraps() && parameter == end() ? start() : parameter; }
};

struct Segment {
  Eigen::Vector2d from, to;

  double low_u() const { return std::min(from.x(), to.x()); }
  double high_u() const { return std::max(from.x(), to.x()); }
  double v_at(double u) const {
    if (u == from.x()) return from.y();
    if (u == to.x()) return to.y();
    return from.y() + (u - from.x()) / (to.x() - from.x()) * (to.y() - from.y());
  }
};

// A side of a piece of a cell: a v at each of two lines of u.
struct Side {
  double v_first, v_last;
};

class Cutter {
 public:
  Cutter(const GridDirection& u, const GridDirection& v, const TrimmedArea& area)
      : u_(u), v_(v), area_(area), segments_(static_cast<std::size_t>(u_.cells() * v_.cells())) {}

  TrimmedGrid cut() {
    for (const TrimmedArea::Edge& edge : area_.edges()) share_out({edge.from, edge.to});
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

  std::size_t cell(int i, int j) const { return static_cast<std::size_t>(i * v_.cells() + j); }

  // An edge's parts between grid lines, each to its cell. What lies along a line cuts none.
  void share_out(const Segment& edge) {
    std::vector<std::pair<double, Eigen::Vector2d>> points{{0.0, snapped(edge.from)},
                                                           {1.0, snapped(edge.to)}};
    for (const int axis : {0, 1}) {
      const Lines& lines = axis == 0 ? u_ : v_;
      const auto [low, high] = std::minmax(edge.from[axis], edge.to[axis]);
      for (auto line = std::upper_bound(lines.at.begin(), lines.at.end(), low);
           line != lines.at.end() && *line < high; ++line) {
        const double share = (*line - edge.from[axis]) / (edge.to[axis] - edge.from[axis]);
        Eigen::Vector2d point = edge.from + share * (edge.to - edge.from);
        point[axis] = *line;
        points.emplace_back(share, snapped(point));
      }
    }
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t p = 0; p + 1 < points.size(); ++p) add({points[p].second, points[p + 1].second});
  }

  Eigen::Vector2d snapped(const Eigen::Vector2d& point) const {
    return {u_.snapped(point.x()), v_.snapped(point.y())};
  }

  void add(const Segment& segment) {
    const Eigen::Vector2d middle = 0.5 * (segment.from + segment.to);
    if (middle.x() < u_.start() || middle.x() > u_.end() || middle.y() < v_.start() ||
        middle.y() > v_.end()) {
      return;
    }
    const bool along_line = (segment.from.x() == segment.to.x() && u_.line_at(middle.x()) >= 0) ||
                            (segment.from.y() == segment.to.y() && v_.line_at(middle.y()) >= 0);
    if (segment.from == segment.to || along_line) return;
    segments_[cell(u_.cell_of(middle.x()), v_.cell_of(middle.y()))].push_back(segment);
  }

  void take_cell(int i, int j) {
    const std::vector<Segment>& crossing = segments_[cell(i, j)];
    const double u0 = u_.at[i], u1 = u_.at[i + 1], v0 = v_.at[j], v1 = v_.at[j + 1];
    if (crossing.empty()) {
      if (area_.contains(0.5 * (u0 + u1), 0.5 * (v0 + v1))) take_piece(i, j, u0, u1, {v0, v0}, {v1, v1});
      return;
    }
    std::set<double> lines{u0, u1};
    for (const Segment& segment : crossing) lines.insert({segment.from.x(), segment.to.x()});
    for (auto line = lines.begin(); std::next(line) != lines.end(); ++line) {
      take_slab(i, j, *line, *std::next(line));
    }
  }

  // Between two lines of u, edges lie above each other.
  void take_slab(int i, int j, double first, double last) {
    const double v0 = v_.at[j], v1 = v_.at[j + 1];
    std::vector<Side> sides{{v0, v0}, {v1, v1}};
    for (const Segment& segment : segments_[cell(i, j)]) {
      if (segment.low_u() > first || segment.high_u() < last) continue;
      sides.push_back({std::clamp(segment.v_at(first), v0, v1), std::clamp(segment.v_at(last), v0, v1)});
    }
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return a.v_first + a.v_last < b.v_first + b.v_last; });
    for (std::size_t s = 0; s + 1 < sides.size(); ++s) {
      const Side &low = sides[s], &high = sides[s + 1];
      const double middle = 0.25 * (low.v_first + low.v_last + high.v_first + high.v_last);
      if (area_.contains(0.5 * (first + last), middle)) take_piece(i, j, first, last, low, high);
    }
  }

  void take_piece(int i, int j, double first, double last, const Side& low, const Side& high) {
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
    return static_cast<std::uint32_t>((i % u_.count) * v_.count + j % v_.count);
  }

  std::uint32_t vertex(const Piece& piece, const Eigen::Vector2d& at) {
    const int line_u = u_.line_at(at.x()), line_v = v_.line_at(at.y());
    if (line_u >= 0 && line_v >= 0) return sample(line_u, line_v);
    const auto [known, added] = numbers_.try_emplace({u_.joined(at.x()), v_.joined(at.y())},
                                                     static_cast<std::uint32_t>(u_.count * v_.count) +
                                                         static_cast<std::uint32_t>(result_.vertices.size()));
    if (!added) return known->second;
    const int i = piece.i, j = piece.j;
    const double s = (at.x() - u_.at[i]) / (u_.at[i + 1] - u_.at[i]);
    const double t = (at.y() - v_.at[j]) / (v_.at[j + 1] - v_.at[j]);
    result_.vertices.push_back({at.x(),
                                at.y(),
                                {sample(i, j), sample(i + 1, j), sample(i + 1, j + 1), sample(i, j + 1)},
                                {(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t}});
    return known->second;
  }

  const Lines u_, v_;
  const TrimmedArea& area_;
  std::vector<std::vector<Segment>> segments_;  // of each cell
  std::vector<Piece> pieces_;
  std::map<double, std::set<double>> on_u_line_, on_v_line_;
  std::map<std::pair<double, double>, std::uint32_t> numbers_;
  TrimmedGrid result_;
};

}  // namespace

TrimmedGrid trim_grid(const GridDirection& u, const GridDirection& v, const TrimmedArea& area) {
  return Cutter(u, v, area).cut();
}

}  // namespace spoonbill
