#include "engine/study/surface_check.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/surfaces/surface_self_collider.h"
#include "engine/study/piece_sampling.h"

namespace spoonbill {

namespace {

constexpr int parts = 4;
// Of the mean over the surface, the area that a parameter step may shrink to.
constexpr double least_area_share = 1e-7;
constexpr std::size_t most_spots = 16;
// Halved once, elements of usual nets tell loops of half a cell; larger nets are fine enough already.
constexpr std::size_t large_net = 2500;

// Cells of a piece whose middle has no area, or whose normal turns by more than a right angle from that of
// the piece's other cells beside it.
void find_bad_spots(const Surface& surface, SurfaceCheck& check) {
  const std::vector<PieceCell> cells = piece_cells(surface, parts);
  const int columns = parts * static_cast<int>(surface.v.breakpoints().size() - 1);
  std::vector<Vector3> products;
  double mean = 0.0;
  for (const PieceCell& cell : cells) {
    const SurfacePoint point = evaluate(surface, cell.middle_u(), cell.middle_v());
    products.push_back(point.du.cross(point.dv));
    mean += products.back().norm() / static_cast<double>(cells.size());
  }
  const auto add = [&](std::size_t k, bool folds) {
    if (check.bad_spots.size() >= most_spots) return;
    const double u = cells[k].middle_u(), v = cells[k].middle_v();
    check.bad_spots.push_back({u, v, position(surface, u, v), folds});
  };
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!(products[k].norm() > least_area_share * mean)) {
      add(k, false);
      continue;
    }
    const std::size_t beside = k + 1, below = k + static_cast<std::size_t>(columns);
    const bool last_column = beside % static_cast<std::size_t>(columns) == 0;
    if ((!last_column && products[k].dot(products[beside]) < 0.0) ||
        (below < cells.size() && products[k].dot(products[below]) < 0.0)) {
      add(k, true);
    }
  }
}

void find_self_meetings(const Surface& surface, SurfaceCheck& check) {
  const auto grid = make_nested_grid(surface.u, surface.v, surface.net.size() > large_net ? 0 : 1);
  if (!grid) {
    check.self_meetings_complete = false;
    return;
  }
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = check.closing.closedness == Closedness::solid;
  check.self_meetings_complete = !collider.collide(surface, query).overflow;
  for (const PairContact& contact : collider.contacts()) {
    const PairParameters& at = contact.pair.at;
    check.self_meetings.push_back({at.u, at.v, at.s, at.t, contact.depth_m, position(surface, at.u, at.v)});
  }
}

}  // namespace

SurfaceCheck check_surface(const Surface& surface) {
  SurfaceCheck check;
  check.closing = closing_of(surface);
  check.mass = enclosed_mass(surface);
  check.curvature = curvature_range(surface);
  check.bending = bending_measure(surface);
  find_bad_spots(surface, check);
  find_self_meetings(surface, check);
  if (check.closing.closedness == Closedness::solid && check.mass.volume_m3 > 0.0) {
    check.thinnest = ThicknessSearch(surface).smallest();
  }
  return check;
}

}  // namespace spoonbill
