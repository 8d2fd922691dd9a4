#include "engine/merging/compatible_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/arrangement.h"

namespace spoonbill {
namespace {

// Returns the distinct knots. For a periodic direction, the end of the period is omitted.
std::vector<double> distinct_knots(const KnotVector& knots) {
  std::vector<double> all = knots.breakpoints();
  if (knots.is_periodic()) all.pop_back();
  return all;
}

double nearer(double a, double b) {
  return std::abs(a) <= std::abs(b) ? a : b;
}

double nearest_to(const std::vector<double>& sorted, double knot) {
  const auto after = std::lower_bound(sorted.begin(), sorted.end(), knot);
  if (after == sorted.begin()) return *after;
  if (after == sorted.end()) return sorted.back();
  return std::abs(*after - knot) < std::abs(after[-1] - knot) ? *after : after[-1];
}

// Returns pairs of knots: an inner knot of `from`, and the knot of `to` that it nearly equals. A knot of
// `from` is omitted if another knot of `from` is nearer to the same knot of `to`.
std::vector<std::pair<double, double>> find_moves(const KnotVector& from, const KnotVector& to) {
  const std::vector<double> own = from.breakpoints(), targets = to.breakpoints();
  const double reach = snap_fraction * from.domain_length();
  std::vector<std::pair<double, double>> moves;
  for (std::size_t k = 1; k + 1 < own.size(); ++k) {
    const double target = nearest_to(targets, own[k]);
    const bool is_end = target == targets.front() || target == targets.back();
    if (is_end || target == own[k] || std::abs(target - own[k]) > reach) continue;
    if (nearest_to(own, target) == own[k]) moves.emplace_back(own[k], target);
  }
  return moves;
}

}  // namespace

double align_seam_to_knots(const KnotVector& first, const KnotVector& second, double seam) {
  SPOONBILL_ASSERT(first.is_periodic() && second.is_periodic());
  const double length = second.domain_length();
  const auto wrapped_distance = [&](double at_second, double at_first) {
    const double step = (at_second - seam) - (at_first - first.domain_start());
    return step - length * std::round(step / length);
  };
  const std::vector<double> at_first = distinct_knots(first), at_second = distinct_knots(second);
  double at_seam = std::numeric_limits<double>::infinity(), anywhere = at_seam;
  for (const double b : at_second) {
    at_seam = nearer(at_seam, wrapped_distance(b, first.domain_start()));
    for (const double a : at_first) anywhere = nearer(anywhere, wrapped_distance(b, a));
  }
  const double reach = snap_fraction * length;
  if (std::abs(at_seam) <= reach) return seam + at_seam;
  return std::abs(anywhere) <= reach ? seam + anywhere : seam;
}

SnappedKnots snap_knots(const Surface& surface, const KnotVector& knots, double most_m) {
  const auto moves = find_moves(surface.u, knots);
  if (moves.empty()) return {surface, 0.0};
  std::vector<double> moved = surface.u.knots();
  for (double& knot : moved) {
    const auto move =
        std::find_if(moves.begin(), moves.end(), [&](const auto& pair) { return pair.first == knot; });
    if (move != moves.end()) knot = move->second;
  }
  auto u = surface.u.is_periodic() ? KnotVector::periodic(surface.u.degree(), std::move(moved))
                                   : KnotVector::open(surface.u.degree(), std::move(moved));
  if (!u) return {surface, 0.0};
  SnappedKnots result{{std::move(u).value(), surface.v, surface.net}, 0.0};
  constexpr int samples_in_piece = 5;
  result.deviation_m = largest_deviation_m(
      result.surface,
      sample_grid_points(surface, nested_parameters(surface.u, samples_in_piece, 0).parameters,
                         nested_parameters(surface.v, samples_in_piece, 0).parameters));
  return result.deviation_m <= most_m ? result : SnappedKnots{surface, 0.0};
}

namespace {

std::string patch_name(std::size_t patch) {
  return "patch " + std::to_string(patch + 1) + " of the row";
}

// Changes the patch's u domain to the u domain of the first patch. A domain that is already equal is not
// changed, which avoids rounding errors.
Result<Surface> match_domain(const Surface& first, const Surface& patch) {
  const double start = first.u.domain_start(), end = first.u.domain_end();
  if (patch.u.domain_start() == start && patch.u.domain_end() == end) return patch;
  return with_domain(patch, Direction::u, start, end);
}

// Returns the parameter of the curve's point nearest to `point`, starting from the guess.
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

// Returns, for each parameter of `a` in `along`, the parameter of the nearest point of `b`. The search starts
// from points at equal fractions of the length. Both curves must be open or have seams close to each other.
std::vector<double> corresponding_parameters(const EdgeCurve& a, const EdgeCurve& b,
                                             const std::vector<double>& along) {
  constexpr int steps = 129;
  const EdgeSamples samples_a = edge_samples(a, steps), samples_b = edge_samples(b, steps);
  std::vector<double> matching;
  for (const double t : along) {
    const auto after = std::upper_bound(samples_a.parameters.begin(), samples_a.parameters.end(), t);
    const std::size_t k = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - samples_a.parameters.begin() - 1, 0, steps - 1));
    matching.push_back(nearest_parameter(b, position(a, t), samples_b.parameters[k]));
  }
  if (!a.knots.is_periodic()) {
    matching.front() = b.knots.domain_start();
    matching.back() = b.knots.domain_end();
  }
  return matching;
}

