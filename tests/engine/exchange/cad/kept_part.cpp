#include "tests/engine/exchange/cad/kept_part.h"

#include <algorithm>

#include "engine/bspline/evaluate.h"
#include "tests/engine/exchange/cad/cad_surfaces.h"

namespace spoonbill {

NearestKeptPoint::NearestKeptPoint(const CadSurface& part)
    : surface_(part.surface), area_(TrimmedArea::make(part.surface.u, part.surface.v, part.trims).value()) {
  const Surface& surface = part.surface;
  for (const double u : uniform_parameters(surface.u, 33)) {
    for (const double v : uniform_parameters(surface.v, 33)) {
      grid_.push_back({u, v, position(surface, u, v)});
    }
  }
}

double NearestKeptPoint::distance_m(const Vector3& from) const {
  std::vector<const Sample*> best;
  for (const Sample& sample : grid_) best.push_back(&sample);
  std::partial_sort(best.begin(), best.begin() + 4, best.end(), [&](const Sample* a, const Sample* b) {
    return (a->at - from).squaredNorm() < (b->at - from).squaredNorm();
  });
  double least = 1e30;
  for (int k = 0; k < 4; ++k) least = std::min(least, polished(*best[static_cast<std::size_t>(k)], from));
  return least;
}

double NearestKeptPoint::polished(const Sample& start, const Vector3& from) const {
  double u = start.u, v = start.v, least = 1e30;
  for (int step = 0; step < 20; ++step) {
    const SurfacePoint at = evaluate(surface_, u, v);
    const Vector3 way = from - at.position_m;
    if (is_kept(u, v)) least = std::min(least, way.norm());
    const double a = at.du.squaredNorm() + 1e-18, b = at.du.dot(at.dv), c = at.dv.squaredNorm() + 1e-18;
    const double determinant = a * c - b * b;
    if (!(determinant > 1e-12 * a * c)) break;
    u = surface_.u.into_domain(u + (c * way.dot(at.du) - b * way.dot(at.dv)) / determinant);
    v = surface_.v.into_domain(v + (a * way.dot(at.dv) - b * way.dot(at.du)) / determinant);
  }
  return least;
}

bool NearestKeptPoint::is_kept(double u, double v) const {
  const double du = 1e-5 * (surface_.u.domain_end() - surface_.u.domain_start());
  const double dv = 1e-5 * (surface_.v.domain_end() - surface_.v.domain_start());
  return area_.contains(u, v) || area_.contains(u + du, v) || area_.contains(u - du, v) ||
         area_.contains(u, v + dv) || area_.contains(u, v - dv);
}

double kept_area_m2(const CadSurface& part) {
  if (part.trims.empty()) return area_by_quadrature_m2(part.surface);
  constexpr int across = 200;
  const auto area = TrimmedArea::make(part.surface.u, part.surface.v, part.trims).value();
  const auto middle = [](const KnotVector& knots, int k) {
    return knots.domain_start() + (knots.domain_end() - knots.domain_start()) * (k + 0.5) / across;
  };
  const double cell = (part.surface.u.domain_end() - part.surface.u.domain_start()) *
                      (part.surface.v.domain_end() - part.surface.v.domain_start()) / across / across;
  double sum = 0.0;
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = middle(part.surface.u, i), v = middle(part.surface.v, j);
      if (!area.contains(u, v)) continue;
      const SurfacePoint at = evaluate(part.surface, u, v);
      sum += cell * at.du.cross(at.dv).norm();
    }
  }
  return sum;
}

}  // namespace spoonbill
