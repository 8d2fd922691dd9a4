#include "engine/merging/trimmed_patch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/bspline/trim_loop.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/merging/join_row.h"

namespace spoonbill {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// A loop counts as smooth if the cosine of the angle between consecutive chords is nowhere less than this.
constexpr double smooth_cosine = 0.98;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d centroid(const Polygon& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double twice = 0.0;
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Eigen::Vector2d from = polygon[c] - polygon[0], to = polygon[(c + 1) % polygon.size()] - polygon[0];
    twice += cross(from, to);
    sum += cross(from, to) * (from + to) / 3.0;
  }
  return polygon[0] + sum / twice;
}

// Returns true if every ray from the centre meets the polygon once. `turn` is 1 for a counterclockwise
// polygon, -1 for a clockwise one.
bool is_star_about(const Polygon& polygon, const Eigen::Vector2d& centre, double turn) {
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Eigen::Vector2d &from = polygon[c], &to = polygon[(c + 1) % polygon.size()];
    if (!(turn * cross(from - centre, to - centre) > 0.0)) return false;
  }
  return true;
}

// Returns true if the closed path has no corner. The points are in space, because parameters do not show
// corners reliably.
bool is_smooth(const std::vector<Vector3>& points_m) {
  const std::size_t count = points_m.size();
  for (std::size_t c = 0; c < count; ++c) {
    const Vector3 to = (points_m[c] - points_m[(c + count - 1) % count]).stableNormalized();
    if (to.dot((points_m[(c + 1) % count] - points_m[c]).stableNormalized()) < smooth_cosine) return false;
  }
  return true;
}

std::vector<Vector3> evaluate_positions(const Surface& surface, const Polygon& polygon) {
  std::vector<Vector3> points_m;
  points_m.reserve(polygon.size());
  for (const Eigen::Vector2d& at : polygon) points_m.push_back(position(surface, at.x(), at.y()));
  return points_m;
}

// A closed polygon in the parameter plane, as a function of the fraction of its length. Lengths are measured
// in space.
class RoundEdge {
 public:
  RoundEdge(Polygon polygon, const std::vector<Vector3>& points_m) : polygon_(std::move(polygon)) {
    double length_m = 0.0;
    for (std::size_t c = 0; c < polygon_.size(); ++c) {
      ends_.push_back(length_m += (points_m[(c + 1) % points_m.size()] - points_m[c]).norm());
    }
    for (double& end : ends_) end /= length_m;
  }

  Eigen::Vector2d at(double fraction) const {
    const double within = fraction - std::floor(fraction);
    const auto chord = std::min(
        static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), within) - ends_.begin()),
        ends_.size() - 1);
    const double start = chord == 0 ? 0.0 : ends_[chord - 1];
    const double along = (within - start) / (ends_[chord] - start);
    return polygon_[chord] + along * (polygon_[(chord + 1) % polygon_.size()] - polygon_[chord]);
  }

 private:
  Polygon polygon_;
  std::vector<double> ends_;  // fractions at the ends of the chords
};

// Returns where the ray from the centre through `to` meets the edge of a hole. The hole must be star-shaped
// about the centre.
Eigen::Vector2d project_to_hole(const Polygon& hole, const Eigen::Vector2d& centre,
                                const Eigen::Vector2d& to) {
  const Eigen::Vector2d offset = to - centre;
  for (std::size_t c = 0; c < hole.size(); ++c) {
    const Eigen::Vector2d from = hole[(c + 1) % hole.size()] - centre, next = hole[c] - centre;
    if (cross(from, offset) < 0.0 || cross(offset, next) < 0.0) continue;
    return centre + offset * (cross(from, next - from) / cross(offset, next - from));
  }
  return centre;
}

}  // namespace

