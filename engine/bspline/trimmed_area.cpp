#include "engine/bspline/trimmed_area.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

namespace {

using Polygon = std::vector<Eigen::Vector2d>;

constexpr std::size_t column_count_limit = 1024;
constexpr std::size_t max_mean_listings = 16;  // largest mean number of columns that list an edge
// Largest number of a loop's edges beside which winding numbers are sampled.
constexpr std::size_t sampled_edge_count = 32;
// Distance from an edge at which winding numbers are sampled, in domain lengths. It is larger than rounding
// errors, but smaller than the overlap that touching loops may have.
constexpr double sample_offset = 1e-9;

// Wraps a parameter into a periodic domain. In an open domain, clamps it to a distance from the ends of at
// least 2 * trim_rounding_fraction times the length of the domain.
double inside(const KnotVector& knots, double parameter) {
  const double within = knots.into_domain(parameter);
  if (knots.is_periodic()) return within;
  const double slack = 2.0 * trim_rounding_fraction * knots.domain_length();
  return std::clamp(within, knots.domain_start() + slack, knots.domain_end() - slack);
}

bool reaches_into(const Polygon& polygon, const KnotVector& along_u, const KnotVector& along_v) {
  const Box2 box = box_about(polygon);
  return box.high.x() > along_u.domain_start() && box.low.x() < along_u.domain_end() &&
         box.high.y() > along_v.domain_start() && box.low.y() < along_v.domain_end();
}

// Returns the copies of the polygon, shifted by whole periods, that reach into the domain.
std::vector<Polygon> periodic_copies(const Polygon& polygon, const KnotVector& along_u,
                                     const KnotVector& along_v) {
  std::vector<Polygon> copies;
  const int times_u = along_u.is_periodic() ? 1 : 0, times_v = along_v.is_periodic() ? 1 : 0;
  for (int i = -times_u; i <= times_u; ++i) {
    for (int j = -times_v; j <= times_v; ++j) {
      Polygon copy = polygon;
      for (Eigen::Vector2d& corner : copy) {
        corner += Eigen::Vector2d(i * along_u.domain_length(), j * along_v.domain_length());
      }
      if (reaches_into(copy, along_u, along_v)) copies.push_back(std::move(copy));
    }
  }
  return copies;
}

}  // namespace

Result<TrimmedArea> TrimmedArea::make(const KnotVector& along_u, const KnotVector& along_v,
                                      const std::vector<TrimLoop>& loops) {
  SPOONBILL_ASSERT(along_u.control_point_count() > 0 && along_v.control_point_count() > 0);
  TrimmedArea area;
  area.along_u_ = along_u;
  area.along_v_ = along_v;
  const int count = static_cast<int>(loops.size());
  if (Status status = check_range("the number of trim loops", count, trim_loop_count_range); !status) {
    return status.error();
  }
  if (loops.empty()) return area;
  std::vector<Polygon> polygons;
  std::size_t chords = 0;
  for (const TrimLoop& loop : loops) {
    polygons.push_back(to_polygon(loop, along_u, along_v));
    chords += polygons.back().size();
  }
  if (chords > trim_chord_count_limit) {
    return Error{ErrorCode::too_many, "the trim loops need " + std::to_string(chords) +
                                          " chords, but at most " + std::to_string(trim_chord_count_limit) +
                                          " are allowed; simplify them"};
  }
  if (Status added = area.add_edges(polygons); !added) return added.error();
  if (Status computed = area.compute_level(polygons); !computed) return computed.error();
  return area;
}

Status TrimmedArea::add_edges(const std::vector<std::vector<Eigen::Vector2d>>& polygons) {
  std::vector<Polygon> copies;
  std::vector<std::size_t> loop_of_copy;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    for (Polygon& copy : periodic_copies(polygons[k], along_u_, along_v_)) {
      copies.push_back(std::move(copy));
      loop_of_copy.push_back(k);
    }
  }
  const Eigen::Vector2d lengths(along_u_.domain_length(), along_v_.domain_length());
  if (const auto crossing = find_crossing(copies, trim_rounding_fraction * lengths)) {
    return Error{ErrorCode::self_intersecting, "trim loops " + std::to_string(loop_of_copy[crossing->first]) +
                                                   " and " + std::to_string(loop_of_copy[crossing->second]) +
                                                   " cross each other near (" +
                                                   number_text(crossing->near.x()) + ", " +
                                                   number_text(crossing->near.y()) + "); join them into one"};
  }
  for (const Polygon& copy : copies) {
    for (std::size_t c = 0; c < copy.size(); ++c) edges_.push_back({copy[c], copy[(c + 1) % copy.size()]});
  }
  for (std::size_t columns = std::min(column_count_limit, edges_.size()); columns > 0; columns /= 2) {
    if (fill_columns(columns)) break;
  }
  return {};
}

