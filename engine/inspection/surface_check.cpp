#include "engine/inspection/surface_check.h"

#include <cstddef>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/knot_vector.h"
#include "engine/collision/surfaces/surface_self_collider.h"
#include "engine/inspection/piece_sampling.h"

namespace spoonbill {

namespace {

constexpr int parts = 4;
// Of the mean over the surface, the area that a parameter step may shrink to.
constexpr double least_area_share = 1e-7;
constexpr std::size_t most_spots = 16;
// Halved once, elements of usual nets tell loops of half a cell; larger nets are fine enough already.
constexpr std::size_t large_net = 2500;

// Along one direction, which cells have one beside them whose normal must not be another by far: not across
// an edge, a knot as often as the degree, where two sides may meet at any angle.
class SmoothSteps {
 public:
  explicit SmoothSteps(const KnotVector& knots) {
    // One for the start of each piece; the end of the last is the start of the first, or an end.
    const std::vector<KnotMultiplicity> starts = knot_multiplicities(knots);
    for (std::size_t piece = 0; piece < starts.size(); ++piece) {
      smooth_after_.push_back(starts[(piece + 1) % starts.size()].multiplicity < knots.degree());
    }
  }

  std::size_t cells() const { return parts * smooth_after_.size(); }
  // Whether the cell and the next one, which at the end of a closed direction is the first, lie in one sheet.
  bool goes_on(std::size_t cell) const { return (cell + 1) % parts != 0 || smooth_after_[cell / parts]; }
  std::size_t next(std::size_t cell) const { return cell + 1 < cells() ? cell + 1 : 0; }

 private:
  std::vector<bool> smooth_after_;  // of each piece
};

// Whether the normal flips on the straight way between two parameters, rather than turn as about a tight rim:
// it then does so too from one of ever finer steps to the next.
class Flips {
 public:
  Flips(const Surface& surface, double least_area) : surface_(surface), least_area_(least_area) {}

  bool between(const PieceCell& from, const PieceCell& to) const {
    // Over the seam of a closed direction the way goes on, not back.
    const double u = from.middle_u(), v = from.middle_v();
    return looked_at({u, v}, {onwards(surface_.u, u, to.middle_u()), onwards(surface_.v, v, to.middle_v())},
                     looks);
  }

 private:
  using Place = Eigen::Vector2d;
  static constexpr int steps = 6, looks = 2;

  static double onwards(const KnotVector& knots, double from, double to) {
    return to < from ? to + knots.domain_end() - knots.domain_start() : to;
  }

  bool looked_at(const Place& from, const Place& to, int looks_left) const {
    Vector3 before = product(from);
    Place since = from;
    for (int step = 1; step <= steps; ++step) {
      const Place place = from + (to - from) * step / steps;
      const Vector3 here = product(place);
      // On the very line of a fold the normal has no side.
      if (here.norm() < least_area_ && step < steps) continue;
      const bool turns = before.dot(here) < 0.0;
      if (turns && (looks_left == 1 || looked_at(since, place, looks_left - 1))) return true;
      before = here;
      since = place;
    }
    return false;
  }

  Vector3 product(const Place& at) const {
    const SurfacePoint point =
        evaluate(surface_, surface_.u.into_domain(at.x()), surface_.v.into_domain(at.y()));
    return point.du.cross(point.dv);
  }

  const Surface& surface_;
  double least_area_;
};

// Cells of a piece whose middle has no area, or between which and the cell beside them the normal flips.
void find_bad_spots(const Surface& surface, const TrimmedArea& area, SurfaceCheck& check) {
  const std::vector<PieceCell> cells = piece_cells(surface, parts);
  std::vector<Vector3> products;
  double mean = 0.0;
  for (const PieceCell& cell : cells) {
    const SurfacePoint point = evaluate(surface, cell.middle_u(), cell.middle_v());
    products.push_back(point.du.cross(point.dv));
    mean += products.back().norm() / static_cast<double>(cells.size());
  }
  const SmoothSteps along_u(surface.u), along_v(surface.v);
  const Flips flips(surface, least_area_share * mean);
  const auto index = [&](std::size_t i, std::size_t j) { return i * along_v.cells() + j; };
  const auto is_kept = [&](std::size_t k) { return area.contains(cells[k].middle_u(), cells[k].middle_v()); };
  const auto turns = [&](std::size_t k, std::size_t other) {
    return is_kept(other) && products[k].dot(products[other]) < 0.0 && flips.between(cells[k], cells[other]);
  };
  for (std::size_t k = 0; k < cells.size() && check.bad_spots.size() < most_spots; ++k) {
    if (!is_kept(k)) continue;
    const std::size_t i = k / along_v.cells(), j = k % along_v.cells();
    const bool shrinks = !(products[k].norm() > least_area_share * mean);
    const bool folds = (along_v.goes_on(j) && turns(k, index(i, along_v.next(j)))) ||
                       (along_u.goes_on(i) && turns(k, index(along_u.next(i), j)));
    if (!shrinks && !folds) continue;
    const double u = cells[k].middle_u(), v = cells[k].middle_v();
    check.bad_spots.push_back({u, v, position(surface, u, v), !shrinks});
  }
}

void find_self_meetings(const Surface& surface, const TrimmedArea& area, const Progress& progress,
                        SurfaceCheck& check) {
  const auto grid = make_nested_grid(surface.u, surface.v, surface.net.size() > large_net ? 0 : 1);
  if (!grid) {
    check.self_meetings_complete = false;
    return;
  }
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = check.closing.closedness == Closedness::solid;
  query.progress = progress;
  check.self_meetings_complete = !collider.collide(surface, query).overflow;
  for (const PairContact& contact : collider.contacts()) {
    const PairParameters& at = contact.pair.at;
    if (!area.contains(at.u, at.v) || !area.contains(at.s, at.t)) continue;
    check.self_intersections.push_back({at.u, at.v, at.s, at.t, contact.depth_m, position(surface, at.u, at.v)});
  }
}

}  // namespace

std::optional<SurfaceCheck> check_surface(const Surface& surface, const TrimmedArea& area,
                                          const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  bool goes_on = true;
  const Progress asked([&](double fraction) { return goes_on = goes_on && progress.report(fraction); });
  SurfaceCheck check;
  check.closing = closing_of(surface);
  check.is_trimmed = !area.is_whole();
  check.mass = enclosed_mass(surface, area);
  if (!asked.report(0.05)) return std::nullopt;
  check.curvature = curvature_range(surface, area, asked.part(0.05, 0.4));
  if (!goes_on) return std::nullopt;
  check.bending = bending_measure(surface, area);
  find_bad_spots(surface, area, check);
  if (!asked.report(0.5)) return std::nullopt;
  find_self_meetings(surface, area, asked.part(0.5, 0.6), check);
  if (!asked.report(0.6)) return std::nullopt;
  if (check.encloses() && check.mass.volume_m3 > 0.0) {
    check.thinnest = ThicknessSearch(surface).smallest(asked.part(0.6, 1.0));
  }
  return goes_on ? std::optional(check) : std::nullopt;
}

}  // namespace spoonbill
