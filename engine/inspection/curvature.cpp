#include "engine/inspection/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/assert.h"
#include "engine/bspline/collapsed_edges.h"

namespace spoonbill {
namespace {

// Fractions of a polynomial piece that its cells do not cover: `off_knots` next to each knot, `off_poles`
// next to a collapsed edge.
constexpr double off_knots = 1e-6;
constexpr double off_poles = 1e-2;
// Largest number of cells in which the minimum is refined. They are the cells with the smallest values.
constexpr std::size_t searched = 12;
constexpr std::size_t cells_between_reports = 256;
// Number of times that the pattern search halves its step.
constexpr int halvings = 24;

struct Candidate {
  ParameterMinimum minimum;
  PieceCell cell;
};

ParameterMinimum find_best_in_cell(const PieceCell& cell,
                                   const std::function<double(double, double)>& value) {
  ParameterMinimum best{0.0, 0.0, std::numeric_limits<double>::infinity()};
  const std::array<std::array<double, 2>, 5> points = {{{cell.centre_u(), cell.centre_v()},
                                                        {cell.u0, cell.v0},
                                                        {cell.u0, cell.v1},
                                                        {cell.u1, cell.v0},
                                                        {cell.u1, cell.v1}}};
  for (const auto& [u, v] : points) {
    const double here = value(u, v);
    if (here < best.value) best = {u, v, here};
  }
  return best;
}

// Searches for a minimum within the cell by a pattern search. Each step moves to the best of the eight
// neighbours of the present point. If no neighbour is better, the step halves their distance instead.
ParameterMinimum search_cell(Candidate from, const std::function<double(double, double)>& value) {
  double step_u = 0.5 * (from.cell.u1 - from.cell.u0), step_v = 0.5 * (from.cell.v1 - from.cell.v0);
  for (int halving = 0; halving < halvings;) {
    ParameterMinimum best = from.minimum;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const double u = std::clamp(from.minimum.u + i * step_u, from.cell.u0, from.cell.u1);
        const double v = std::clamp(from.minimum.v + j * step_v, from.cell.v0, from.cell.v1);
        const double here = value(u, v);
        if (here < best.value) best = {u, v, here};
      }
    }
    if (best.value < from.minimum.value) {
      from.minimum = best;
      continue;
    }
    step_u *= 0.5;
    step_v *= 0.5;
    ++halving;
  }
  return from.minimum;
}

std::vector<std::array<double, 2>> intervals(const Surface& surface, bool of_u, int parts) {
  std::vector<std::array<double, 2>> result;
  const KnotVector& knots = of_u ? surface.u : surface.v;
  const std::vector<double> ends = knots.breakpoints();
  const auto off_end = [&](bool last) {
    const bool is_pole =
        !knots.is_periodic() && is_collapsed(surface.net, find_edge(surface.net, of_u, last));
    return is_pole ? off_poles : off_knots;
  };
  const double off_first = off_end(false), off_last = off_end(true);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double whole = ends[k + 1] - ends[k];
    const double start = ends[k] + (k == 0 ? off_first : off_knots) * whole;
    const double end = ends[k + 1] - (k + 2 == ends.size() ? off_last : off_knots) * whole;
    for (int p = 0; p < parts; ++p) {
      result.push_back({start + (end - start) * p / parts, start + (end - start) * (p + 1) / parts});
    }
  }
  return result;
}

}  // namespace

std::vector<PieceCell> piece_cells(const Surface& surface, int parts) {
  SPOONBILL_ASSERT(parts >= 1);
  std::vector<PieceCell> cells;
  const auto in_v = intervals(surface, false, parts);
  for (const auto& [u0, u1] : intervals(surface, true, parts)) {
    for (const auto& [v0, v1] : in_v) cells.push_back({u0, u1, v0, v1});
  }
  return cells;
}

ParameterMinimum find_minimum(const std::vector<PieceCell>& cells,
                              const std::function<double(double u, double v)>& value,
                              const Progress& progress) {
  SPOONBILL_ASSERT(static_cast<bool>(value));
  const ParameterMinimum none{0.0, 0.0, std::numeric_limits<double>::infinity()};
  std::vector<Candidate> candidates;
  candidates.reserve(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (k % cells_between_reports == 0 &&
        !progress.report(static_cast<double>(k) / static_cast<double>(cells.size()))) {
      return none;
    }
    const ParameterMinimum best = find_best_in_cell(cells[k], value);
    if (std::isfinite(best.value)) candidates.push_back({best, cells[k]});
  }
  if (candidates.empty()) return none;
  const std::size_t count = std::min(searched, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end(), [](const Candidate& a, const Candidate& b) {
                      if (a.minimum.value != b.minimum.value) return a.minimum.value < b.minimum.value;
                      return a.cell.u0 != b.cell.u0 ? a.cell.u0 < b.cell.u0 : a.cell.v0 < b.cell.v0;
                    });
  ParameterMinimum least = candidates[0].minimum;
  for (std::size_t k = 0; k < count; ++k) {
    const ParameterMinimum found = search_cell(candidates[k], value);
    if (found.value < least.value) least = found;
  }
  return least;
}