// Samples winding numbers beside edges of the polygon and returns how often each number occurs. The samples
// are on the left of the edges if the offset is positive.
std::map<int, int> TrimmedArea::windings_beside(const std::vector<Eigen::Vector2d>& polygon,
                                                double offset) const {
  const Eigen::Vector2d lengths(along_u_.domain_length(), along_v_.domain_length());
  std::map<int, int> found;
  const std::size_t step = (polygon.size() + sampled_edge_count - 1) / sampled_edge_count;
  for (std::size_t c = 0; c < polygon.size(); c += step) {
    const Eigen::Vector2d from = polygon[c].cwiseQuotient(lengths);
    const Eigen::Vector2d to = polygon[(c + 1) % polygon.size()].cwiseQuotient(lengths);
    const Eigen::Vector2d left = Eigen::Vector2d(from.y() - to.y(), to.x() - from.x()).normalized();
    const Eigen::Vector2d beside = (0.5 * (from + to) + offset * left).cwiseProduct(lengths);
    ++found[winding(along_u_.into_domain(beside.x()), along_v_.into_domain(beside.y()))];
  }
  return found;
}

// Returns the value of level_ for which the part on the left of the loop remains. Winding numbers are sampled
// on the left, and the most frequent one is used, because rounding may falsify single samples where loops
// touch, or where a loop touches itself across the seam.
int TrimmedArea::find_level(const std::vector<Eigen::Vector2d>& polygon) const {
  const bool outer = signed_area(polygon) > 0.0;
  const std::map<int, int> found = windings_beside(polygon, sample_offset);
  auto chosen = found.begin();
  for (auto other = found.begin(); other != found.end(); ++other) {
    if (other->second > chosen->second || (other->second == chosen->second && !outer)) chosen = other;
  }
  return 1 - chosen->first;
}

Status TrimmedArea::compute_level(const std::vector<std::vector<Eigen::Vector2d>>& polygons) {
  double area = 0.0;
  level_ = find_level(polygons.front());
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    if (find_level(polygons[k]) != level_) {
      return Error{ErrorCode::inconsistent,
                   "trim loop " + std::to_string(k) +
                       " and trim loop 0 keep different parts; outer loops must run counter-clockwise and "
                       "holes clockwise"};
    }
    // The part on the right of a loop is cut away, except where another loop shares the edge and keeps that
    // part.
    const auto beyond = windings_beside(polygons[k], -sample_offset);
    if (level_ < 0 || level_ > 1 || (!beyond.contains(-level_) && !beyond.contains(1 - level_))) {
      return Error{ErrorCode::duplicate,
                   "trim loop " + std::to_string(k) + " coincides with another; remove one of them"};
    }
    area += signed_area(polygons[k]);
  }
  remaining_fraction_ = std::min(1.0, level_ + area / (along_u_.domain_length() * along_v_.domain_length()));
  if (!(remaining_fraction_ > trim_rounding_fraction * trim_rounding_fraction)) {
    return Error{ErrorCode::degenerate, "the trim loops leave nothing of the surface; remove them"};
  }
  return {};
}

bool TrimmedArea::contains(double u, double v) const {
  if (is_whole()) return true;
  return level_ + winding(inside(along_u_, u), inside(along_v_, v)) > 0;
}

std::size_t TrimmedArea::find_column(double u) const {
  const double columns = static_cast<double>(column_starts_.size() - 1);
  const double add_edges = (u - along_u_.domain_start()) / along_u_.domain_length() * columns;
  return static_cast<std::size_t>(std::clamp(add_edges, 0.0, columns - 1.0));
}

// Returns the winding number of a point: the number of edges below the point that run to the right, minus the
// number of edges below it that run to the left. An edge includes its end at the lower u but not its other
// end, so that a corner counts once.
int TrimmedArea::winding(double u, double v) const {
  int number = 0;
  const std::size_t column = find_column(u);
  for (std::size_t e = column_starts_[column]; e < column_starts_[column + 1]; ++e) {
    const Edge& edge = edges_[column_edges_[e]];
    const bool rightwards = edge.from.x() <= u && u < edge.to.x();
    const bool leftwards = edge.to.x() <= u && u < edge.from.x();
    if (!rightwards && !leftwards) continue;
    const double fraction = (u - edge.from.x()) / (edge.to.x() - edge.from.x());
    if (edge.from.y() + fraction * (edge.to.y() - edge.from.y()) <= v) number += rightwards ? 1 : -1;
  }
  return number;
}

