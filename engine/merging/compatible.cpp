#include "engine/merging/compatible.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/constrained_inverse.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/edge_match.h"
#include "engine/number_text.h"

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

Result<Surface> with_seam_beside(const Surface& before, const Surface& patch, double twist) {
  const auto match = match_edges({before, patch}, {0, Side::v_end}, {1, Side::v_start}, false);
  if (!match) return match.error();
  const double period = patch.u.domain_end() - patch.u.domain_start();
  return with_seam_at(patch, Direction::u, match->seam + twist * period);
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

// Where on b's edge each of a's parameters lies; the guess is at an equal share of the way.
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

// Five to a piece; not on the far end of a period.
std::vector<double> dense_parameters(const KnotVector& knots) {
  std::vector<double> dense = nested_parameters(knots, 5, 0).parameters;
  if (knots.is_periodic()) dense.pop_back();
  return dense;
}

struct Matched {
  Surface surface;
  double deviation_m;
};

// The surface with its u replaced by a function of u, given at `dense`, over `knots`.
Result<Matched> composed(const Surface& surface, const KnotVector& knots, const std::vector<double>& dense,
                         const std::vector<double>& beside) {
  const bool open = !knots.is_periodic();
  const auto inverse = constrained_inverse(knots, dense, {{}, open, open});
  if (!inverse) return inverse.error();
  const Eigen::MatrixXd there = blending_matrix(surface.u, beside, 0).dense();
  const Eigen::MatrixXd weights = inverse.value().lazyProduct(there);
  Surface result = mixed_along(surface, Direction::u, weights, knots);
  const Eigen::MatrixXd apart = blending_matrix(knots, dense, 0).dense().lazyProduct(weights) - there;
  double deviation_m = 0.0;
  for (int j = 0; j < surface.net.columns; ++j) {
    for (Eigen::Index k = 0; k < apart.rows(); ++k) {
      Vector3 sum = Vector3::Zero();
      for (int i = 0; i < surface.net.rows; ++i) sum += apart(k, i) * surface.net.point(i, j);
      deviation_m = std::max(deviation_m, sum.norm());
    }
  }
  return Matched{std::move(result), deviation_m};
}

// The same surface with the parameters that `before` has on the edge they share.
Result<Matched> with_parameters_of(const Surface& before, const Surface& patch, double tolerance_m) {
  const EdgeCurve a = edge_curve(before, Side::v_end), b = edge_curve(patch, Side::v_start);
  KnotVector knots = before.u;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const std::vector<double> dense = dense_parameters(knots);
    const std::vector<double> beside = parameters_beside(a, b, dense);
    if (a.knots.is_periodic() ? false : !std::is_sorted(beside.begin(), beside.end())) break;
    auto matched = composed(patch, knots, dense, beside);
    if (!matched) return matched.error();
    if (matched->deviation_m <= tolerance_m) return matched;
    auto finer = with_pieces_halved(knots, dense);
    if (!finer) return finer.error();
    knots = std::move(finer).value();
  }
  return Error{"the parameters of its edge cannot be matched within " + short_length_text(tolerance_m) +
               "; allow a larger tolerance"};
}

double edge_gap_m(const Surface& before, const Surface& patch) {
  double largest = 0.0;
  for (int i = 0; i < before.net.rows; ++i) {
    largest = std::max(largest, (before.net.point(i, before.net.columns - 1) - patch.net.point(i, 0)).norm());
  }
  return largest;
}

// Over the union of their u knots.
Status make_one_structure(std::vector<Surface>& patches) {
  KnotVector all = patches[0].u;
  for (const Surface& patch : patches) {
    auto both = knot_union(all, patch.u);
    if (!both) return both.error();
    all = std::move(both).value();
  }
  for (Surface& patch : patches) {
    auto finer = over_finer_knots(patch, Direction::u, all);
    if (!finer) return finer.error();
    patch = std::move(finer).value();
  }
  return {};
}

Result<Surface> with_degrees(const Surface& patch, int degree_u, int degree_v) {
  const auto u = elevated(patch.u, degree_u), v = elevated(patch.v, degree_v);
  if (!u) return u.error();
  if (!v) return v.error();
  const auto along_u = over_finer_knots(patch, Direction::u, u.value());
  if (!along_u) return along_u.error();
  return over_finer_knots(along_u.value(), Direction::v, v.value());
}

Status match_parameters(std::vector<Surface>& patches, double tolerance_m, double& deviation_m) {
  for (std::size_t p = 1; p < patches.size(); ++p) {
    std::vector<Surface> pair{patches[p - 1], patches[p]};
    if (Status status = make_one_structure(pair); !status) return status;
    const auto match = match_edges(pair, {0, Side::v_end}, {1, Side::v_start}, false);
    if (!match) return match.error();
    if (match->mean_gap_m > tolerance_m || edge_gap_m(pair[0], pair[1]) <= tolerance_m) continue;
    auto matched = with_parameters_of(patches[p - 1], patches[p], tolerance_m);
    if (!matched) return Error{name_of(p) + ": " + matched.error().message};
    patches[p] = std::move(matched->surface);
    deviation_m = std::max(deviation_m, matched->deviation_m);
  }
  return {};
}

}  // namespace

Result<CompatiblePatches> compatible_along_v(std::vector<Surface> patches, double tolerance_m, int degree_v,
                                             double twist) {
  int degree_u = 1;
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
    if (p == 0 || !patches[p].u.is_periodic()) continue;
    auto turned = with_seam_beside(patches[p - 1], patches[p], twist);
    if (!turned) return Error{name_of(p) + ": " + turned.error().message};
    patches[p] = std::move(turned).value();
  }
  CompatiblePatches result{std::move(patches), 0.0};
  if (Status status = match_parameters(result.patches, 0.25 * tolerance_m, result.deviation_m); !status) {
    return status.error();
  }
  if (Status status = make_one_structure(result.patches); !status) return status.error();
  return result;
}

}  // namespace spoonbill
