#include "engine/bspline/reparameterise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {

namespace {

// Coordinates of all control points that have the same index along the direction.
using ControlLine = std::vector<double>;

// A sequence of lines of control points. Line i has a basis function with the support from knots[i] to
// knots[i + degree + 1].
struct Sequence {
  int degree;
  std::vector<double> knots;
  std::vector<ControlLine> lines;
};

ControlLine mix(const ControlLine& a, const ControlLine& b, double weight_of_b) {
  ControlLine mixed(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) mixed[k] = (1.0 - weight_of_b) * a[k] + weight_of_b * b[k];
  return mixed;
}

// Inserts a knot once. The sequence must have `degree` knots on either side of the new knot.
void insert_once(Sequence& sequence, double knot) {
  const auto& knots = sequence.knots;
  const int degree = sequence.degree;
  const int span = static_cast<int>(std::upper_bound(knots.begin(), knots.end(), knot) - knots.begin()) - 1;
  std::vector<ControlLine> lines(sequence.lines.begin(), sequence.lines.begin() + span - degree + 1);
  for (int i = span - degree + 1; i <= span; ++i) {
    // The weight is 0 where knots[i] is a copy of the knot; then the previous line is copied.
    const double weight = knots[i] < knot ? (knot - knots[i]) / (knots[i + degree] - knots[i]) : 0.0;
    if (weight == 0.0) {
      lines.push_back(sequence.lines[i - 1]);
    } else {
      lines.push_back(mix(sequence.lines[i - 1], sequence.lines[i], weight));
    }
  }
  lines.insert(lines.end(), sequence.lines.begin() + span, sequence.lines.end());
  sequence.lines = std::move(lines);
  sequence.knots.insert(sequence.knots.begin() + span + 1, knot);
}

std::vector<double> with_knot(const KnotVector& knots, double knot) {
  std::vector<double> more = knots.knots();
  more.insert(std::upper_bound(more.begin(), more.end(), knot), knot);
  return more;
}

// Repeats the period several times and inserts the knot into the central period and into every other period
// in which an inserted knot changes lines of the central period. The outermost periods receive no knot, so
// that each inserted knot has at least `degree` knots on either side. Returns the lines of the central
// period.
std::vector<ControlLine> insert_into_periodic(const KnotVector& knots, const std::vector<ControlLine>& lines,
                                              double knot) {
  const int degree = knots.degree(), count = knots.control_point_count();
  const double start = knots.domain_start(), end = knots.domain_end(), period = end - start;
  const auto in_period = [&](int wrap, double u) {
    return (wrap < 1 ? start + wrap * period : end + (wrap - 1) * period) + (u - start);
  };
  const int reached = (degree + 1) / count + 1;
  Sequence sequence{degree, {}, {}};
  for (int wrap = -2 * reached; wrap <= 2 * reached; ++wrap) {
    for (int i = 0; i < count; ++i) {
      sequence.knots.push_back(in_period(wrap, knots.knots()[i]));
      sequence.lines.push_back(lines[i]);
    }
  }
  sequence.lines.resize(sequence.lines.size() - degree - 1);
  for (int wrap = -reached; wrap <= reached; ++wrap) insert_once(sequence, in_period(wrap, knot));
  const auto first_of_period = sequence.lines.begin() + 2 * reached * count + reached;
  return {first_of_period, first_of_period + count + 1};
}

int count_multiplicity(const KnotVector& knots, double knot) {
  const auto& all = knots.knots();
  int multiplicity = static_cast<int>(std::count(all.begin(), all.end(), knot));
  // Some copies of the seam's knot are listed at the start of the period and the others at the end. One copy
  // is listed at both.
  if (knots.is_periodic() && knot == all.front()) {
    multiplicity += static_cast<int>(std::count(all.begin(), all.end(), all.back())) - 1;
  }
  return multiplicity;
}

std::vector<ControlLine> to_lines(const ControlNet& net, Direction direction) {
  const bool along_u = direction == Direction::u;
  std::vector<ControlLine> lines(static_cast<std::size_t>(along_u ? net.rows : net.columns));
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const std::size_t k = net.index(i, j);
      ControlLine& line = lines[along_u ? i : j];
      line.insert(line.end(), {net.x[k], net.y[k], net.z[k]});
    }
  }
  return lines;
}

ControlNet to_net(const std::vector<ControlLine>& lines, Direction direction) {
  const int count = static_cast<int>(lines.size()), across = static_cast<int>(lines[0].size() / 3);
  const bool along_u = direction == Direction::u;
  ControlNet net(along_u ? count : across, along_u ? across : count);
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < across; ++b) {
      const double* const point = &lines[a][3 * b];
      net.set_point(along_u ? a : b, along_u ? b : a, {point[0], point[1], point[2]});
    }
  }
  return net;
}

Status check_insertion(const KnotVector& knots, double knot, int multiplicity) {
  if (multiplicity < 1 || multiplicity > knots.degree()) {
    return Error{ErrorCode::out_of_range,
                 "multiplicity " + std::to_string(multiplicity) + " of the knot to insert is outside 1 to " +
                     std::to_string(knots.degree()) + ", the degree; choose one in that range"};
  }
  const bool inside =
      knots.is_periodic() ? std::isfinite(knot) : knot > knots.domain_start() && knot < knots.domain_end();
  if (!inside) {
    return Error{ErrorCode::out_of_range, "knot " + number_text(knot) +
                                              " to insert is not strictly inside the domain " +
                                              number_text(knots.domain_start()) + " to " +
                                              number_text(knots.domain_end()) + "; choose one inside"};
  }
  return {};
}

}  // namespace