// Returns the largest distance between the points of curve `a` at the parameters `along` and the
// corresponding points of curve `b` at the parameters `matching`.
double largest_distance_m(const EdgeCurve& a, const EdgeCurve& b, const std::vector<double>& along,
                          const std::vector<double>& matching) {
  double largest = 0.0;
  for (std::size_t k = 0; k < along.size(); ++k) {
    largest = std::max(largest, (position(a, along[k]) - position(b, matching[k])).norm());
  }
  return largest;
}

// Returns the parameter of the ring's point nearest to `point`. The search starts from the nearest sample.
double nearest_on_ring(const EdgeCurve& ring, const Vector3& point) {
  const std::vector<double> parameters = nested_parameters(ring.knots, 16, 0).parameters;
  const auto distance = [&](double t) { return (position(ring, t) - point).squaredNorm(); };
  const double guess = *std::min_element(parameters.begin(), parameters.end(),
                                         [&](double a, double b) { return distance(a) < distance(b); });
  return nearest_parameter(ring, point, guess);
}

Result<Surface> align_seam(const Surface& before, const Surface& patch, const JoinRequest& request) {
  const auto match = match_edges({before, patch}, {0, Side::v_end}, {1, Side::v_start}, false);
  if (!match) return match.error();
  double seam = match->seam;
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  const Vector3 seam_point = position(a, a.knots.domain_start());
  const double nearest = nearest_on_ring(b, seam_point);
  // Let p be the point of this ring that is nearest to the previous ring's seam. If the distance is within a
  // limit, p becomes the seam of this ring instead of the best fit. The limit is the tolerance if the rings
  // do not touch, and this fraction of the tolerance if they touch. The best fit differs from p if the rings
  // have different parameters or, by rounding, if the rings are identical and have corners.
  constexpr double coincidence_fraction = 1e-6;
  const double near_m =
      request.tolerance_m * (match->gap_m > request.tolerance_m ? 1.0 : coincidence_fraction);
  if ((position(b, nearest) - seam_point).norm() <= near_m) seam = nearest;
  const double period = patch.u.domain_length();
  const double target = seam + request.twist * period;
  return with_seam_at(patch, Direction::u, align_seam_to_knots(before.u, patch.u, target));
}

// Numbers of samples in each polynomial piece: for fitting, for finding where knots are needed, and for
// measuring.
constexpr int fitted_per_piece = 5, checked_per_piece = 10, measured_per_piece = 40;

// Returns parameters that are evenly spaced in each polynomial piece. In a periodic direction, the end of the
// period is omitted.
std::vector<double> dense_parameters(const KnotVector& knots, int per_piece) {
  std::vector<double> dense = nested_parameters(knots, per_piece, 0).parameters;
  if (knots.is_periodic()) dense.pop_back();
  return dense;
}

