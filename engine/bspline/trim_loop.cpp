#include "engine/bspline/trim_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

namespace {

struct PolygonEdge {
  Eigen::Vector2d from, to;
  std::size_t polygon = 0;

  double low_x() const { return std::min(from.x(), to.x()); }
  double high_x() const { return std::max(from.x(), to.x()); }
  double low_y() const { return std::min(from.y(), to.y()); }
  double high_y() const { return std::max(from.y(), to.y()); }
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Returns the edges of all polygons, sorted by their lowest x. Coordinates are in units of the tolerance, so
// that a point touches an edge if it is at most 1 away.
std::vector<PolygonEdge> sorted_edges(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                      const Eigen::Vector2d& tolerance) {
  std::vector<PolygonEdge> edges;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const auto& corners = polygons[p];
    for (std::size_t c = 0; c < corners.size(); ++c) {
      edges.push_back({corners[c].cwiseQuotient(tolerance),
                       corners[(c + 1) % corners.size()].cwiseQuotient(tolerance), p});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const PolygonEdge& a, const PolygonEdge& b) { return a.low_x() < b.low_x(); });
  return edges;
}

bool touches(const Eigen::Vector2d& point, const PolygonEdge& edge) {
  const Eigen::Vector2d along = edge.to - edge.from;
  const double length2 = along.squaredNorm();
  const double fraction =
      length2 > 0.0 ? std::clamp((point - edge.from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (edge.from + fraction * along - point).squaredNorm() <= 1.0;
}

bool cross_each_other(const PolygonEdge& a, const PolygonEdge& b) {
  const Eigen::Vector2d along_a = a.to - a.from, along_b = b.to - b.from;
  const auto sides_differ = [](double one, double other) { return (one > 0.0) != (other > 0.0); };
  if (!sides_differ(cross(along_a, b.from - a.from), cross(along_a, b.to - a.from))) return false;
  if (!sides_differ(cross(along_b, a.from - b.from), cross(along_b, a.to - b.from))) return false;
  return !touches(a.from, b) && !touches(a.to, b) && !touches(b.from, a) && !touches(b.to, a);
}

}  // namespace

std::optional<PolygonCrossing> find_crossing(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                             const Eigen::Vector2d& tolerance) {
  SPOONBILL_ASSERT(tolerance.x() > 0.0 && tolerance.y() > 0.0);
  const std::vector<PolygonEdge> edges = sorted_edges(polygons, tolerance);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double high_x = edges[i].high_x(), low_y = edges[i].low_y(), high_y = edges[i].high_y();
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low_x() <= high_x; ++j) {
      if (edges[j].low_y() > high_y || edges[j].high_y() < low_y) continue;
      if (!cross_each_other(edges[i], edges[j])) continue;
      const auto [first, second] = std::minmax(edges[i].polygon, edges[j].polygon);
      // The crossing is at most half the length of either edge away from the midpoint of that edge. The
      // shorter edge therefore gives the better estimate.
      const PolygonEdge& shorter =
          (edges[i].to - edges[i].from).norm() < (edges[j].to - edges[j].from).norm() ? edges[i] : edges[j];
      return PolygonCrossing{first, second, (0.5 * (shorter.from + shorter.to)).cwiseProduct(tolerance)};
    }
  }
  return std::nullopt;
}