// Sorts the edges into columns of equal width in u. Returns false if an edge spans more than
// max_mean_listings columns on average, because the lists would need much memory. A single column always
// succeeds.
bool TrimmedArea::fill_columns(std::size_t columns) {
  column_starts_.assign(columns + 1, 0);
  const auto visit = [&](const auto& add) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto [low, high] = std::minmax(edges_[e].from.x(), edges_[e].to.x());
      if (high < along_u_.domain_start() || low > along_u_.domain_end()) continue;
      for (std::size_t c = find_column(low); c <= find_column(high); ++c) add(c, e);
    }
  };
  visit([&](std::size_t c, std::size_t) { ++column_starts_[c + 1]; });
  for (std::size_t c = 0; c < columns; ++c) column_starts_[c + 1] += column_starts_[c];
  if (columns > 1 && column_starts_.back() > max_mean_listings * edges_.size()) return false;
  column_edges_.resize(column_starts_.back());
  std::vector<std::size_t> next(column_starts_.begin(), column_starts_.end() - 1);
  visit([&](std::size_t c, std::size_t e) { column_edges_[next[c]++] = e; });
  return true;
}

namespace {

// Distance at which a parameter snaps to a grid line, as a fraction of the domain.
constexpr double snap_fraction = 1e-9;

using Edge = TrimmedArea::Edge;

// Returns the parts of an edge between grid lines, in the direction of the edge.
std::vector<Edge> split_at_lines(const Edge& edge, const GridLines& u, const GridLines& v) {
  const auto snapped = [&](const Eigen::Vector2d& point) {
    return Eigen::Vector2d(u.snap(point.x()), v.snap(point.y()));
  };
  std::vector<std::pair<double, Eigen::Vector2d>> points{{0.0, snapped(edge.from)}, {1.0, snapped(edge.to)}};
  for (const int axis : {0, 1}) {
    const std::vector<double>& lines = (axis == 0 ? u : v).all();
    const auto [low, high] = std::minmax(edge.from[axis], edge.to[axis]);
    for (auto line = std::upper_bound(lines.begin(), lines.end(), low); line != lines.end() && *line < high;
         ++line) {
      const double fraction = (*line - edge.from[axis]) / (edge.to[axis] - edge.from[axis]);
      Eigen::Vector2d point = edge.from + fraction * (edge.to - edge.from);
      point[axis] = *line;
      points.emplace_back(fraction, snapped(point));
    }
  }
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Edge> parts;
  for (std::size_t p = 0; p + 1 < points.size(); ++p) {
    if (points[p].second != points[p + 1].second) parts.push_back({points[p].second, points[p + 1].second});
  }
  return parts;
}

bool is_beyond(const GridLines& lines, double parameter) {
  return parameter < lines.at(0) || parameter > lines.at(lines.cells());
}

bool cuts_a_cell(const Edge& part, const GridLines& u, const GridLines& v) {
  const Eigen::Vector2d centre = 0.5 * (part.from + part.to);
  if (is_beyond(u, centre.x()) || is_beyond(v, centre.y())) return false;
  const bool along_u_line = part.from.x() == part.to.x() && u.find_line(part.from.x()) >= 0;
  const bool along_v_line = part.from.y() == part.to.y() && v.find_line(part.from.y()) >= 0;
  return !along_u_line && !along_v_line;
}

}  // namespace

GridLines::GridLines(const GridDirection& direction)
    : at_(direction.parameters), samples_(static_cast<int>(direction.parameters.size())) {
  SPOONBILL_ASSERT(direction.parameters.size() >= 2);
  SPOONBILL_ASSERT(direction.knots.is_periodic() ||
                   (direction.parameters.front() == direction.knots.domain_start() &&
                    direction.parameters.back() == direction.knots.domain_end()));
  const KnotVector& knots = direction.knots;
  if (knots.is_periodic() && at_.back() < knots.domain_end()) at_.push_back(knots.domain_end());
  snap_ = snap_fraction * knots.domain_length();
}

