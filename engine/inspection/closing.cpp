#include "engine/inspection/closing.h"

#include <algorithm>

namespace spoonbill {

namespace {

constexpr int edge_samples = 512;

double at_share(const KnotVector& knots, double share) {
  return knots.domain_start() + share * (knots.domain_end() - knots.domain_start());
}

// `along_u`: of the ends of u, whose edges run along v.
EdgeGap edge_gap(const Surface& surface, bool along_u) {
  EdgeGap gap;
  const KnotVector& knots = along_u ? surface.u : surface.v;
  if (knots.is_periodic()) return gap;
  const KnotVector& across = along_u ? surface.v : surface.u;
  const auto point = [&](double end, double share) {
    const double t = at_share(across, share);
    return along_u ? position(surface, end, t) : position(surface, t, end);
  };
  const Vector3 first_start = point(knots.domain_start(), 0.0), last_start = point(knots.domain_end(), 0.0);
  for (int k = 0; k <= edge_samples; ++k) {
    const double share = static_cast<double>(k) / edge_samples;
    const Vector3 first = point(knots.domain_start(), share), last = point(knots.domain_end(), share);
    gap.apart_m = std::max(gap.apart_m, (first - last).norm());
    gap.first_width_m = std::max(gap.first_width_m, (first - first_start).norm());
    gap.last_width_m = std::max(gap.last_width_m, (last - last_start).norm());
  }
  return gap;
}

bool runs_around(const EdgeGap& gap) {
  return gap.apart_m <= closing_tolerance_m;
}

bool ends_in_points(const EdgeGap& gap) {
  return gap.first_width_m <= closing_tolerance_m && gap.last_width_m <= closing_tolerance_m;
}

double widest_end(const EdgeGap& gap) {
  return runs_around(gap) ? 0.0 : std::max(gap.first_width_m, gap.last_width_m);
}

}  // namespace

Closing closing_of(const Surface& surface) {
  Closing closing;
  closing.u = edge_gap(surface, true);
  closing.v = edge_gap(surface, false);
  const bool around_u = runs_around(closing.u), around_v = runs_around(closing.v);
  const bool solid =
      (around_u && (around_v || ends_in_points(closing.v))) || (around_v && ends_in_points(closing.u));
  closing.closedness = solid                  ? Closedness::solid
                       : around_u || around_v ? Closedness::tube
                                              : Closedness::sheet;
  if (solid) return closing;
  closing.gap_m = around_u   ? widest_end(closing.v)
                  : around_v ? widest_end(closing.u)
                             : std::min(std::max(closing.u.apart_m, widest_end(closing.v)),
                                        std::max(closing.v.apart_m, widest_end(closing.u)));
  return closing;
}

}  // namespace spoonbill