namespace {

// Largest number of chords for one polynomial piece of a curve. A piece of degree max_degree whose control
// points span three domains needs fewer. Only curves with control points even farther away would need more.
constexpr double largest_piece_chord_count = 8000.0;

std::string point_text(const Eigen::Vector2d& point) {
  return "(" + number_text(point.x()) + ", " + number_text(point.y()) + ")";
}

Status check_coordinates(const KnotVector& knots, const std::vector<double>& values, char coordinate) {
  if (values.size() != static_cast<std::size_t>(knots.control_point_count())) {
    return Error{ErrorCode::mismatch, "a trim loop's knots require " +
                                          std::to_string(knots.control_point_count()) +
                                          " control points, but it has " + std::to_string(values.size()) +
                                          "; change the knots or the points"};
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    return Error{ErrorCode::out_of_range, std::string("a trim loop's control point ") + std::to_string(i) +
                                              " has no finite " + coordinate + " (" + number_text(values[i]) +
                                              "); replace it"};
  }
  return {};
}

Status check_closed(const TrimLoop& loop, const KnotVector& along_u, const KnotVector& along_v) {
  if (loop.knots.is_periodic()) return {};
  const Eigen::Vector2d start = position(loop, loop.knots.domain_start());
  const Eigen::Vector2d end = position(loop, loop.knots.domain_end());
  const Eigen::Vector2d gap = end - start;
  const double fraction_u = std::abs(gap.x()) / along_u.domain_length();
  const double fraction_v = std::abs(gap.y()) / along_v.domain_length();
  if (fraction_u <= trim_rounding_fraction && fraction_v <= trim_rounding_fraction) return {};
  const std::string what =
      "a trim loop starts at " + point_text(start) + " and ends at " + point_text(end) + ", ";
  const auto goes_around = [](const KnotVector& knots, double fraction) {
    return knots.is_periodic() && std::abs(fraction - 1.0) <= trim_rounding_fraction;
  };
  if (goes_around(along_u, fraction_u) || goes_around(along_v, fraction_v)) {
    return Error{ErrorCode::unsupported, what + "one period further; lead it back along the seam"};
  }
  return Error{ErrorCode::mismatch, what + "which is not closed; let it end where it starts"};
}

Status check_within(const std::vector<double>& values, const KnotVector& knots, const char* name) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double length = knots.domain_length(), slack = trim_rounding_fraction * length;
  const double beyond = knots.is_periodic() ? length : 0.0;
  if (!(*low >= knots.domain_start() - beyond - slack) || !(*high <= knots.domain_end() + beyond + slack)) {
    return Error{ErrorCode::out_of_range, std::string("a trim loop runs from ") + name + " = " +
                                              number_text(*low) + " to " + number_text(*high) +
                                              ", outside the surface's domain of " +
                                              number_text(knots.domain_start()) + " to " +
                                              number_text(knots.domain_end()) + "; bring it inside"};
  }
  if (knots.is_periodic() && *high - *low > length + slack) {
    return Error{ErrorCode::out_of_range, std::string("a trim loop is longer than one period in ") + name +
                                              ", from " + number_text(*low) + " to " + number_text(*high) +
                                              "; shorten it"};
  }
  return {};
}

// Returns a bound of the second derivative of a loop in one knot span. Coordinates are fractions of the
// surface's domain, whose lengths are `lengths`.
double second_derivative_bound(const TrimLoop& loop, int span, const Eigen::Vector2d& lengths) {
  const int degree = loop.knots.degree();
  if (degree < 2) return 0.0;
  const std::vector<double>& knots = loop.knots.extended_knots();
  std::array<Eigen::Vector2d, max_degree + 1> points;
  for (int j = 0; j <= degree; ++j) {
    const int index = loop.knots.control_index(span, j);
    points[j] = Eigen::Vector2d(loop.u[index], loop.v[index]).cwiseQuotient(lengths);
  }
  for (int derivative = 1; derivative <= 2; ++derivative) {
    const int order = degree - derivative + 1;
    for (int j = 0; j < order; ++j) {
      const int first = span - order + 1 + j;
      points[j] = (points[j + 1] - points[j]) * (order / (knots[first + order] - knots[first]));
    }
  }
  double largest = 0.0;
  for (int j = 0; j <= degree - 2; ++j) largest = std::max(largest, points[j].norm());
  return largest;
}

// The evenly spaced chords that replace one polynomial piece of a loop: their number and error.
struct PieceChords {
  int count = 1;
  double error_fraction = 0.0;  // largest distance of a chord from the curve, as a fraction of the domain
};

PieceChords count_chords(const TrimLoop& loop, double start, double length, const Eigen::Vector2d& lengths) {
  const double bound = second_derivative_bound(loop, loop.knots.find_span(start), lengths);
  const double wanted = std::ceil(length * std::sqrt(bound / (8.0 * trim_chord_fraction)));
  const int count = wanted > 1.0 ? static_cast<int>(std::min(wanted, largest_piece_chord_count)) : 1;
  return {count, bound * length * length / (8.0 * count * count)};
}

