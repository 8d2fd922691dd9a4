#include "engine/merging/compatible.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/edge_match.h"
#include "engine/merging/nearly_same_knots.h"

namespace spoonbill {

namespace {

std::string name_of(std::size_t patch) {
  return "patch " + std::to_string(patch + 1) + " of the row";
}

// A rounding error must not make the domain another one than the first patch's.
Result<Surface> over_domain_of(const Surface& first, const Surface& patch) {
  const double start = first.u.domain_start(), end = first.u.domain_end();
  if (patch.u.domain_start() == start && patch.u.domain_end() == end) return patch;
  return with_domain(patch, Direction::u, start, end);
}

// The parameter of the point of the curve nearest to a point, from a guess.
double nearest_parameter(const EdgeCurve& curve, const Vector3& point, double guess) {
  double t = guess;
  for (int step = 0; step < 20; ++step) {
    const Vector3 slope = derivative(curve, t);
    const double squared = slope.squaredNorm();
    if (squared == 0.0) break;
    const double moved = t + (point - position(curve, t)).dot(slope) / squared;
    t = curve.knots.is_periodic() ? moved
                                  : std::clamp(moved, curve.knots.domain_start(), curve.knots.domain_end());
  }
  return t;
}

// Where on b's edge each of a's parameters lies; the guess is at an equal share of the way. Both are open, or
// have their seams beside each other.
std::vector<double> parameters_beside(const EdgeCurve& a, const EdgeCurve& b,
                                      const std::vector<double>& along) {
  constexpr int steps = 129;
  const EdgeSamples of_a = edge_samples(a, steps), of_b = edge_samples(b, steps);
  std::vector<double> beside;
  for (const double t : along) {
    const auto after = std::upper_bound(of_a.parameters.begin(), of_a.parameters.end(), t);
    const std::size_t k = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - of_a.parameters.begin() - 1, 0, steps - 1));
    beside.push_back(nearest_parameter(b, position(a, t), of_b.parameters[k]));
  }
  if (!a.knots.is_periodic()) {
    beside.front() = b.knots.domain_start();
    beside.back() = b.knots.domain_end();
  }
  return beside;
}

// The largest distance from a to b at the parameters.
double largest_apart_m(const EdgeCurve& a, const EdgeCurve& b, const std::vector<double>& along,
                       const std::vector<double>& beside) {
  double largest = 0.0;
  for (std::size_t k = 0; k < along.size(); ++k) {
    largest = std::max(largest, (position(a, along[k]) - position(b, beside[k])).norm());
  }
  return largest;
}

// The parameter of the ring's point nearest to a point.
double nearest_around(const EdgeCurve& ring, const Vector3& point) {
  const std::vector<double> around = nested_parameters(ring.knots, 16, 0).parameters;
  const auto distance = [&](double t) { return (position(ring, t) - point).squaredNorm(); };
  const double guess = *std::min_element(around.begin(), around.end(),
                                         [&](double a, double b) { return distance(a) < distance(b); });
  return nearest_parameter(ring, point, guess);
}

Result<Surface> with_seam_beside(const Surface& before, const Surface& patch, const JoinRequest& request) {
  const auto match = match_edges({before, patch}, {0, Side::v_end}, {1, Side::v_start}, false);
  if (!match) return match.error();
  double seam = match->seam;
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  const Vector3 of_a = position(a, a.knots.domain_start());
  const double nearest = nearest_around(b, of_a);
  // What fits best is beside it where parameters differ, and where rings with corners are one, not to
  // rounding.
  constexpr double one_share = 1e-6;
  const double near_m = request.tolerance_m * (match->gap_m > request.tolerance_m ? 1.0 : one_share);
  if ((position(b, nearest) - of_a).norm() <= near_m) seam = nearest;
  const double period = patch.u.domain_end() - patch.u.domain_start();
  const double wanted = seam + request.twist * period;
  return with_seam_at(patch, Direction::u, seam_at_nearly_same_knots(before.u, patch.u, wanted));
}

// Of a piece: what is fitted to, what is looked at to find where knots are wanting, and what is measured at.
constexpr int fitted_in_piece = 5, looked_at_in_piece = 10, measured_in_piece = 40;

// Not on the far end of a period.
std::vector<double> dense_parameters(const KnotVector& knots, int in_piece) {
  std::vector<double> dense = nested_parameters(knots, in_piece, 0).parameters;
  if (knots.is_periodic()) dense.pop_back();
  return dense;
}

