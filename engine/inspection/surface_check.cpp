#include "engine/inspection/surface_check.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/collapsed_edges.h"
#include "engine/bspline/knot_vector.h"
#include "engine/collision/surfaces/surface_self_collider.h"

namespace spoonbill {
namespace {

constexpr int edge_samples = 512;

// Compares the two ends of u (edges along v) if `along_u` is true, otherwise the two ends of v.
EdgeGap measure_edge_gap(const Surface& surface, bool along_u) {
  EdgeGap gap;
  const KnotVector& knots = along_u ? surface.u : surface.v;
  if (knots.is_periodic()) return gap;
  const KnotVector& across = along_u ? surface.v : surface.u;
  const auto point = [&](double end, double fraction) {
    const double t = across.parameter_at(fraction);
    return along_u ? position(surface, end, t) : position(surface, t, end);
  };
  const Vector3 first_start = point(knots.domain_start(), 0.0), last_start = point(knots.domain_end(), 0.0);
  for (int k = 0; k <= edge_samples; ++k) {
    const double fraction = static_cast<double>(k) / edge_samples;
    const Vector3 first = point(knots.domain_start(), fraction), last = point(knots.domain_end(), fraction);
    gap.apart_m = std::max(gap.apart_m, (first - last).norm());
    gap.first_width_m = std::max(gap.first_width_m, (first - first_start).norm());
    gap.last_width_m = std::max(gap.last_width_m, (last - last_start).norm());
  }
  return gap;
}

bool is_closed_around(const EdgeGap& gap) {
  return gap.apart_m <= closing_tolerance_m;
}

bool ends_in_poles(const EdgeGap& gap) {
  return gap.first_width_m <= closing_tolerance_m && gap.last_width_m <= closing_tolerance_m;
}

double find_widest_end(const EdgeGap& gap) {
  return is_closed_around(gap) ? 0.0 : std::max(gap.first_width_m, gap.last_width_m);
}

}  // namespace

Closing find_closing(const Surface& surface) {
  Closing closing;
  closing.u = measure_edge_gap(surface, true);
  closing.v = measure_edge_gap(surface, false);
  const bool around_u = is_closed_around(closing.u), around_v = is_closed_around(closing.v);
  const bool solid =
      (around_u && (around_v || ends_in_poles(closing.v))) || (around_v && ends_in_poles(closing.u));
  closing.closedness = solid                  ? Closedness::solid
                       : around_u || around_v ? Closedness::tube
                                              : Closedness::sheet;
  if (solid) return closing;
  closing.gap_m = around_u   ? find_widest_end(closing.v)
                  : around_v ? find_widest_end(closing.u)
                             : std::min(std::max(closing.u.apart_m, find_widest_end(closing.v)),
                                        std::max(closing.v.apart_m, find_widest_end(closing.u)));
  return closing;
}

namespace {

// Number of cells in each direction of a polynomial piece.
constexpr int cells_per_span = 4;
// Smallest |du x dv| that is not a defect, as a fraction of its mean over the surface.
constexpr double min_area_ratio = 1e-7;
constexpr std::size_t max_defects = 16;
// Number of control points above which elements are not halved in the search for self-intersections. Halved
// elements reveal smaller loops; the elements of larger nets are small enough.
constexpr std::size_t large_net = 2500;

// Determines which neighbouring cells along one direction belong to the same smooth sheet. Sheets are
// separated by an edge, at a knot whose multiplicity is at least the degree; they may meet there at any
// angle.
class SmoothNeighbours {
 public:
  explicit SmoothNeighbours(const KnotVector& knots) {
    // Each entry is the knot at the start of a piece. The first entry is also the end of the last piece. In
    // an open direction the first knot counts as clamped, so the surface is not smooth after the last piece.
    const std::vector<KnotMultiplicity> starts = knot_multiplicities(knots);
    for (std::size_t piece = 0; piece < starts.size(); ++piece) {
      smooth_after_.push_back(starts[(piece + 1) % starts.size()].multiplicity < knots.degree());
    }
  }

  std::size_t cells() const { return cells_per_span * smooth_after_.size(); }
  // Returns whether `cell` and next(cell) belong to the same sheet.
  bool is_smooth_after(std::size_t cell) const {
    return (cell + 1) % cells_per_span != 0 || smooth_after_[cell / cells_per_span];
  }
  // Returns the index of the next cell; the first cell follows the last.
  std::size_t next(std::size_t cell) const { return cell + 1 < cells() ? cell + 1 : 0; }

 private:
  // One flag for each piece: true if the surface is smooth across the piece's end.
  std::vector<bool> smooth_after_;
};

// Detects flips of the normal on the straight line between two parameter pairs, from steps along the line. If
// the steps are refined, a flip remains, unlike a fast turn of the normal about a tight rim.
class NormalFlips {
 public:
  NormalFlips(const Surface& surface, double least_area) : surface_(surface), least_area_(least_area) {}

  bool between(const PieceCell& from, const PieceCell& to) const {
    // The line may cross the seam of a periodic direction.
    const double u = from.centre_u(), v = from.centre_v();
    return flips_between({u, v}, {unwrap(surface_.u, u, to.centre_u()), unwrap(surface_.v, v, to.centre_v())},
                         refinements);
  }