std::optional<Result<FittedShape>> resample_round_part(const Surface& surface,
                                                       const std::vector<Polygon>& polygons,
                                                       double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m > 0.0);
  if (polygons.empty() || polygons.size() > 2) return std::nullopt;
  const bool first_is_outer = signed_area(polygons.front()) > 0.0;
  const Polygon& outer = first_is_outer ? polygons.front() : polygons.back();
  const Polygon* hole = polygons.size() == 1 ? nullptr
                        : first_is_outer     ? &polygons.back()
                                             : &polygons.front();
  const Eigen::Vector2d centre = centroid(hole ? *hole : outer);
  const std::vector<Vector3> outer_m = evaluate_positions(surface, outer);
  if (!is_star_about(outer, centre, 1.0) || !is_smooth(outer_m)) return std::nullopt;
  if (hole && (!is_star_about(*hole, centre, -1.0) || !is_smooth(evaluate_positions(surface, *hole)))) {
    return std::nullopt;
  }

  const RoundEdge edge(outer, outer_m);
  // Cache of lines, because a fit evaluates the same lines repeatedly.
  std::map<double, std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;
  ExactShape shape;
  shape.u = {true, {0.0, 1.0}};
  shape.v = {false, {0.0, 1.0}};
  shape.pole_at_end = hole == nullptr;
  shape.at = [&](double u, double v) {
    auto known = lines.find(u);
    if (known == lines.end()) {
      const Eigen::Vector2d start = edge.at(u);
      known = lines.emplace(u, std::pair(start, hole ? project_to_hole(*hole, centre, start) : centre)).first;
    }
    const Eigen::Vector2d at = known->second.first + v * (known->second.second - known->second.first);
    return position(surface, at.x(), at.y());
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.min_spans = 4;
  fit.keeps_parameters = true;
  return fit_shape(shape, fit);
}

namespace {

using Edge = TrimmedArea::Edge;
// Loops in the parameter plane, with the kept part on their left.
using Polygons = std::vector<std::vector<Eigen::Vector2d>>;

// A point of a trim counts as a corner if the cosine of the angle between its two chords is less than this.
constexpr double corner_cosine = 0.98;
// Distance of the outermost lines from the part's edge, as a fraction of the part's extent in u. Anything
// narrower than this is ignored.
constexpr double edge_margin = 1e-7;

constexpr int trim_lines_checked = 64;
// Fraction of the longest line's length. A shorter line at an end of the part counts as a point.
constexpr double point_fraction = 1e-3;
// Largest change of a line's ends across a corner that does not count as a jump, relative to the part's
// extent in v.
constexpr double jump_fraction = 1e-3;

struct Interval {
  double low, high;

  double length() const { return high - low; }
};

Interval extent(const Polygons& polygons, int axis) {
  Interval extent{polygons[0][0][axis], polygons[0][0][axis]};
  for (const auto& polygon : polygons) {
    for (const Eigen::Vector2d& corner : polygon) {
      extent = {std::min(extent.low, corner[axis]), std::max(extent.high, corner[axis])};
    }
  }
  return extent;
}

double inside(const Interval& extent, double u) {
  const double margin = edge_margin * extent.length();
  return std::clamp(u, extent.low + margin, extent.high - margin);
}

class KeptPart {
 public:
  explicit KeptPart(Polygons polygons)
      : polygons_(std::move(polygons)), along_u_(extent(polygons_, 0)), along_v_(extent(polygons_, 1)) {
    for (const auto& polygon : polygons_) {
      for (std::size_t c = 0; c < polygon.size(); ++c) {
        edges_.push_back({polygon[c], polygon[(c + 1) % polygon.size()]});
      }
    }
  }

  const Interval& along_u() const { return along_u_; }

  // Returns the interval of a line of constant u that is inside the part; nothing if the line is inside in
  // several intervals or not at all.
  std::optional<Interval> on_line(double u) const {
    std::optional<double> enters, leaves;
    for (const auto& [from, to] : edges_) {
      const bool rightwards = from.x() <= u && u < to.x(), leftwards = to.x() <= u && u < from.x();
      if (!rightwards && !leftwards) continue;
      std::optional<double>& crossing = rightwards ? enters : leaves;
      if (crossing) return std::nullopt;
      crossing = from.y() + (to.y() - from.y()) * (u - from.x()) / (to.x() - from.x());
    }
    if (!enters || !leaves || !(*enters <= *leaves)) return std::nullopt;
    return Interval{*enters, *leaves};
  }