// Returns the curve's points at the ends of the chords. These points may be outside the surface's domain.
// Returns nullopt if there are more chords than trim_chord_count_limit.
std::optional<std::vector<Eigen::Vector2d>> sample_corners(const TrimLoop& loop,
                                                           const Eigen::Vector2d& lengths) {
  std::vector<Eigen::Vector2d> corners;
  const std::vector<double> ends = loop.knots.breakpoints();
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double length = ends[piece + 1] - ends[piece];
    const int chords = count_chords(loop, ends[piece], length, lengths).count;
    if (corners.size() + static_cast<std::size_t>(chords) > trim_chord_count_limit) return std::nullopt;
    for (int c = 0; c < chords; ++c) corners.push_back(position(loop, ends[piece] + length * c / chords));
  }
  return corners;
}

double within(const KnotVector& knots, double parameter) {
  return knots.is_periodic() ? parameter : knots.into_domain(parameter);
}

std::vector<double>& along(TrimLoop& loop, Direction direction) {
  return direction == Direction::u ? loop.u : loop.v;
}

bool has_matching_net(const TrimLoop& loop) {
  const auto count = static_cast<std::size_t>(loop.knots.control_point_count());
  return count > 0 && loop.u.size() == count && loop.v.size() == count;
}

TrimLoop reverse_curve(TrimLoop loop) {
  // The index of a periodic basis function is that of the knot at which its support starts. Its mirror image
  // starts where the support ends, degree + 1 knots further.
  const int count = loop.knots.control_point_count();
  const int first = loop.knots.is_periodic() ? 2 * count - 1 - loop.knots.degree() % count : count - 1;
  const TrimLoop forwards = loop;
  for (int i = 0; i < count; ++i) {
    const int from = (first - i) % count;
    loop.u[i] = forwards.u[from];
    loop.v[i] = forwards.v[from];
  }
  loop.knots = reversed(forwards.knots);
  return loop;
}

}  // namespace

Result<TrimLoop> make_trim_loop(const KnotVector& along_u, const KnotVector& along_v, KnotVector knots,
                                std::vector<double> u, std::vector<double> v) {
  if (Status count = check_range("a trim loop's number of control points", knots.control_point_count(),
                                 trim_control_point_count_range);
      !count) {
    return count.error();
  }
  if (Status status = check_coordinates(knots, u, 'u'); !status) return status.error();
  if (Status status = check_coordinates(knots, v, 'v'); !status) return status.error();
  TrimLoop loop{std::move(knots), std::move(u), std::move(v)};
  if (Status status = check_closed(loop, along_u, along_v); !status) return status.error();
  const Eigen::Vector2d lengths(along_u.domain_length(), along_v.domain_length());
  const auto corners = sample_corners(loop, lengths);
  if (!corners) {
    return Error{ErrorCode::too_many,
                 "a trim loop near " + point_text(position(loop, loop.knots.domain_start())) +
                     " needs more than " + std::to_string(trim_chord_count_limit) + " chords; simplify it"};
  }
  std::vector<double> corners_u, corners_v;
  for (const Eigen::Vector2d& corner : *corners) {
    corners_u.push_back(corner.x());
    corners_v.push_back(corner.y());
  }
  if (Status status = check_within(corners_u, along_u, "u"); !status) return status.error();
  if (Status status = check_within(corners_v, along_v, "v"); !status) return status.error();
  const std::vector<Eigen::Vector2d> polygon = to_polygon(loop, along_u, along_v);
  const double fraction = std::abs(signed_area(polygon)) / lengths.prod();
  if (polygon.size() < 3 || !(fraction > trim_rounding_fraction * trim_rounding_fraction)) {
    return Error{ErrorCode::degenerate, "a trim loop near " +
                                            point_text(position(loop, loop.knots.domain_start())) +
                                            " encloses nothing; omit it"};
  }
  if (const auto crossing = find_crossing({polygon}, trim_rounding_fraction * lengths)) {
    return Error{
        ErrorCode::self_intersecting,
        "a trim loop crosses itself near " + point_text(crossing->near) + "; split it into separate loops"};
  }
  return loop;
}

