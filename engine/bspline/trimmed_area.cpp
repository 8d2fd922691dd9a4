#include "engine/bspline/trimmed_area.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/box.h"
#include "engine/base/number_text.h"
#include "engine/bspline/polygon_crossing.h"

namespace spoonbill {

namespace {

using Polygon = std::vector<Eigen::Vector2d>;

constexpr std::size_t column_count_limit = 1024;
constexpr std::size_t listed_times_limit = 16;  // of an edge on average
// Edges beside which a loop is asked what it keeps, and how far beside them in lengths of the domain: less
// than loops that touch may overlap, more than rounding.
constexpr std::size_t asked_edge_count = 32;
constexpr double beside_share = 1e-9;

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

// An end of an open domain is judged by what lies as far inside as loops may miss it.
double inside(const KnotVector& knots, double parameter) {
  const double within = knots.into_domain(parameter);
  if (knots.is_periodic()) return within;
  const double slack = 2.0 * trim_rounding_share * length_of(knots);
  return std::clamp(within, knots.domain_start() + slack, knots.domain_end() - slack);
}

bool reaches_into(const Polygon& polygon, const KnotVector& along_u, const KnotVector& along_v) {
  const Box2 box = box_about(polygon);
  return box.high.x() > along_u.domain_start() && box.low.x() < along_u.domain_end() &&
         box.high.y() > along_v.domain_start() && box.low.y() < along_v.domain_end();
}

// The polygon wherever it lies in the domain, once for each period that it reaches into.
std::vector<Polygon> copies_of(const Polygon& polygon, const KnotVector& along_u, const KnotVector& along_v) {
  std::vector<Polygon> copies;
  const int times_u = along_u.is_periodic() ? 1 : 0, times_v = along_v.is_periodic() ? 1 : 0;
  for (int i = -times_u; i <= times_u; ++i) {
    for (int j = -times_v; j <= times_v; ++j) {
      Polygon copy = polygon;
      for (Eigen::Vector2d& corner : copy) {
        corner += Eigen::Vector2d(i * length_of(along_u), j * length_of(along_v));
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
    polygons.push_back(polygon_of(loop, along_u, along_v));
    chords += polygons.back().size();
  }
  if (chords > trim_chord_count_limit) {
    return Error{"the trim loops take " + std::to_string(chords) + " chords, more than " +
                 std::to_string(trim_chord_count_limit) + "; simplify them"};
  }
  if (Status placed = area.place(polygons); !placed) return placed.error();
  if (Status levelled = area.take_level(polygons); !levelled) return levelled.error();
  return area;
}

Status TrimmedArea::place(const std::vector<std::vector<Eigen::Vector2d>>& polygons) {
  std::vector<Polygon> copies;
  std::vector<std::size_t> loop_of_copy;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    for (Polygon& copy : copies_of(polygons[k], along_u_, along_v_)) {
      copies.push_back(std::move(copy));
      loop_of_copy.push_back(k);
    }
  }
  const Eigen::Vector2d lengths(length_of(along_u_), length_of(along_v_));
  if (const auto crossing = find_crossing(copies, trim_rounding_share * lengths)) {
    return Error{"trim loops " + std::to_string(loop_of_copy[crossing->first]) + " and " +
                 std::to_string(loop_of_copy[crossing->second]) + " cross each other near (" +
                 number_text(crossing->near.x()) + ", " + number_text(crossing->near.y()) +
                 "); join them into one"};
  }
  for (const Polygon& copy : copies) {
    for (std::size_t c = 0; c < copy.size(); ++c) edges_.push_back({copy[c], copy[(c + 1) % copy.size()]});
  }
  for (std::size_t columns = std::min(column_count_limit, edges_.size()); columns > 0; columns /= 2) {
    if (fill_columns(columns)) break;
  }
  return {};
}

// Beside some of its edges, on the left or right: how often each winding number was found.
std::map<int, int> TrimmedArea::windings_beside(const std::vector<Eigen::Vector2d>& polygon,
                                                double share) const {
  const Eigen::Vector2d lengths(length_of(along_u_), length_of(along_v_));
  std::map<int, int> found;
  const std::size_t step = (polygon.size() + asked_edge_count - 1) / asked_edge_count;
  for (std::size_t c = 0; c < polygon.size(); c += step) {
    const Eigen::Vector2d from = polygon[c].cwiseQuotient(lengths);
    const Eigen::Vector2d to = polygon[(c + 1) % polygon.size()].cwiseQuotient(lengths);
    const Eigen::Vector2d left = Eigen::Vector2d(from.y() - to.y(), to.x() - from.x()).normalized();
    const Eigen::Vector2d beside = (0.5 * (from + to) + share * left).cwiseProduct(lengths);
    ++found[winding(along_u_.into_domain(beside.x()), along_v_.into_domain(beside.y()))];
  }
  return found;
}

// Left of most of a loop's edges the winding number is that of what it keeps. Where loops touch, or a loop
// touches itself across the seam, it may be another by rounding.
int TrimmedArea::level_of(const std::vector<Eigen::Vector2d>& polygon) const {
  const bool outer = signed_area(polygon) > 0.0;
  const std::map<int, int> found = windings_beside(polygon, beside_share);
  auto chosen = found.begin();
  for (auto other = found.begin(); other != found.end(); ++other) {
    if (other->second > chosen->second || (other->second == chosen->second && !outer)) chosen = other;
  }
  return 1 - chosen->first;
}

Status TrimmedArea::take_level(const std::vector<std::vector<Eigen::Vector2d>>& polygons) {
  double area = 0.0;
  level_ = level_of(polygons.front());
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    if (level_of(polygons[k]) != level_) {
      return Error{"trim loop " + std::to_string(k) +
                   " does not keep what trim loop 0 keeps; let outer loops run counter-clockwise, those of "
                   "holes clockwise"};
    }
    // On the right nothing is kept, or across an edge that loops share what another keeps.
    const auto beyond = windings_beside(polygons[k], -beside_share);
    if (level_ < 0 || level_ > 1 || (!beyond.contains(-level_) && !beyond.contains(1 - level_))) {
      return Error{"trim loop " + std::to_string(k) + " lies upon another; leave one of them out"};
    }
    area += signed_area(polygons[k]);
  }
  kept_share_ = std::min(1.0, level_ + area / (length_of(along_u_) * length_of(along_v_)));
  if (!(kept_share_ > trim_rounding_share * trim_rounding_share)) {
    return Error{"the trim loops keep nothing of the surface; leave them out"};
  }
  return {};
}

bool TrimmedArea::contains(double u, double v) const {
  if (is_whole()) return true;
  return level_ + winding(inside(along_u_, u), inside(along_v_, v)) > 0;
}

std::size_t TrimmedArea::column_of(double u) const {
  const double columns = static_cast<double>(column_starts_.size() - 1);
  const double place = (u - along_u_.domain_start()) / length_of(along_u_) * columns;
  return static_cast<std::size_t>(std::clamp(place, 0.0, columns - 1.0));
}

// Counts the edges below the point, those to the right up, those to the left down: an edge spans the u of its
// lower end and not that of its upper one, so that a corner counts once.
int TrimmedArea::winding(double u, double v) const {
  int number = 0;
  const std::size_t column = column_of(u);
  for (std::size_t e = column_starts_[column]; e < column_starts_[column + 1]; ++e) {
    const Edge& edge = edges_[column_edges_[e]];
    const bool rightwards = edge.from.x() <= u && u < edge.to.x();
    const bool leftwards = edge.to.x() <= u && u < edge.from.x();
    if (!rightwards && !leftwards) continue;
    const double share = (u - edge.from.x()) / (edge.to.x() - edge.from.x());
    if (edge.from.y() + share * (edge.to.y() - edge.from.y()) <= v) number += rightwards ? 1 : -1;
  }
  return number;
}

// Refused, but for a single column, where edges lie across so many columns that listing them takes much
// memory.
bool TrimmedArea::fill_columns(std::size_t columns) {
  column_starts_.assign(columns + 1, 0);
  const auto visit = [&](const auto& take) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto [low, high] = std::minmax(edges_[e].from.x(), edges_[e].to.x());
      if (high < along_u_.domain_start() || low > along_u_.domain_end()) continue;
      for (std::size_t c = column_of(low); c <= column_of(high); ++c) take(c, e);
    }
  };
  visit([&](std::size_t c, std::size_t) { ++column_starts_[c + 1]; });
  for (std::size_t c = 0; c < columns; ++c) column_starts_[c + 1] += column_starts_[c];
  if (columns > 1 && column_starts_.back() > listed_times_limit * edges_.size()) return false;
  column_edges_.resize(column_starts_.back());
  std::vector<std::size_t> next(column_starts_.begin(), column_starts_.end() - 1);
  visit([&](std::size_t c, std::size_t e) { column_edges_[next[c]++] = e; });
  return true;
}

}  // namespace spoonbill
