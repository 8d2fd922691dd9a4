#include "engine/bspline/change_knots.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/blending_matrix.h"

namespace spoonbill {

namespace {

// The longest polynomial piece in the support of a control point's basis function. The longest piece is used,
// because blossoms lose digits if their arguments are many piece lengths away from the piece.
struct Piece {
  double length = 0.0;
  int span = 0;
  int basis = 0;  // index of the control point's basis function among those of the span
};

std::vector<Piece> longest_pieces(const KnotVector& knots) {
  const auto& t = knots.extended_knots();
  std::vector<Piece> longest(static_cast<std::size_t>(knots.control_point_count()));
  const int last = static_cast<int>(t.size()) - 1 - knots.degree();
  for (int span = knots.degree(); span < last; ++span) {
    for (int j = 0; j <= knots.degree(); ++j) {
      Piece& piece = longest[knots.control_index(span, j)];
      if (t[span + 1] - t[span] > piece.length) piece = {t[span + 1] - t[span], span, j};
    }
  }
  return longest;
}

// Returns the matrix that computes new control points (rows) from old control points (columns).
Eigen::MatrixXd exact_conversion(const KnotVector& from, const KnotVector& to) {
  Eigen::MatrixXd conversion = Eigen::MatrixXd::Zero(to.control_point_count(), from.control_point_count());
  const auto& t = to.extended_knots();
  const std::vector<Piece> pieces = longest_pieces(to);
  for (int i = 0; i < to.control_point_count(); ++i) {
    const Piece& piece = pieces[i];
    const double centre = 0.5 * (t[piece.span] + t[piece.span + 1]);
    const double inside = from.into_domain(centre);
    const int first = piece.span - to.degree() + piece.basis;
    std::array<double, max_degree> arguments{};
    for (int k = 0; k < to.degree(); ++k) arguments[k] = t[first + 1 + k] + (inside - centre);
    const int span = from.find_span(inside);
    const BlossomWeights weights = blossom(from, span, std::span(arguments).first(to.degree()));
    for (int j = 0; j <= from.degree(); ++j) conversion(i, from.control_index(span, j)) += weights[j];
  }
  return conversion;
}

int multiplicity_at(const std::vector<KnotMultiplicity>& all, double knot, double nearness) {
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& k) { return std::abs(k.knot - knot) <= nearness; });
  return found == all.end() ? 0 : found->multiplicity;
}

Status check_contains_all(const KnotVector& from, const KnotVector& to) {
  const double length = from.domain_length(), nearness = same_knot_fraction * length;
  const double start = to.domain_start(), end = to.domain_end();
  if (to.degree() < from.degree())
    return Error{ErrorCode::unsupported,
                 "the new degree is lower than that of the surface; use a fit instead"};
  const bool same_domain =
      std::abs(start - from.domain_start()) <= nearness && std::abs(end - from.domain_end()) <= nearness;
  const bool within = from.is_periodic()
                          ? end - start <= length + nearness
                          : start >= from.domain_start() - nearness && end <= from.domain_end() + nearness;
  if (to.is_periodic() ? !(from.is_periodic() && same_domain) : !within) {
    return Error{ErrorCode::mismatch,
                 "the new knots have a different domain from the old ones; use the domain of the surface or "
                 "a part of it"};
  }
  const std::vector<KnotMultiplicity> there = knot_multiplicities(to);
  for (const auto& [knot, multiplicity] : knot_multiplicities(from)) {
    for (const double position : knot_positions_from(from, knot, start - nearness)) {
      if (position >= end - nearness) continue;
      const bool at_end = !to.is_periodic() && position <= start + nearness;
      if (at_end ||
          multiplicity_at(there, position, nearness) >= multiplicity + to.degree() - from.degree()) {
        continue;
      }
      return Error{ErrorCode::mismatch,
                   "the new knots lack the surface's knot " + number_text(knot) + "; insert it"};
    }
  }
  return {};
}

// Returns parameters at which two splines over these knot vectors can be compared. In each common polynomial
// piece there is one parameter more than a polynomial of the higher degree has coefficients.
std::vector<double> distinguishing_parameters(const KnotVector& a, const KnotVector& b) {
  std::vector<double> ends = a.breakpoints();
  for (const double end : b.breakpoints()) ends.push_back(std::clamp(end, ends.front(), a.domain_end()));
  std::sort(ends.begin(), ends.end());
  const int inside = std::max(a.degree(), b.degree()) + 2;
  std::vector<double> parameters;
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    if (ends[piece + 1] - ends[piece] <= same_knot_fraction * a.domain_length()) continue;
    for (int k = 0; k < inside; ++k) {
      parameters.push_back(ends[piece] + (ends[piece + 1] - ends[piece]) * k / inside);
    }
  }
  parameters.push_back(a.domain_end());
  return parameters;
}

