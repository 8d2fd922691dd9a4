#include "engine/merging/trimmed_patch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/merging/join_row.h"

namespace spoonbill {

namespace {

using Edges = std::vector<TrimmedArea::Edge>;

// A corner between chords; smooth trims turn less from chord to chord.
constexpr double corner_cosine = 0.98;
// Of the part's extent in u: where its last line is taken, beside an edge of constant u.
constexpr double beside_edge = 1e-7;
constexpr int lines_looked_at = 64;
// Of the longest line: shorter ones at an end are a point.
constexpr double point_share = 1e-3;

struct Interval {
  double low, high;
};

// Where a line of constant u meets the kept part; none where that is not one piece.
std::optional<Interval> kept_on_line(const Edges& edges, double u) {
  std::vector<double> crossings;
  for (const auto& [from, to] : edges) {
    if ((from.x() <= u) == (to.x() <= u)) continue;
    crossings.push_back(from.y() + (to.y() - from.y()) * (u - from.x()) / (to.x() - from.x()));
  }
  if (crossings.size() != 2) return std::nullopt;
  return Interval{std::min(crossings[0], crossings[1]), std::max(crossings[0], crossings[1])};
}

Interval extent_in_u(const Edges& edges) {
  Interval extent{edges[0].from.x(), edges[0].from.x()};
  for (const auto& edge : edges) {
    extent = {std::min(extent.low, edge.from.x()), std::max(extent.high, edge.from.x())};
  }
  return extent;
}

double inside(const Interval& extent, double u) {
  const double margin = beside_edge * (extent.high - extent.low);
  return std::clamp(u, extent.low + margin, extent.high - margin);
}

bool is_cut_in_single_pieces(const Edges& edges, const Interval& extent) {
  double longest = 0.0, first = 0.0, last = 0.0;
  for (int k = 0; k <= lines_looked_at; ++k) {
    const double u = extent.low + (extent.high - extent.low) * k / lines_looked_at;
    const auto kept = kept_on_line(edges, inside(extent, u));
    if (!kept) return false;
    last = kept->high - kept->low;
    if (k == 0) first = last;
    longest = std::max(longest, last);
  }
  return first > point_share * longest && last > point_share * longest;
}

// The ends and the corners of the loops, where lines change their ends with a kink.
std::vector<double> breaks_in_u(const Edges& edges, const Interval& extent) {
  std::vector<double> breaks{extent.low, extent.high};
  for (std::size_t k = 0; k < edges.size(); ++k) {
    for (const auto& next : edges) {
      if (next.from != edges[k].to) continue;
      const Eigen::Vector2d along = (edges[k].to - edges[k].from).normalized();
      if (along.dot((next.to - next.from).normalized()) < corner_cosine) breaks.push_back(next.from.x());
    }
  }
  std::sort(breaks.begin(), breaks.end());
  const double near = 1e-6 * (extent.high - extent.low);
  const auto same = [&](double a, double b) { return b - a <= near; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  breaks.back() = extent.high;
  return breaks;
}

Result<FittedShape> resampled_between(const Surface& surface, const Edges& edges, double low, double high,
                                      double tolerance_m) {
  const Interval piece{low, high};
  ExactShape shape;
  shape.u = {false, {low, high}};
  shape.v = {false, {0.0, 1.0}};
  shape.at = [&](double u, double share) {
    const Interval kept = kept_on_line(edges, inside(piece, u)).value_or(Interval{0.0, 0.0});
    return position(surface, u, kept.low + share * (kept.high - kept.low));
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.least_spans = 4;
  fit.keeps_parameters = true;
  return fit_shape(shape, fit);
}

// Piece by piece between the corners, where the lines' ends have a kink, and the pieces edge to edge.
Result<FittedShape> resampled(const Surface& surface, const Edges& edges, double tolerance_m) {
  const std::vector<double> breaks = breaks_in_u(edges, extent_in_u(edges));
  std::vector<Surface> pieces;
  double deviation_m = 0.0;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    auto piece = resampled_between(surface, edges, breaks[k], breaks[k + 1], 0.5 * tolerance_m);
    if (!piece) return piece.error();
    deviation_m = std::max(deviation_m, piece->deviation_m);
    pieces.push_back(exchanged(piece->surface));
  }
  if (pieces.size() == 1) return FittedShape{exchanged(pieces[0]), deviation_m};
  JoinRequest request;
  request.continuity = 0;
  request.tolerance_m = tolerance_m;
  auto whole = join_row(std::move(pieces), request);
  if (!whole) return whole.error();
  return FittedShape{exchanged(whole->surface), deviation_m + whole->deviation_m};
}

Edges exchanged_edges(const Edges& edges) {
  Edges result;
  for (const auto& edge : edges) result.push_back({edge.from.reverse(), edge.to.reverse()});
  return result;
}

}  // namespace

Result<FittedShape> untrimmed(const Surface& surface, const std::vector<TrimLoop>& trims,
                              double tolerance_m) {
  const auto area = TrimmedArea::make(surface.u, surface.v, trims);
  if (!area) return area.error();
  if (area->is_whole()) return FittedShape{surface, 0.0};
  const Edges& edges = area->edges();
  if (is_cut_in_single_pieces(edges, extent_in_u(edges))) return resampled(surface, edges, tolerance_m);
  const Edges turned = exchanged_edges(edges);
  if (is_cut_in_single_pieces(turned, extent_in_u(turned))) {
    auto result = resampled(exchanged(surface), turned, tolerance_m);
    if (result) result->surface = exchanged(result->surface);
    return result;
  }
  return Error{
      "its trims leave no part whose lines of constant u or v are each in one piece; fill its holes, or "
      "split it at them"};
}

}  // namespace spoonbill