Eigen::Vector2d position(const TrimLoop& loop, double parameter) {
  SPOONBILL_ASSERT_DEBUG(has_matching_net(loop));
  const BasisFunctions basis = basis_functions(loop.knots, loop.knots.into_domain(parameter));
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  for (int j = 0; j <= loop.knots.degree(); ++j) {
    const int index = loop.knots.control_index(basis.span, j);
    point += basis.values[0][j] * Eigen::Vector2d(loop.u[index], loop.v[index]);
  }
  return point;
}

std::vector<Eigen::Vector2d> to_polygon(const TrimLoop& loop, const KnotVector& along_u,
                                        const KnotVector& along_v) {
  SPOONBILL_ASSERT(has_matching_net(loop));
  const Eigen::Vector2d lengths(along_u.domain_length(), along_v.domain_length());
  std::vector<Eigen::Vector2d> polygon;
  const auto corners = sample_corners(loop, lengths);
  if (!corners) return polygon;
  for (const Eigen::Vector2d& corner : *corners) {
    const Eigen::Vector2d clamped(within(along_u, corner.x()), within(along_v, corner.y()));
    if (polygon.empty() || clamped != polygon.back()) polygon.push_back(clamped);
  }
  if (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
  return polygon;
}

double polygon_error_fraction(const TrimLoop& loop, const KnotVector& along_u, const KnotVector& along_v) {
  SPOONBILL_ASSERT(has_matching_net(loop));
  const Eigen::Vector2d lengths(along_u.domain_length(), along_v.domain_length());
  const std::vector<double> ends = loop.knots.breakpoints();
  double largest = 0.0;
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const PieceChords chords = count_chords(loop, ends[piece], ends[piece + 1] - ends[piece], lengths);
    largest = std::max(largest, chords.error_fraction);
  }
  return largest;
}

double signed_area(const std::vector<Eigen::Vector2d>& polygon) {
  SPOONBILL_ASSERT(!polygon.empty());
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0];
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

TrimLoop reversed(const TrimLoop& loop, Direction direction, const KnotVector& knots) {
  SPOONBILL_ASSERT(has_matching_net(loop));
  TrimLoop mirrored = loop;
  for (double& value : along(mirrored, direction)) {
    value = knots.domain_end() - (value - knots.domain_start());
  }
  return reverse_curve(std::move(mirrored));
}

TrimLoop exchanged(const TrimLoop& loop) {
  SPOONBILL_ASSERT(has_matching_net(loop));
  TrimLoop mirrored = loop;
  std::swap(mirrored.u, mirrored.v);
  return reverse_curve(std::move(mirrored));
}

TrimLoop with_domain(const TrimLoop& loop, Direction direction, const KnotVector& knots, double start,
                     double end) {
  SPOONBILL_ASSERT(start < end);
  TrimLoop stretched = loop;
  const double scale = (end - start) / knots.domain_length();
  for (double& value : along(stretched, direction)) value = start + (value - knots.domain_start()) * scale;
  return stretched;
}

TrimLoop with_seam_at(const TrimLoop& loop, Direction direction, const KnotVector& knots, double seam) {
  SPOONBILL_ASSERT(knots.is_periodic());
  SPOONBILL_ASSERT(has_matching_net(loop));
  TrimLoop moved = loop;
  std::vector<double>& values = along(moved, direction);
  const double start = knots.domain_start(), length = knots.domain_length();
  double shift = start - knots.into_domain(seam);
  // The shift brings the start of the loop into the domain. The whole loop is then within one period of the
  // domain.
  const Eigen::Vector2d first = position(loop, loop.knots.domain_start());
  const double moved_first = (direction == Direction::u ? first.x() : first.y()) + shift;
  shift -= length * std::floor((moved_first - start) / length);
  for (double& value : values) value += shift;
  return moved;
}

}  // namespace spoonbill