// Distances between the control points of two surfaces over common knots: for each index along the direction,
// the largest distance.
struct Difference {
  KnotVector knots;
  std::vector<double> largest_m;
};

Result<Difference> difference(const Surface& a, const Surface& b, Direction direction) {
  const KnotVector &ka = knots_along(a, direction), &kb = knots_along(b, direction);
  const bool open = !ka.is_periodic() || !kb.is_periodic();
  const int degree = std::max(ka.degree(), kb.degree());
  const auto prepared = [&](const KnotVector& knots) {
    const auto part = open ? clamped_part(knots, ka.domain_start(), ka.domain_end()) : Result(knots);
    return part ? elevate_degree(part.value(), degree) : part;
  };
  const auto of_a = prepared(ka), of_b = prepared(kb);
  if (!of_a) return of_a.error();
  if (!of_b) return of_b.error();
  auto common = knot_union(of_a.value(), of_b.value());
  if (!common) return common.error();
  const auto fine_a = convert_to_finer_knots(a, direction, common.value());
  const auto fine_b = convert_to_finer_knots(b, direction, common.value());
  if (!fine_a) return fine_a.error();
  if (!fine_b) return fine_b.error();
  std::vector<double> largest(static_cast<std::size_t>(common->control_point_count()));
  for (int i = 0; i < fine_a->net.rows; ++i) {
    for (int j = 0; j < fine_a->net.columns; ++j) {
      double& there = largest[direction == Direction::u ? i : j];
      there = std::max(there, (fine_a->net.point(i, j) - fine_b->net.point(i, j)).norm());
    }
  }
  return Difference{std::move(common).value(), std::move(largest)};
}

std::vector<double> find_spans_above(const Difference& difference, double tolerance_m) {
  const KnotVector& knots = difference.knots;
  const auto& t = knots.extended_knots();
  std::vector<double> midpoints;
  for (int span = knots.degree(); span + 1 + knots.degree() < static_cast<int>(t.size()); ++span) {
    if (t[span] >= t[span + 1]) continue;
    double largest = 0.0;
    for (int j = 0; j <= knots.degree(); ++j) {
      largest = std::max(largest, difference.largest_m[knots.control_index(span, j)]);
    }
    if (largest > tolerance_m) midpoints.push_back(0.5 * (t[span] + t[span + 1]));
  }
  return midpoints;
}

struct Fitted {
  Surface surface;
  Difference difference;
};

Result<Fitted> fitted(const Surface& surface, Direction direction, const KnotVector& knots) {
  const KnotVector& from = knots_along(surface, direction);
  const double nearness = same_knot_fraction * from.domain_length();
  if (std::abs(knots.domain_start() - from.domain_start()) > nearness ||
      std::abs(knots.domain_end() - from.domain_end()) > nearness) {
    return Error{ErrorCode::mismatch, "the new knots have a different domain from the old ones"}.in(
        direction_name(direction));
  }
  std::vector<double> parameters = distinguishing_parameters(from, knots);
  if (knots.is_periodic()) parameters.pop_back();
  const bool open = !knots.is_periodic();
  const bool start = open && knots.knots().front() == knots.domain_start();
  const bool end = open && knots.knots().back() == knots.domain_end();
  const auto inverse = constrained_inverse(knots, parameters, {{}, start, end});
  if (!inverse) return inverse.error().in(direction_name(direction));
  const Eigen::MatrixXd conversion =
      inverse.value().lazyProduct(blending_matrix(from, parameters, 0).dense());
  Surface fit = combine_along(surface, direction, conversion, knots);
  auto distances = difference(surface, fit, direction);
  if (!distances) return distances.error();
  return Fitted{std::move(fit), std::move(distances).value()};
}

double max_deviation(const Difference& difference) {
  return *std::max_element(difference.largest_m.begin(), difference.largest_m.end());
}

struct SpareKnot {
  double knot, cost_m;
};

Result<KnotVector> without_knots(const KnotVector& knots, std::span<const SpareKnot> spare) {
  std::vector<double> fewer = knots.knots();
  for (const SpareKnot& one : spare) {
    fewer.erase(std::min_element(fewer.begin(), fewer.end(), [&](double a, double b) {
      return std::abs(a - one.knot) < std::abs(b - one.knot);
    }));
  }
  return knots.is_periodic() ? KnotVector::periodic(knots.degree(), std::move(fewer))
                             : KnotVector::open(knots.degree(), std::move(fewer));
}

// The part of a surface that the removal of an inner knot may change, and the knot's parameter in that part.
struct Neighbourhood {
  Surface surface;
  double knot;
};