namespace {

constexpr int samples_per_span = 3;
// Smallest |du x dv|, as a fraction of |du| |dv|, that is more than rounding.
constexpr double min_relative_area = 1e-9;

}  // namespace

// Computes the curvatures from the first and second fundamental forms (do Carmo 1976, section 3.3).
std::optional<PrincipalCurvatures> compute_principal_curvatures(const SurfacePoint& point) {
  const Vector3 product = point.du.cross(point.dv);
  const double area = product.norm();
  if (!(area > min_relative_area * point.du.norm() * point.dv.norm())) return std::nullopt;
  const Vector3 inward = -product / area;
  const double e = point.du.dot(point.du), f = point.du.dot(point.dv);
  const double l = point.duu.dot(inward), m = point.duv.dot(inward), n = point.dvv.dot(inward);
  // An orthonormal frame of the tangent plane keeps precision if the scales of u and v are very different.
  const double along = std::sqrt(e), across = area / along;
  const double a = l / e, b = (m - f / e * l) / (along * across);
  const double c = (n - 2.0 * f / e * m + f / e * f / e * l) / (across * across);
  const double mean = 0.5 * (a + c), spread = std::hypot(0.5 * (a - c), b);
  return PrincipalCurvatures{mean - spread, mean + spread};
}

namespace {

// Largest extent of a surface that counts as a point. Such an extent may be due to the rounding of
// coordinates.
constexpr double least_size_m = 1e-9;

// Returns the curvatures at a point of a surface of the given size. Returns nothing where a derivative
// consists of rounding errors, or where the radius of curvature is below the length of a collapsed edge, as
// at a cusp.
std::optional<PrincipalCurvatures> physical_curvatures(const Surface& surface, const SurfacePoint& point,
                                                       double size_m) {
  constexpr double least_relative_speed = 1e-9;
  const double slowest_m =
      std::min(point.du.norm() * surface.u.domain_length(), point.dv.norm() * surface.v.domain_length());
  if (!(slowest_m > least_relative_speed * size_m)) return std::nullopt;
  const auto found = compute_principal_curvatures(point);
  if (!found) return std::nullopt;
  const double sharpest = std::max(std::abs(found->smallest), std::abs(found->largest));
  return sharpest * size_m * collapsed_edge_fraction <= 1.0 ? found : std::nullopt;
}

}  // namespace

CurvatureRange find_curvature_range(const Surface& surface, const TrimmedArea& area,
                                    const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const std::vector<PieceCell> cells = piece_cells(surface, samples_per_span);
  const double size_m = bounding_box(surface.net).size();
  if (!(size_m > least_size_m)) return {};
  const auto extreme = [&](bool largest) -> std::optional<CurvatureExtreme> {
    const auto value = [&](double u, double v) {
      constexpr double none = std::numeric_limits<double>::infinity();
      if (!area.contains(u, v)) return none;
      const auto found = physical_curvatures(surface, evaluate(surface, u, v), size_m);
      if (!found) return none;
      return largest ? -found->largest : found->smallest;
    };
    const ParameterMinimum found =
        find_minimum(cells, value, largest ? progress.part(0.5, 1.0) : progress.part(0.0, 0.5));
    if (!std::isfinite(found.value)) return std::nullopt;
    return CurvatureExtreme{largest ? -found.value : found.value, found.u, found.v,
                            position(surface, found.u, found.v)};
  };
  const auto smallest = extreme(false), largest = extreme(true);
  if (!smallest || !largest) return {};
  return {*smallest, *largest, true};
}

double compute_bending_energy(const Surface& surface, const TrimmedArea& area) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const double size_m = bounding_box(surface.net).size();
  if (!(size_m > least_size_m)) return 0.0;
  double sum = 0.0;
  for (const PieceCell& cell : piece_cells(surface, 2 * samples_per_span)) {
    if (!area.contains(cell.centre_u(), cell.centre_v())) continue;
    // The midpoint rule is used because the integrand is not smooth at knots, poles and trims.
    const SurfacePoint point = evaluate(surface, cell.centre_u(), cell.centre_v());
    const auto found = physical_curvatures(surface, point, size_m);
    if (!found) continue;
    const double squares = found->smallest * found->smallest + found->largest * found->largest;
    sum += squares * point.du.cross(point.dv).norm() * (cell.u1 - cell.u0) * (cell.v1 - cell.v0);
  }
  return sum;
}

}  // namespace spoonbill