// The surface with its u replaced by a function of u, given at the parameters that are fitted to, over
// `knots`.
Result<Surface> composed(const Surface& surface, const KnotVector& knots, const std::vector<double>& fitted,
                         const std::vector<double>& beside) {
  const bool open = !knots.is_periodic();
  const auto inverse = constrained_inverse(knots, fitted, {{}, open, open});
  if (!inverse) return inverse.error();
  const Eigen::MatrixXd weights = inverse.value().lazyProduct(blending_matrix(surface.u, beside, 0).dense());
  return combine_along(surface, Direction::u, weights, knots);
}

Vector3 blended(const BlendingMatrix& blending, int row, const ControlNet& net, int column) {
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < blending.bandwidth; ++k) {
    sum += blending.values[static_cast<std::size_t>(row) * blending.bandwidth + k] *
           net.point(blending.column(row, k), column);
  }
  return sum;
}

// How far a surface is from another one, at parameters of u and what these are beside on the other: a bound
// for all v, over which both have the same knots.
std::vector<double> apart_m(const Surface& surface, const std::vector<double>& along, const Surface& other,
                            const std::vector<double>& beside) {
  const BlendingMatrix here = blending_matrix(surface.u, along, 0),
                       there = blending_matrix(other.u, beside, 0);
  std::vector<double> apart;
  for (int k = 0; k < here.rows; ++k) {
    double largest = 0.0;
    for (int j = 0; j < surface.net.columns; ++j) {
      largest =
          std::max(largest, (blended(here, k, surface.net, j) - blended(there, k, other.net, j)).norm());
    }
    apart.push_back(largest);
  }
  return apart;
}

// The same surface with the parameters that `before` has on the edge they share.
Result<CompatiblePatches> with_parameters_of(const Surface& before, const Surface& patch, double tolerance_m,
                                             int largest_count, const Progress& progress) {
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  KnotVector knots = before.u;
  for (RoundsDone done(0.3); knots.control_point_count() <= largest_count; done.step()) {
    if (!progress.report(done.fraction())) return Progress::stopped();
    const std::vector<double> looked_at = dense_parameters(knots, looked_at_in_piece);
    const std::vector<double> beside = parameters_beside(a, b, looked_at);
    if (!std::is_sorted(beside.begin(), beside.end())) break;
    const std::vector<double> fitted = dense_parameters(knots, fitted_in_piece);
    auto matched = composed(patch, knots, fitted, parameters_beside(a, b, fitted));
    if (!matched) return matched.error();
    const std::vector<double> apart = apart_m(matched.value(), looked_at, patch, beside);
    std::vector<double> where;
    for (std::size_t k = 0; k < apart.size(); ++k) {
      if (apart[k] > tolerance_m) where.push_back(looked_at[k]);
    }
    if (where.empty()) {
      const std::vector<double> measured = dense_parameters(knots, measured_in_piece);
      const std::vector<double> all =
          apart_m(matched.value(), measured, patch, parameters_beside(a, b, measured));
      return CompatiblePatches{{std::move(matched).value()}, *std::max_element(all.begin(), all.end())};
    }
    auto finer = halve_pieces(knots, where);
    if (!finer) return finer.error();
    if (finer.value() == knots) break;
    knots = std::move(finer).value();
  }
  return Error{"the parameters of its edge cannot be matched within " + short_length_text(tolerance_m) +
               "; allow a larger tolerance"};
}

// Of the tolerance, what bringing knots together may cost.
constexpr double knots_share = 0.05;

// Over the union of their u knots.
Status make_one_structure(std::vector<Surface>& patches, const JoinRequest& request, double& deviation_m) {
  KnotVector all = patches[0].u;
  double moved_m = 0.0;
  for (Surface& patch : patches) {
    MovedKnots near = with_nearly_same_knots(patch, all, knots_share * request.tolerance_m);
    auto both = knot_union(all, near.surface.u);
    if (!both) return both.error();
    all = std::move(both).value();
    patch = std::move(near.surface);
    moved_m = std::max(moved_m, near.deviation_m);
  }
  deviation_m += moved_m;
  if (const int count = all.control_point_count(); count > request.largest_count) {
    return Error{"the patches' knots across make " + std::to_string(count) +
                 " control points together, more than " + std::to_string(request.largest_count) +
                 "; simplify them first, or merge fewer"};
  }
  for (Surface& patch : patches) {
    auto finer = convert_to_finer_knots(patch, Direction::u, all);
    if (!finer) return finer.error();
    patch = std::move(finer).value();
  }
  return {};
}