// Returns the surface reparameterised along u, over `knots`. The new parameters `fitted` correspond to the
// parameters `matching` of the given surface.
Result<Surface> compose(const Surface& surface, const KnotVector& knots, const std::vector<double>& fitted,
                        const std::vector<double>& matching) {
  const bool open = !knots.is_periodic();
  const auto inverse = constrained_inverse(knots, fitted, {{}, open, open});
  if (!inverse) return inverse.error();
  const Eigen::MatrixXd weights =
      inverse.value().lazyProduct(blending_matrix(surface.u, matching, 0).dense());
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

// Returns an upper bound for each pair of corresponding parameters u. Points of the two surfaces at these
// parameters and at equal v are no farther apart than the bound. The surfaces must have equal v knots.
std::vector<double> distances_m(const Surface& surface, const std::vector<double>& along,
                                const Surface& other, const std::vector<double>& matching) {
  const BlendingMatrix own = blending_matrix(surface.u, along, 0),
                       others = blending_matrix(other.u, matching, 0);
  std::vector<double> distances;
  for (int k = 0; k < own.rows; ++k) {
    double largest = 0.0;
    for (int j = 0; j < surface.net.columns; ++j) {
      largest =
          std::max(largest, (blended(own, k, surface.net, j) - blended(others, k, other.net, j)).norm());
    }
    distances.push_back(largest);
  }
  return distances;
}

// Reparameterises the patch so that it has the parameters of `before` on the shared edge.
Result<CompatiblePatches> match_parameters_to(const Surface& before, const Surface& patch, double tolerance_m,
                                              int largest_count, const Progress& progress) {
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  KnotVector knots = before.u;
  for (RoundsDone done(0.3); knots.control_point_count() <= largest_count; done.step()) {
    if (!progress.report(done.fraction())) return Progress::stopped();
    const std::vector<double> checked = dense_parameters(knots, checked_per_piece);
    const std::vector<double> matching = corresponding_parameters(a, b, checked);
    if (!std::is_sorted(matching.begin(), matching.end())) break;
    const std::vector<double> fitted = dense_parameters(knots, fitted_per_piece);
    auto matched = compose(patch, knots, fitted, corresponding_parameters(a, b, fitted));
    if (!matched) return matched.error();
    const std::vector<double> distances = distances_m(matched.value(), checked, patch, matching);
    std::vector<double> where;
    for (std::size_t k = 0; k < distances.size(); ++k) {
      if (distances[k] > tolerance_m) where.push_back(checked[k]);
    }
    if (where.empty()) {
      const std::vector<double> measured = dense_parameters(knots, measured_per_piece);
      const std::vector<double> all =
          distances_m(matched.value(), measured, patch, corresponding_parameters(a, b, measured));
      return CompatiblePatches{{std::move(matched).value()}, *std::max_element(all.begin(), all.end())};
    }
    auto finer = halve_pieces(knots, where);
    if (!finer) return finer.error();
    if (finer.value() == knots) break;
    knots = std::move(finer).value();
  }
  return Error(ErrorCode::not_converged,
               "its edge cannot be reparameterised to match the other edge within " +
                   short_length_text(tolerance_m) + "; allow a larger tolerance",
               "tolerance");
}

// Fraction of the tolerance that may be used for snapping knots.
constexpr double knots_fraction = 0.05;

// Refines all patches to the union of their u knots.
Status unify_knots(std::vector<Surface>& patches, const JoinRequest& request, double& deviation_m) {
  KnotVector all = patches[0].u;
  double moved_m = 0.0;
  for (Surface& patch : patches) {
    SnappedKnots near = snap_knots(patch, all, knots_fraction * request.tolerance_m);
    auto both = knot_union(all, near.surface.u);
    if (!both) return both.error();
    all = std::move(both).value();
    patch = std::move(near.surface);
    moved_m = std::max(moved_m, near.deviation_m);
  }
  deviation_m += moved_m;
  if (const int count = all.control_point_count(); count > request.largest_count) {
    return Error(ErrorCode::too_many, "the patches' combined knots need " + std::to_string(count) +
                                          " control points across the row, more than " +
                                          std::to_string(request.largest_count) +
                                          "; simplify them first, or merge fewer");
  }
  for (Surface& patch : patches) {
    auto finer = convert_to_finer_knots(patch, Direction::u, all);
    if (!finer) return finer.error();
    patch = std::move(finer).value();
  }
  return {};
}

Result<Surface> elevate(const Surface& patch, int degree_u, int degree_v) {
  const auto u = elevate_degree(patch.u, degree_u), v = elevate_degree(patch.v, degree_v);
  if (!u) return u.error();
  if (!v) return v.error();
  const auto along_u = convert_to_finer_knots(patch, Direction::u, u.value());
  if (!along_u) return along_u.error();
  return convert_to_finer_knots(along_u.value(), Direction::v, v.value());
}

// Fractions of the tolerance: the largest distance between edges that count as shared, and the largest error
// that may remain where shared edges have different parameters.
constexpr double distance_fraction = 0.75, matching_fraction = 0.25;

// Returns true if the two edges are one curve in space but have different parameters.
bool needs_matching(const Surface& before, const Surface& patch, double tolerance_m) {
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  std::vector<double> along = nested_parameters(a.knots, 4, 0).parameters;
  if (a.knots.is_periodic()) along.pop_back();
  const double length_a = a.knots.domain_length();
  const double length_b = b.knots.domain_length();
  std::vector<double> proportional;
  proportional.reserve(along.size());
  for (const double t : along) {
    proportional.push_back(b.knots.domain_start() + (t - a.knots.domain_start()) / length_a * length_b);
  }
  const double distances_m = largest_distance_m(a, b, along, corresponding_parameters(a, b, along));
  return distances_m <= distance_fraction * tolerance_m &&
         largest_distance_m(a, b, along, proportional) > distances_m + matching_fraction * tolerance_m;
}

Status match_parameters(std::vector<Surface>& patches, const JoinRequest& request, double& deviation_m) {
  const double fraction = 1.0 / static_cast<double>(patches.size());
  for (std::size_t p = 1; p < patches.size(); ++p) {
    const Progress progress =
        request.progress.part(fraction * static_cast<double>(p - 1), fraction * static_cast<double>(p));
    if (!progress.report(0.0)) return Progress::stopped();
    if (request.twist != 0.0 && patches[p].u.is_periodic()) continue;
    if (!needs_matching(patches[p - 1], patches[p], request.tolerance_m)) continue;
    auto matched = match_parameters_to(patches[p - 1], patches[p], matching_fraction * request.tolerance_m,
                                       request.largest_count, progress);
    if (!matched) return matched.error().in(patch_name(p));
    patches[p] = std::move(matched->patches[0]);
    deviation_m = std::max(deviation_m, matched->deviation_m);
  }
  return {};
}

}  // namespace