Result<Neighbourhood> around_knot(const Surface& surface, Direction direction, int breakpoint) {
  const KnotVector& knots = knots_along(surface, direction);
  const std::vector<double> ends = knots.breakpoints();
  const int pieces = static_cast<int>(ends.size()) - 1, reach = 2 * (knots.degree() + 1);
  const bool periodic = knots.is_periodic();
  if (pieces <= 2 * reach) return Neighbourhood{surface, ends[breakpoint]};
  const double length = knots.domain_length();
  int first = breakpoint - reach, last = breakpoint + reach;
  const double turn = periodic && first < 0 ? length : 0.0;
  const auto end_at = [&](int k) {
    return k < 0 ? ends[k + pieces] : k > pieces ? ends[k - pieces] + length : ends[k] + turn;
  };
  if (!periodic) {
    first = std::max(first, 0);
    last = std::min(last, pieces);
  }
  const auto part = clamped_part(knots, end_at(first), end_at(last));
  if (!part) return part.error();
  auto near = convert_to_finer_knots(surface, direction, part.value());
  if (!near) return near.error();
  return Neighbourhood{std::move(near).value(), end_at(breakpoint)};
}

// Returns the copies of inner knots that can be removed within the tolerance, in order of cost. The cost of a
// copy is the deviation after removing it together with the earlier copies of the same knot. The deviation is
// computed on the part of the surface around the knot, which is much faster than on the whole surface.
Result<std::vector<SpareKnot>> spare_knots(const Surface& surface, Direction direction, double tolerance_m,
                                           const Progress& progress) {
  std::vector<SpareKnot> spare;
  const auto all = knot_multiplicities(knots_along(surface, direction));
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (!progress.report(static_cast<double>(k) / static_cast<double>(all.size())))
      return Progress::stopped();
    const auto near = around_knot(surface, direction, static_cast<int>(k));
    if (!near) continue;
    std::vector<SpareKnot> copies;
    double cost_m = 0.0;
    while (static_cast<int>(copies.size()) < all[k].multiplicity) {
      copies.push_back({near->knot, 0.0});
      const auto fewer = without_knots(knots_along(near->surface, direction), copies);
      const auto fit = fewer ? fit_coarser_knots(near->surface, direction, fewer.value()) : fewer.error();
      if (fit) cost_m = std::max(cost_m, fit->deviation_m);
      if (!fit || cost_m > tolerance_m) break;
      spare.push_back({all[k].knot, cost_m});
    }
  }
  std::stable_sort(spare.begin(), spare.end(),
                   [](const SpareKnot& a, const SpareKnot& b) { return a.cost_m < b.cost_m; });
  return spare;
}

}  // namespace

Surface combine_along(const Surface& surface, Direction direction, const Eigen::MatrixXd& weights,
                      const KnotVector& knots) {
  SPOONBILL_ASSERT(weights.rows() == knots.control_point_count());
  SPOONBILL_ASSERT(weights.cols() == knots_along(surface, direction).control_point_count());
  const bool along_u = direction == Direction::u;
  const int count = static_cast<int>(weights.rows());
  ControlNet net(along_u ? count : surface.net.rows, along_u ? surface.net.columns : count);
  const int across = along_u ? net.columns : net.rows;
  for (int i = 0; i < count; ++i) {
    for (int b = 0; b < across; ++b) {
      Vector3 sum = Vector3::Zero();
      for (int k = 0; k < weights.cols(); ++k) {
        const double weight = weights(i, k);
        if (weight != 0.0) sum += weight * (along_u ? surface.net.point(k, b) : surface.net.point(b, k));
      }
      net.set_point(along_u ? i : b, along_u ? b : i, sum);
    }
  }
  return along_u ? Surface{knots, surface.v, std::move(net)} : Surface{surface.u, knots, std::move(net)};
}

Result<Surface> convert_to_finer_knots(const Surface& surface, Direction direction, const KnotVector& finer) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const KnotVector& from = knots_along(surface, direction);
  if (from == finer) return surface;
  if (Status status = check_contains_all(from, finer); !status) {
    return status.error().in(direction_name(direction));
  }
  return combine_along(surface, direction, exact_conversion(from, finer), finer);
}

Result<Approximation> fit_coarser_knots(const Surface& surface, Direction direction,
                                        const KnotVector& coarser) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  auto fit = fitted(surface, direction, coarser);
  if (!fit) return fit.error();
  return Approximation{std::move(fit->surface), max_deviation(fit->difference)};
}