Result<Surface> with_degrees(const Surface& patch, int degree_u, int degree_v) {
  const auto u = elevate_degree(patch.u, degree_u), v = elevate_degree(patch.v, degree_v);
  if (!u) return u.error();
  if (!v) return v.error();
  const auto along_u = convert_to_finer_knots(patch, Direction::u, u.value());
  if (!along_u) return along_u.error();
  return convert_to_finer_knots(along_u.value(), Direction::v, v.value());
}

// Of the tolerance, how far edges that coincide may be apart, and what matching their parameters may leave.
constexpr double apart_share = 0.75, matching_share = 0.25;

// Whether the edges are one curve run through at other parameters.
bool needs_matching(const Surface& before, const Surface& patch, double tolerance_m) {
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  std::vector<double> along = nested_parameters(a.knots, 4, 0).parameters;
  if (a.knots.is_periodic()) along.pop_back();
  const double length_a = a.knots.domain_end() - a.knots.domain_start();
  const double length_b = b.knots.domain_end() - b.knots.domain_start();
  std::vector<double> same;
  same.reserve(along.size());
  for (const double t : along) {
    same.push_back(b.knots.domain_start() + (t - a.knots.domain_start()) / length_a * length_b);
  }
  const double apart_m = largest_apart_m(a, b, along, parameters_beside(a, b, along));
  return apart_m <= apart_share * tolerance_m &&
         largest_apart_m(a, b, along, same) > apart_m + matching_share * tolerance_m;
}

Status match_parameters(std::vector<Surface>& patches, const JoinRequest& request, double& deviation_m) {
  const double share = 1.0 / static_cast<double>(patches.size());
  for (std::size_t p = 1; p < patches.size(); ++p) {
    const Progress progress =
        request.progress.part(share * static_cast<double>(p - 1), share * static_cast<double>(p));
    if (!progress.report(0.0)) return Progress::stopped();
    if (request.twist != 0.0 && patches[p].u.is_periodic()) continue;
    if (!needs_matching(patches[p - 1], patches[p], request.tolerance_m)) continue;
    auto matched = with_parameters_of(patches[p - 1], patches[p], matching_share * request.tolerance_m,
                                      request.largest_count, progress);
    if (!matched) return Error{name_of(p) + ": " + matched.error().message};
    patches[p] = std::move(matched->patches[0]);
    deviation_m = std::max(deviation_m, matched->deviation_m);
  }
  return {};
}

}  // namespace

Result<CompatiblePatches> compatible_along_v(std::vector<Surface> patches, const JoinRequest& request) {
  SPOONBILL_ASSERT(!patches.empty());
  SPOONBILL_ASSERT(request.continuity >= 0);
  int degree_u = 1, degree_v = request.continuity + 1;
  for (const Surface& patch : patches) {
    degree_u = std::max(degree_u, patch.u.degree());
    degree_v = std::max(degree_v, patch.v.degree());
  }
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (patches[p].u.is_periodic() != patches[0].u.is_periodic()) {
      return Error{name_of(p) + (patches[p].u.is_periodic() ? " is closed around" : " is open around") +
                   " and the first is not; open or close one of them"};
    }
    auto stretched = over_domain_of(patches[0], patches[p]);
    if (!stretched) return stretched.error();
    auto raised = with_degrees(stretched.value(), degree_u, degree_v);
    if (!raised) return Error{name_of(p) + ": " + raised.error().message};
    patches[p] = std::move(raised).value();
    if (p == 0 || !patches[p].u.is_periodic() || request.shared_parameters) continue;
    auto turned = with_seam_beside(patches[p - 1], patches[p], request);
    if (!turned) return Error{name_of(p) + ": " + turned.error().message};
    patches[p] = std::move(turned).value();
  }
  CompatiblePatches result{std::move(patches), 0.0};
  if (!request.shared_parameters) {
    Status status = match_parameters(result.patches, request, result.deviation_m);
    if (!status) return status.error();
  }
  if (Status status = make_one_structure(result.patches, request, result.deviation_m); !status) {
    return status.error();
  }
  return result;
}

}  // namespace spoonbill
