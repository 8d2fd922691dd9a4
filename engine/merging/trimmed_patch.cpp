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
#include "engine/bspline/trimmed_area.h"
#include "engine/merging/join_row.h"
#include "engine/merging/round_part.h"

namespace spoonbill {

namespace {

using Edge = TrimmedArea::Edge;
// What is kept lies to their left.
using Polygons = std::vector<std::vector<Eigen::Vector2d>>;

// A corner between chords; smooth trims turn less from chord to chord.
constexpr double corner_cosine = 0.98;
// Of the part's extent in u: where its last line is taken, beside an edge of constant u, and what is too
// narrow to count.
constexpr double beside_edge = 1e-7;
constexpr int lines_looked_at = 64;
// Of the longest line: shorter ones at an end are a point.
constexpr double point_share = 1e-3;
// Of the part's extent in v: what lines change at most from beside a corner to behind it.
constexpr double jump_share = 1e-3;

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
  const double margin = beside_edge * extent.length();
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

  // Where a line of constant u meets the part; none where that is not one piece.
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
    for (int k = 0; k <= lines_looked_at; ++k) {
      const auto kept = on_line(inside(along_u_, along_u_.low + along_u_.length() * k / lines_looked_at));
      if (!kept) return false;
      last = kept->length();
      if (k == 0) first = last;
      longest = std::max(longest, last);
    }
    return first > point_share * longest && last > point_share * longest && changes_steadily();
  }

  // The ends and the corners of the loops, where lines change their ends with a kink.
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
  // Whether no line is longer or elsewhere by a jump than the one beside it, as at a step.
  bool changes_steadily() const {
    const double beside = 2.0 * beside_edge * along_u_.length();
    for (const double at : breaks_in_u()) {
      if (at == along_u_.low || at == along_u_.high) continue;
      const auto before = on_line(at - beside), after = on_line(at + beside);
      if (!before || !after) return false;
      const double jump = std::max(std::abs(before->low - after->low), std::abs(before->high - after->high));
      if (jump > jump_share * along_v_.length()) return false;
    }
    return true;
  }

  // Counted from one end of an edge to the next, so that nothing is missed between two lines looked at.
  bool meets_all_lines_twice() const {
    std::vector<std::pair<double, int>> changes;  // of how many edges a line meets
    for (const auto& [from, to] : edges_) {
      changes.emplace_back(std::min(from.x(), to.x()), 1);
      changes.emplace_back(std::max(from.x(), to.x()), -1);
    }
    std::sort(changes.begin(), changes.end());
    const double margin = beside_edge * along_u_.length();
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
  return Error{
      "its trims leave no part that lines of constant u, or of constant v, cross in one piece each, and no "
      "disc "
      "or ring with smooth edges; fill its holes, and cut it off where it ends in a point"};
}

Result<FittedShape> resampled_between(const Surface& surface, const KeptPart& part, const Interval& piece,
                                      double tolerance_m) {
  bool missed = false;
  // A fit asks for the same lines again.
  std::map<double, std::optional<Interval>> lines;
  ExactShape shape;
  shape.u = {false, {piece.low, piece.high}};
  shape.v = {false, {0.0, 1.0}};
  shape.at = [&](double u, double share) {
    auto known = lines.find(u);
    if (known == lines.end()) known = lines.emplace(u, part.on_line(inside(piece, u))).first;
    const std::optional<Interval>& kept = known->second;
    missed = missed || !kept;
    return kept ? position(surface, u, kept->low + share * kept->length()) : position(surface, u, share);
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.min_spans = 4;
  fit.keeps_parameters = true;
  auto fitted = fit_shape(shape, fit);
  if (missed) return no_single_pieces();
  return fitted;
}

// Of the tolerance, for resampling; joining the pieces takes the rest.
constexpr double piece_share = 0.3;
// Of six control points at least, of which one patch has 200.
constexpr std::size_t most_pieces = 33;

// Piece by piece between the corners, where the lines' ends have a kink, and the pieces edge to edge.
Result<FittedShape> resampled(const Surface& surface, const KeptPart& part, double tolerance_m) {
  const std::vector<double> breaks = part.breaks_in_u();
  if (breaks.size() > most_pieces + 1) {
    return Error{"its trims have corners on " + std::to_string(breaks.size() - 2) +
                 " lines, more than one patch can hold; simplify them"};
  }
  std::vector<Surface> pieces;
  double deviation_m = 0.0;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    auto piece = resampled_between(surface, part, {breaks[k], breaks[k + 1]}, piece_share * tolerance_m);
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

// Run through backwards, so that what is kept stays on the left.
Polygons exchanged_polygons(const Polygons& polygons) {
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

// Where lines of constant u and v bound what is kept it is a part of the patch, exactly.
Result<FittedShape> rectangle_of(const Surface& surface, const Polygons& polygons) {
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
  if (is_rectangle(polygons)) return rectangle_of(surface, polygons);
  const KeptPart part(polygons);
  if (part.is_cut_in_single_pieces()) return resampled(surface, part, tolerance_m);
  const KeptPart turned(exchanged_polygons(polygons));
  if (!turned.is_cut_in_single_pieces()) {
    auto round = round_part(surface, polygons, tolerance_m);
    return round ? std::move(*round) : no_single_pieces();
  }
  auto result = resampled(exchanged(surface), turned, tolerance_m);
  if (result) result->surface = exchanged(result->surface);
  return result;
}

}  // namespace spoonbill