Result<Approximation> approximated(const Surface& surface, Direction direction, const KnotVector& first,
                                   double tolerance_m, int largest_count, const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  KnotVector knots = first;
  for (RoundsDone done(0.3);; done.step()) {
    if (!progress.report(done.fraction())) return Progress::stopped();
    auto fit = fitted(surface, direction, knots);
    if (!fit) return fit.error();
    const double deviation_m = max_deviation(fit->difference);
    if (deviation_m <= tolerance_m) return Approximation{std::move(fit->surface), deviation_m};
    auto finer = halve_pieces(knots, find_spans_above(fit->difference, tolerance_m));
    if (!finer) return finer.error();
    if (finer->control_point_count() > largest_count || finer.value() == knots) {
      const std::string counted = std::to_string(knots.control_point_count());
      return Error{ErrorCode::not_converged,
                   counted + " control points leave a deviation of " + short_length_text(deviation_m) +
                       "; allow a larger deviation than " + short_length_text(tolerance_m)}
          .in(direction_name(direction));
    }
    knots = std::move(finer).value();
  }
}

Result<Approximation> remove_spare_knots(const Surface& surface, Direction direction, double tolerance_m,
                                         const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  Approximation best{surface, 0.0};
  for (RoundsDone done(0.2);; done.step()) {
    // Each round removes at once as many knots as possible, in order of their cost. The rounds are repeated,
    // because the removal changes the costs of the remaining knots.
    const auto spare =
        spare_knots(best.surface, direction, tolerance_m, progress.part(done.fraction(), done.fraction()));
    if (!spare) return spare.error();
    const KnotVector knots = knots_along(best.surface, direction);
    std::size_t few = 0, many = spare->size();
    while (few < many) {
      done.step();
      if (!progress.report(done.fraction())) return Progress::stopped();
      const std::size_t count = (few + many + 1) / 2;
      const auto fewer = without_knots(knots, std::span(spare.value()).first(count));
      auto fit = fewer ? fit_coarser_knots(surface, direction, fewer.value()) : fewer.error();
      const bool allowed = fit && fit->deviation_m <= tolerance_m;
      if (allowed) {
        best = std::move(fit).value();
        few = count;
      } else {
        many = count - 1;
      }
    }
    if (few == 0) return best;
  }
}

namespace {

Error no_knot_at(double parameter, std::vector<KnotMultiplicity> all, bool periodic) {
  if (!periodic) all.erase(all.begin());
  if (all.empty())
    return Error{ErrorCode::missing, "the direction is one polynomial piece and has no knot to remove"};
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.knot - parameter) < std::abs(b.knot - parameter);
  });
  return Error{ErrorCode::missing, "there is no knot at " + number_text(parameter) + "; the nearest is at " +
                                       number_text(nearest->knot)};
}

Result<KnotVector> fewer_knots(const KnotVector& knots, std::vector<KnotMultiplicity> all, std::size_t index,
                               int copies) {
  all[index].multiplicity -= copies;
  std::vector<double> fewer;
  for (const auto& [knot, multiplicity] : all) {
    fewer.insert(fewer.end(), static_cast<std::size_t>(multiplicity), knot);
  }
  if (knots.is_periodic()) {
    fewer.push_back(knots.domain_end());
    return KnotVector::periodic(knots.degree(), std::move(fewer));
  }
  fewer.insert(fewer.end(), static_cast<std::size_t>(knots.degree()) + 1, knots.domain_end());
  return KnotVector::open(knots.degree(), std::move(fewer));
}

}  // namespace

Result<Approximation> remove_knot(const Surface& surface, Direction direction, double parameter, int copies) {
  SPOONBILL_ASSERT(copies >= 1);
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const KnotVector& knots = knots_along(surface, direction);
  const double near = same_knot_fraction * knots.domain_length();
  const double wanted = knots.is_periodic() && parameter >= knots.domain_end() - near
                            ? parameter - knots.domain_length()
                            : parameter;
  const std::vector<KnotMultiplicity> all = knot_multiplicities(knots);
  if (!knots.is_periodic()) {
    for (const double end : {knots.domain_start(), knots.domain_end()}) {
      if (std::abs(end - wanted) <= near) {
        return Error{
            ErrorCode::unsupported,
            number_text(end) +
                " is an end of the domain, whose knots cannot be removed; choose a knot inside the domain"};
      }
    }
  }
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& one) { return std::abs(one.knot - wanted) <= near; });
  if (found == all.end()) return no_knot_at(parameter, all, knots.is_periodic());
  if (copies > found->multiplicity) {
    return Error{ErrorCode::too_few, "the knot at " + number_text(found->knot) + " cannot be removed " +
                                         std::to_string(copies) + " times; its multiplicity is " +
                                         std::to_string(found->multiplicity)};
  }
  const auto index = static_cast<std::size_t>(found - all.begin());
  if (knots.is_periodic() && index == 0 && copies == found->multiplicity) {
    return Error{ErrorCode::unsupported, "the seam needs a knot; move the seam first"};
  }
  const auto fewer = fewer_knots(knots, all, index, copies);
  if (!fewer) return fewer.error();
  return fit_coarser_knots(surface, direction, fewer.value());
}

}  // namespace spoonbill