  bool is_cut_in_single_pieces() const {
    if (!meets_all_lines_twice()) return false;
    double longest = 0.0, first = 0.0, last = 0.0;
    for (int k = 0; k <= trim_lines_checked; ++k) {
      const auto interval =
          on_line(inside(along_u_, along_u_.low + along_u_.length() * k / trim_lines_checked));
      if (!interval) return false;
      last = interval->length();
      if (k == 0) first = last;
      longest = std::max(longest, last);
    }
    return first > point_fraction * longest && last > point_fraction * longest && changes_steadily();
  }

  // Returns the parameters u of the part's ends and of the corners of the loops. There, the ends of the
  // lines, as functions of u, have kinks.
  std::vector<double> breaks_in_u() const {
    std::vector<double> breaks{along_u_.low, along_u_.high};
    const Eigen::Vector2d lengths(along_u_.length(), along_v_.length());
    for (const auto& polygon : polygons_) {
      const std::size_t count = polygon.size();
      for (std::size_t c = 0; c < count; ++c) {
        const Eigen::Vector2d &at = polygon[c], &before = polygon[(c + count - 1) % count],
                              &after = polygon[(c + 1) % count];
        const Eigen::Vector2d to = (at - before).cwiseQuotient(lengths).normalized();
        if (to.dot((after - at).cwiseQuotient(lengths).normalized()) < corner_cosine) {
          breaks.push_back(at.x());
        }
      }
    }
    std::sort(breaks.begin(), breaks.end());
    const double near = 1e-6 * along_u_.length();
    const auto same = [&](double a, double b) { return b - a <= near; };
    breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
    breaks.back() = along_u_.high;
    return breaks;
  }

 private:
  // Returns true if the ends of the lines change continuously at every corner of the loops. They jump where
  // an edge of the part runs along a line of constant u.
  bool changes_steadily() const {
    const double beside = 2.0 * edge_margin * along_u_.length();
    for (const double at : breaks_in_u()) {
      if (at == along_u_.low || at == along_u_.high) continue;
      const auto before = on_line(at - beside), after = on_line(at + beside);
      if (!before || !after) return false;
      const double jump = std::max(std::abs(before->low - after->low), std::abs(before->high - after->high));
      if (jump > jump_fraction * along_v_.length()) return false;
    }
    return true;
  }

  // Returns true if each line of constant u meets exactly two edges. The edges are counted in each interval
  // between consecutive corners, so that no line is missed.
  bool meets_all_lines_twice() const {
    // A parameter u, and the change of the number of edges there.
    std::vector<std::pair<double, int>> changes;
    for (const auto& [from, to] : edges_) {
      changes.emplace_back(std::min(from.x(), to.x()), 1);
      changes.emplace_back(std::max(from.x(), to.x()), -1);
    }
    std::sort(changes.begin(), changes.end());
    const double margin = edge_margin * along_u_.length();
    int met = 0;
    for (std::size_t k = 0; k + 1 < changes.size(); ++k) {
      met += changes[k].second;
      const double start = std::max(changes[k].first, along_u_.low + margin);
      const double end = std::min(changes[k + 1].first, along_u_.high - margin);
      if (met != 2 && end - start > margin) return false;
    }
    return true;
  }