double GridLines::snap(double parameter) const {
  const auto after = std::lower_bound(at_.begin(), at_.end(), parameter);
  if (after != at_.end() && *after - parameter <= snap_) return *after;
  if (after != at_.begin() && parameter - *(after - 1) <= snap_) return *(after - 1);
  return parameter;
}

int GridLines::find_cell(double parameter) const {
  const auto after = std::upper_bound(at_.begin(), at_.end(), parameter) - at_.begin();
  return std::clamp(static_cast<int>(after) - 1, 0, cells() - 1);
}

int GridLines::find_line(double parameter) const {
  const auto found = std::lower_bound(at_.begin(), at_.end(), parameter);
  return found != at_.end() && *found == parameter ? static_cast<int>(found - at_.begin()) : -1;
}

double GridLines::merge_seam(double parameter) const {
  return cells() == samples_ && parameter == at_.back() ? at_.front() : parameter;
}

TrimmedCells::TrimmedCells(const GridLines& u, const GridLines& v, const TrimmedArea& area)
    : columns_(v.cells()) {
  SPOONBILL_ASSERT(u.cells() > 0 && v.cells() > 0);
  const std::size_t count = static_cast<std::size_t>(u.cells()) * static_cast<std::size_t>(v.cells());
  std::vector<std::pair<std::size_t, Edge>> found;
  for (const Edge& edge : area.edges()) {
    for (const Edge& part : split_at_lines(edge, u, v)) {
      if (!cuts_a_cell(part, u, v)) continue;
      const Eigen::Vector2d centre = 0.5 * (part.from + part.to);
      found.emplace_back(index(u.find_cell(centre.x()), v.find_cell(centre.y())), part);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  starts_.assign(count + 1, 0);
  for (const auto& [cell, part] : found) {
    ++starts_[cell + 1];
    edges_.push_back(part);
  }
  for (std::size_t cell = 0; cell < count; ++cell) starts_[cell + 1] += starts_[cell];
  states_.assign(count, State::cut);
  for (int i = 0; i < u.cells(); ++i) {
    for (int j = 0; j < v.cells(); ++j) {
      if (!edges(i, j).empty()) continue;
      const bool is_inside = area.contains(0.5 * (u.at(i) + u.at(i + 1)), 0.5 * (v.at(j) + v.at(j + 1)));
      states_[index(i, j)] = is_inside ? State::kept : State::away;
    }
  }
}

namespace {

double v_at(const TrimmedArea::Edge& edge, double u) {
  if (u == edge.from.x()) return edge.from.y();
  if (u == edge.to.x()) return edge.to.y();
  return edge.from.y() + (u - edge.from.x()) / (edge.to.x() - edge.from.x()) * (edge.to.y() - edge.from.y());
}

// A straight line that bounds a piece of a cell from below or from above. The piece extends from one value of
// u to a higher one. v_first is the v of the line at the lower of these values, v_last at the higher.
struct CutSide {
  double v_first, v_last;
};

class Cutter {
 public:
  Cutter(const GridDirection& u, const GridDirection& v, const TrimmedArea& area)
      : u_(u), v_(v), area_(area), cells_(u_, v_, area) {}

  TrimmedGrid cut() {
    for (int i = 0; i < u_.cells(); ++i) {
      for (int j = 0; j < v_.cells(); ++j) add_cell(i, j);
    }
    for (const Piece& piece : pieces_) emit(piece);
    return std::move(result_);
  }

 private:
  struct Piece {
    int i, j;                              // indices of the cell that contains the piece
    std::vector<Eigen::Vector2d> corners;  // convex, counter-clockwise
  };

  void add_cell(int i, int j) {
    const TrimmedCells::State state = cells_.state(i, j);
    const double u0 = u_.at(i), u1 = u_.at(i + 1), v0 = v_.at(j), v1 = v_.at(j + 1);
    if (state == TrimmedCells::State::kept) add_piece(i, j, u0, u1, {v0, v0}, {v1, v1});
    if (state != TrimmedCells::State::cut) return;
    std::set<double> lines{u0, u1};
    for (const TrimmedArea::Edge& edge : cells_.edges(i, j)) lines.insert({edge.from.x(), edge.to.x()});
    for (auto line = lines.begin(); std::next(line) != lines.end(); ++line) {
      add_slab(i, j, *line, *std::next(line));
    }
  }

  // Adds the pieces of a cell between u = `first` and u = `last`. No edge begins or ends between them, so the
  // edges can be ordered by v.
  void add_slab(int i, int j, double first, double last) {
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
      const double centre = 0.25 * (low.v_first + low.v_last + high.v_first + high.v_last);
      if (area_.contains(0.5 * (first + last), centre)) add_piece(i, j, first, last, low, high);
    }
  }

  void add_piece(int i, int j, double first, double last, const CutSide& low, const CutSide& high) {
    Piece piece{i, j, {}};
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(first, low.v_first), Eigen::Vector2d(last, low.v_last),
          Eigen::Vector2d(last, high.v_last), Eigen::Vector2d(first, high.v_first)}) {
      if (piece.corners.empty() || corner != piece.corners.back()) piece.corners.push_back(corner);
    }
    if (piece.corners.front() == piece.corners.back()) piece.corners.pop_back();
    if (piece.corners.size() < 3) return;
    for (const Eigen::Vector2d& corner : piece.corners) {
      // A crossing of two grid lines needs no entry in on_u_line_ and on_v_line_, because every piece that
      // touches the crossing has a corner there.
      if (u_.find_line(corner.x()) >= 0 && v_.find_line(corner.y()) >= 0) continue;
      on_u_line_[u_.merge_seam(corner.x())].insert(corner.y());
      if (v_.find_line(corner.y()) >= 0) on_v_line_[v_.merge_seam(corner.y())].insert(corner.x());
    }
    pieces_.push_back(std::move(piece));
  }

  // Adds the triangles of a piece. Corners of neighbouring pieces that are on a side of this piece become
  // further vertices. If there are any, the triangles form a fan around the piece's centre.
  void emit(const Piece& piece) {
    std::vector<std::uint32_t> ring;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    for (std::size_t c = 0; c < piece.corners.size(); ++c) {
      const Eigen::Vector2d& from = piece.corners[c];
      centre += from / static_cast<double>(piece.corners.size());
      ring.push_back(vertex(piece, from));
      add_between(piece, from, piece.corners[(c + 1) % piece.corners.size()], ring);
    }
    if (ring.size() == piece.corners.size()) {
      for (std::size_t c = 1; c + 1 < ring.size(); ++c) add_triangle(ring[0], ring[c], ring[c + 1]);
      return;
    }
    const std::uint32_t hub = vertex(piece, centre);
    for (std::size_t c = 0; c < ring.size(); ++c) add_triangle(hub, ring[c], ring[(c + 1) % ring.size()]);
  }

  void add_between(const Piece& piece, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   std::vector<std::uint32_t>& ring) {
    const bool upright = from.x() == to.x();
    if (!upright && from.y() != to.y()) return;
    const auto& on_line = upright ? on_u_line_ : on_v_line_;
    const auto line = on_line.find(upright ? u_.merge_seam(from.x()) : v_.merge_seam(from.y()));
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
    const int line_u = u_.find_line(at.x()), line_v = v_.find_line(at.y());
    if (line_u >= 0 && line_v >= 0) return sample(line_u, line_v);
    const auto [known, added] = numbers_.try_emplace({u_.merge_seam(at.x()), v_.merge_seam(at.y())},
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

double remaining_area_fraction(const Surface& surface, const TrimmedArea& area) {
  constexpr int halvings = 3;
  const auto grid = make_grid(surface.u, surface.v, nested_parameters(surface.u, 1, halvings).parameters,
                              nested_parameters(surface.v, 1, halvings).parameters);
  if (!grid) return area.remaining_fraction();
  const TrimmedGrid trimmed = trim_grid(grid->u, grid->v, area);
  std::vector<Vector3> points;
  for (const double u : grid->u.parameters) {
    for (const double v : grid->v.parameters) points.push_back(position(surface, u, v));
  }
  const auto twice_area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (points[b] - points[a]).cross(points[c] - points[a]).norm();
  };
  double whole = 0.0, remaining = 0.0;
  const auto columns = static_cast<std::size_t>(grid->columns());
  for (std::size_t i = 0; i + 1 < grid->u.parameters.size(); ++i) {
    for (std::size_t j = 0; j + 1 < columns; ++j) {
      const std::size_t a = i * columns + j;
      whole += twice_area(a, a + columns, a + columns + 1) + twice_area(a, a + columns + 1, a + 1);
    }
  }
  for (const CutVertex& cut : trimmed.vertices) points.push_back(position(surface, cut.u, cut.v));
  for (const auto& [a, b, c] : trimmed.triangles) remaining += twice_area(a, b, c);
  return whole > 0.0 ? std::min(1.0, remaining / whole) : area.remaining_fraction();
}

}  // namespace spoonbill
