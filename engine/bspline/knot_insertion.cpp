#include "engine/bspline/knot_insertion.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

using ControlLine = std::vector<double>;  // the coordinates of all control points with one index

// Control point i, a line, reaches from knots[i] to knots[i + degree + 1].
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

// `knot` must have `degree` knots on either side.
void insert_once(Sequence& sequence, double knot) {
  const auto& knots = sequence.knots;
  const int degree = sequence.degree;
  const int span = static_cast<int>(std::upper_bound(knots.begin(), knots.end(), knot) - knots.begin()) - 1;
  std::vector<ControlLine> lines(sequence.lines.begin(), sequence.lines.begin() + span - degree + 1);
  for (int i = span - degree + 1; i <= span; ++i) {
    // Where the knot is a multiple one, the last of these points have nothing of it to blend.
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

// Inserts the knot into as many periods as the control points of one reach, and keeps that one. Further
// periods on either side make every insertion one of an inner knot.
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
  const auto kept = sequence.lines.begin() + 2 * reached * count + reached;
  return {kept, kept + count + 1};
}

int multiplicity_of(const KnotVector& knots, double knot) {
  const auto& all = knots.knots();
  int multiplicity = static_cast<int>(std::count(all.begin(), all.end(), knot));
  // The seam is both ends of the period, and one of its knots stands at either.
  if (knots.is_periodic() && knot == all.front()) {
    multiplicity += static_cast<int>(std::count(all.begin(), all.end(), all.back())) - 1;
  }
  return multiplicity;
}

std::vector<ControlLine> lines_of(const ControlNet& net, Direction direction) {
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

ControlNet net_of(const std::vector<ControlLine>& lines, Direction direction) {
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

Status check(const KnotVector& knots, double knot, int multiplicity) {
  if (multiplicity < 1 || multiplicity > knots.degree()) {
    return Error{"multiplicity " + std::to_string(multiplicity) + " of the knot to insert is outside 1 to " +
                 std::to_string(knots.degree()) + ", the degree; choose one in that range"};
  }
  const bool inside =
      knots.is_periodic() ? std::isfinite(knot) : knot > knots.domain_start() && knot < knots.domain_end();
  if (!inside) {
    return Error{"knot " + number_text(knot) + " to insert does not lie strictly inside the domain " +
                 number_text(knots.domain_start()) + " to " + number_text(knots.domain_end()) +
                 "; choose one inside"};
  }
  return {};
}

}  // namespace

Result<Surface> insert_knot(const Surface& surface, Direction direction, double knot, int multiplicity) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  KnotVector knots = direction == Direction::u ? surface.u : surface.v;
  if (Status status = check(knots, knot, multiplicity); !status) {
    return Error{std::string("direction ") + (direction == Direction::u ? "u: " : "v: ") +
                 status.error().message};
  }
  knot = knots.into_domain(knot);
  std::vector<ControlLine> lines = lines_of(surface.net, direction);
  while (multiplicity_of(knots, knot) < multiplicity) {
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
  ControlNet net = net_of(lines, direction);
  return direction == Direction::u ? make_surface(std::move(knots), surface.v, std::move(net))
                                   : make_surface(surface.u, std::move(knots), std::move(net));
}

}  // namespace spoonbill