  Polygons polygons_;
  std::vector<Edge> edges_;
  Interval along_u_, along_v_;
};

Error no_single_pieces() {
  return Error(
      ErrorCode::unsupported,
      "some lines of constant u, and some of constant v, meet its part within the trims in several pieces or "
      "not at all, and the part is no disc or ring with smooth edges; fill its holes, and cut it off where "
      "it ends in a point");
}

Result<FittedShape> resample_piece(const Surface& surface, const KeptPart& part, const Interval& piece,
                                   double tolerance_m) {
  bool missed = false;
  // Cache of intervals, because a fit evaluates the same lines repeatedly.
  std::map<double, std::optional<Interval>> lines;
  ExactShape shape;
  shape.u = {false, {piece.low, piece.high}};
  shape.v = {false, {0.0, 1.0}};
  shape.at = [&](double u, double fraction) {
    auto known = lines.find(u);
    if (known == lines.end()) known = lines.emplace(u, part.on_line(inside(piece, u))).first;
    const std::optional<Interval>& interval = known->second;
    missed = missed || !interval;
    return interval ? position(surface, u, interval->low + fraction * interval->length())
                    : position(surface, u, fraction);
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.min_spans = 4;
  fit.keeps_parameters = true;
  auto fitted = fit_shape(shape, fit);
  if (missed) return no_single_pieces();
  return fitted;
}

// Fraction of the tolerance that is used for resampling the pieces; joining them uses the rest.
constexpr double piece_fraction = 0.3;
// Largest number of pieces. A piece has at least six control points and a patch at most 200.
constexpr std::size_t most_pieces = 33;

// Divides the part at the corners of the trims, at which the ends of the lines have kinks. Resamples each
// piece, then joins the pieces.
Result<FittedShape> resample(const Surface& surface, const KeptPart& part, double tolerance_m) {
  const std::vector<double> breaks = part.breaks_in_u();
  if (breaks.size() > most_pieces + 1) {
    return Error(ErrorCode::too_many, "its trims have corners on " + std::to_string(breaks.size() - 2) +
                                          " lines, too many for one patch; simplify them");
  }
  std::vector<Surface> pieces;
  double deviation_m = 0.0;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    auto piece = resample_piece(surface, part, {breaks[k], breaks[k + 1]}, piece_fraction * tolerance_m);
    if (!piece) return piece.error();
    deviation_m = std::max(deviation_m, piece->deviation_m);
    pieces.push_back(exchanged(piece->surface));
  }
  if (pieces.size() == 1) return FittedShape{exchanged(pieces[0]), deviation_m};
  JoinRequest request;
  request.continuity = 0;
  request.tolerance_m = tolerance_m - deviation_m;
  auto whole = join_row(std::move(pieces), request);
  if (!whole) return whole.error();
  return FittedShape{exchanged(whole->surface), deviation_m + whole->deviation_m};
}

// Exchanges u and v of the loops and reverses them, so that the kept part stays on their left.
Polygons exchange_polygons(const Polygons& polygons) {
  Polygons result;
  for (const auto& polygon : polygons) {
    auto& exchanged = result.emplace_back();
    for (auto corner = polygon.rbegin(); corner != polygon.rend(); ++corner) {
      exchanged.emplace_back(corner->y(), corner->x());
    }
  }
  return result;
}

double enclosed(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0.0;
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Eigen::Vector2d &from = polygon[c], &to = polygon[(c + 1) % polygon.size()];
    twice += from.x() * to.y() - from.y() * to.x();
  }
  return 0.5 * twice;
}

bool is_rectangle(const Polygons& polygons) {
  if (polygons.size() != 1) return false;
  const double whole = extent(polygons, 0).length() * extent(polygons, 1).length();
  constexpr double rounding = 1e-12;
  return std::abs(enclosed(polygons[0]) - whole) <= rounding * whole;
}

// Cuts the part out exactly if the loops form a rectangle in u and v.
Result<FittedShape> cut_rectangle(const Surface& surface, const Polygons& polygons) {
  const Interval u = extent(polygons, 0), v = extent(polygons, 1);
  const auto strip = part_of(surface, Direction::u, u.low, u.high);
  if (!strip) return strip.error();
  auto part = part_of(strip.value(), Direction::v, v.low, v.high);
  if (!part) return part.error();
  return FittedShape{std::move(part).value(), 0.0};
}

}  // namespace

Result<FittedShape> untrimmed(const Surface& surface, const std::vector<TrimLoop>& trims,
                              double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m > 0.0);
  const auto area = TrimmedArea::make(surface.u, surface.v, trims);
  if (!area) return area.error();
  if (area->is_whole()) return FittedShape{surface, 0.0};
  Polygons polygons;
  for (const TrimLoop& loop : trims) polygons.push_back(to_polygon(loop, surface.u, surface.v));
  if (is_rectangle(polygons)) return cut_rectangle(surface, polygons);
  const KeptPart part(polygons);
  if (part.is_cut_in_single_pieces()) return resample(surface, part, tolerance_m);
  const KeptPart exchanged_part(exchange_polygons(polygons));
  if (!exchanged_part.is_cut_in_single_pieces()) {
    auto round = resample_round_part(surface, polygons, tolerance_m);
    return round ? std::move(*round) : no_single_pieces();
  }
  auto result = resample(exchanged(surface), exchanged_part, tolerance_m);
  if (result) result->surface = exchanged(result->surface);
  return result;
}

}  // namespace spoonbill