 private:
  using Parameters = Eigen::Vector2d;
  static constexpr int steps = 6, refinements = 2;

  static double unwrap(const KnotVector& knots, double from, double to) {
    return to < from ? to + knots.domain_end() - knots.domain_start() : to;
  }

  bool flips_between(const Parameters& from, const Parameters& to, int refinements_left) const {
    Vector3 before = product(from);
    Parameters since = from;
    for (int step = 1; step <= steps; ++step) {
      const Parameters point = from + (to - from) * step / steps;
      const Vector3 here = product(point);
      // On the fold itself the normal has no direction, so this point is skipped.
      if (here.norm() < least_area_ && step < steps) continue;
      const bool turns = before.dot(here) < 0.0;
      if (turns && (refinements_left == 1 || flips_between(since, point, refinements_left - 1))) return true;
      before = here;
      since = point;
    }
    return false;
  }

  Vector3 product(const Parameters& at) const {
    const SurfacePoint point =
        evaluate(surface_, surface_.u.into_domain(at.x()), surface_.v.into_domain(at.y()));
    return point.du.cross(point.dv);
  }

  const Surface& surface_;
  double least_area_;
};

// Finds cells with a degenerate centre, and pairs of neighbouring cells between which the normal flips.
void find_defects(const Surface& surface, const TrimmedArea& area, SurfaceCheck& check) {
  const std::vector<PieceCell> cells = piece_cells(surface, cells_per_span);
  std::vector<Vector3> products;
  double mean = 0.0;
  for (const PieceCell& cell : cells) {
    const SurfacePoint point = evaluate(surface, cell.centre_u(), cell.centre_v());
    products.push_back(point.du.cross(point.dv));
    mean += products.back().norm() / static_cast<double>(cells.size());
  }
  const SmoothNeighbours along_u(surface.u), along_v(surface.v);
  const NormalFlips normal_flips(surface, min_area_ratio * mean);
  const auto index = [&](std::size_t i, std::size_t j) { return i * along_v.cells() + j; };
  const auto is_inside = [&](std::size_t k) {
    return area.contains(cells[k].centre_u(), cells[k].centre_v());
  };
  const auto flips_towards = [&](std::size_t k, std::size_t other) {
    return is_inside(other) && products[k].dot(products[other]) < 0.0 &&
           normal_flips.between(cells[k], cells[other]);
  };
  for (std::size_t k = 0; k < cells.size() && check.surface_defects.size() < max_defects; ++k) {
    if (!is_inside(k)) continue;
    const std::size_t i = k / along_v.cells(), j = k % along_v.cells();
    const bool shrinks = !(products[k].norm() > min_area_ratio * mean);
    const bool folds = (along_v.is_smooth_after(j) && flips_towards(k, index(i, along_v.next(j)))) ||
                       (along_u.is_smooth_after(i) && flips_towards(k, index(along_u.next(i), j)));
    if (!shrinks && !folds) continue;
    const double u = cells[k].centre_u(), v = cells[k].centre_v();
    check.surface_defects.push_back({u, v, position(surface, u, v), !shrinks});
  }
}

void find_self_intersections(const Surface& surface, const TrimmedArea& area, const Progress& progress,
                             SurfaceCheck& check) {
  const auto grid = make_nested_grid(surface.u, surface.v, surface.net.size() > large_net ? 0 : 1);
  if (!grid) {
    check.self_intersections_complete = false;
    return;
  }
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = check.closing.closedness == Closedness::solid;
  query.progress = progress;
  check.self_intersections_complete = !collider.collide(surface, query).overflow;
  for (const PairContact& contact : collider.contacts()) {
    const PairParameters& at = contact.pair.at;
    if (!area.contains(at.u, at.v) || !area.contains(at.s, at.t)) continue;
    check.self_intersections.push_back(
        {at.u, at.v, at.s, at.t, contact.depth_m, position(surface, at.u, at.v)});
  }
}

}  // namespace

std::optional<SurfaceCheck> check_surface(const Surface& given, const TrimmedArea& area,
                                          const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(given));
  Surface surface = given;
  join_collapsed_edges(surface);
  bool continues = true;
  const Progress watched([&](double fraction) { return continues = continues && progress.report(fraction); });
  SurfaceCheck check;
  check.closing = find_closing(surface);
  check.is_trimmed = !area.is_whole();
  check.mass = compute_enclosed_mass(surface, area);
  if (!watched.report(0.05)) return std::nullopt;
  check.curvature = find_curvature_range(surface, area, watched.part(0.05, 0.4));
  if (!continues) return std::nullopt;
  check.bending = compute_bending_energy(surface, area);
  find_defects(surface, area, check);
  if (!watched.report(0.5)) return std::nullopt;
  find_self_intersections(surface, area, watched.part(0.5, 0.6), check);
  if (!watched.report(0.6)) return std::nullopt;
  if (check.encloses() && check.mass.volume_m3 > 0.0) {
    check.thinnest = ThicknessSearch(surface).smallest(watched.part(0.6, 1.0));
  }
  return continues ? std::optional(check) : std::nullopt;
}

}  // namespace spoonbill