Result<CompatiblePatches> make_compatible(std::vector<Surface> patches, const JoinRequest& request) {
  SPOONBILL_ASSERT(!patches.empty());
  SPOONBILL_ASSERT(request.continuity >= 0);
  int degree_u = 1, degree_v = request.continuity + 1;
  for (const Surface& patch : patches) {
    degree_u = std::max(degree_u, patch.u.degree());
    degree_v = std::max(degree_v, patch.v.degree());
  }
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (patches[p].u.is_periodic() != patches[0].u.is_periodic()) {
      return Error(ErrorCode::mismatch,
                   patch_name(p) +
                       (patches[p].u.is_periodic() ? " has a closed ring as its edge" : " has an open edge") +
                       " and the first has not; open or close one of them");
    }
    auto stretched = match_domain(patches[0], patches[p]);
    if (!stretched) return stretched.error();
    auto raised = elevate(stretched.value(), degree_u, degree_v);
    if (!raised) return raised.error().in(patch_name(p));
    patches[p] = std::move(raised).value();
    if (p == 0 || !patches[p].u.is_periodic() || request.shared_parameters) continue;
    auto aligned = align_seam(patches[p - 1], patches[p], request);
    if (!aligned) return aligned.error().in(patch_name(p));
    patches[p] = std::move(aligned).value();
  }
  CompatiblePatches result{std::move(patches), 0.0};
  if (!request.shared_parameters) {
    Status status = match_parameters(result.patches, request, result.deviation_m);
    if (!status) return status.error();
  }
  if (Status status = unify_knots(result.patches, request, result.deviation_m); !status) {
    return status.error();
  }
  return result;
}

}  // namespace spoonbill