Result<Surface> insert_knot(const Surface& surface, Direction direction, double knot, int multiplicity) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  KnotVector knots = direction == Direction::u ? surface.u : surface.v;
  if (Status status = check_insertion(knots, knot, multiplicity); !status) {
    return status.error().in(direction_name(direction));
  }
  knot = knots.into_domain(knot);
  std::vector<ControlLine> lines = to_lines(surface.net, direction);
  while (count_multiplicity(knots, knot) < multiplicity) {
    if (knots.is_periodic()) {
      lines = insert_into_periodic(knots, lines, knot);
    } else {
      Sequence sequence{knots.degree(), knots.knots(), std::move(lines)};
      insert_once(sequence, knot);
      lines = std::move(sequence.lines);
    }
    auto finer = knots.is_periodic() ? KnotVector::periodic(knots.degree(), with_knot(knots, knot))
                                     : KnotVector::open(knots.degree(), with_knot(knots, knot));
    if (!finer) return finer.error();
    knots = std::move(finer).value();
  }
  ControlNet net = to_net(lines, direction);
  return direction == Direction::u ? make_surface(std::move(knots), surface.v, std::move(net))
                                   : make_surface(surface.u, std::move(knots), std::move(net));
}

namespace {

Surface replace_knots(const Surface& surface, Direction direction, KnotVector knots, ControlNet net) {
  return direction == Direction::u ? Surface{std::move(knots), surface.v, std::move(net)}
                                   : Surface{surface.u, std::move(knots), std::move(net)};
}

// Reorders the lines of a net along a direction: line i of the result is line from(i) of the net.
template <class From>
ControlNet reorder_lines(const ControlNet& net, Direction direction, const From& from) {
  ControlNet result(net.rows, net.columns);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      result.set_point(i, j, direction == Direction::u ? net.point(from(i), j) : net.point(i, from(j)));
    }
  }
  return result;
}

// Returns the index of the period's first knot that is at or after `seam`.
int knot_at(const KnotVector& knots, double seam) {
  const auto& all = knots.knots();
  return static_cast<int>(std::lower_bound(all.begin(), all.end() - 1, seam) - all.begin());
}

Result<KnotVector> rotate_knots(const KnotVector& knots, int first) {
  const auto& all = knots.knots();
  const int count = knots.control_point_count();
  const double start = all.front(), end = all.back();
  std::vector<double> turned;
  for (int i = 0; i < count; ++i) {
    const int from = (first + i) % count;
    const bool wrapped = first + i >= count;
    // The order of these operations makes the new seam's knot exactly equal to the start of the domain,
    // without rounding.
    turned.push_back(wrapped ? (all[from] - start) + (end - all[first]) + start
                             : start + (all[from] - all[first]));
  }
  turned.push_back(end);
  return KnotVector::periodic(knots.degree(), std::move(turned));
}

}  // namespace

Surface reversed(const Surface& surface, Direction direction) {
  const KnotVector& knots = knots_along(surface, direction);
  const int count = knots.control_point_count(), degree = knots.degree();
  const auto from = [&](int i) {
    // The index of a periodic basis function is that of the knot at which its support starts. Its mirror
    // image starts where the support ends, degree + 1 knots further.
    return knots.is_periodic() ? ((count - 1 - degree - i) % count + count) % count : count - 1 - i;
  };
  return replace_knots(surface, direction, reversed(knots), reorder_lines(surface.net, direction, from));
}

Surface exchanged(const Surface& surface) {
  ControlNet net(surface.net.columns, surface.net.rows);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, surface.net.point(j, i));
  }
  return {surface.v, surface.u, std::move(net)};
}

Result<Surface> with_domain(const Surface& surface, Direction direction, double start, double end) {
  auto knots = with_domain(knots_along(surface, direction), start, end);
  if (!knots) return knots.error();
  return replace_knots(surface, direction, std::move(knots).value(), surface.net);
}

Result<Surface> with_seam_at(const Surface& surface, Direction direction, double seam) {
  const KnotVector& knots = knots_along(surface, direction);
  if (!knots.is_periodic() || !std::isfinite(seam)) {
    return Error{ErrorCode::unsupported,
                 "the seam can be moved only in a periodic direction, and only to a finite parameter"};
  }
  const double length = knots.domain_length();
  double at = knots.into_domain(seam);
  for (const double knot : knots.breakpoints()) {
    if (std::abs(knot - at) <= same_knot_fraction * length) at = knots.into_domain(knot);
  }
  auto cut = insert_knot(surface, direction, at, 1);
  if (!cut) return cut.error();
  const KnotVector& finer = knots_along(cut.value(), direction);
  const int first = knot_at(finer, at), count = finer.control_point_count();
  if (first % count == 0) return cut;
  auto turned = rotate_knots(finer, first);
  if (!turned) return turned.error();
  return replace_knots(cut.value(), direction, std::move(turned).value(),
                       reorder_lines(cut->net, direction, [&](int i) { return (first + i) % count; }));
}

Result<Surface> part_of(const Surface& surface, Direction direction, double start, double end) {
  const auto part = clamped_part(knots_along(surface, direction), start, end);
  if (!part) return part.error();
  return convert_to_finer_knots(surface, direction, part.value());
}

}  // namespace spoonbill
