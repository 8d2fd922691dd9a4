#include "engine/exchange/cad/smooth_patch.h"

#include <GeomAdaptor_Surface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <utility>

namespace spoonbill {
namespace {

constexpr int lines_compared = 7;
constexpr double coincidence_m = 1e-9;

struct Derivatives {
  Vector3 position, first, second;
};

// One direction of a surface over a box.
class ParameterLine {
 public:
  ParameterLine(const GeomAdaptor_Surface& surface, const ParameterBox& box, bool along_u)
      : surface_(&surface), box_(box), along_u_(along_u) {}

  double start() const { return along_u_ ? box_.u_start : box_.v_start; }
  double end() const { return along_u_ ? box_.u_end : box_.v_end; }

  // The k-th of the lines that are compared, at that parameter.
  Derivatives at(double parameter, int k) const {
    const double share = (k + 0.5) / lines_compared;
    const double u = along_u_ ? parameter : box_.u_start + share * (box_.u_end - box_.u_start);
    const double v = along_u_ ? box_.v_start + share * (box_.v_end - box_.v_start) : parameter;
    gp_Pnt p;
    gp_Vec du, dv, duu, dvv, duv;
    surface_->D2(u, v, p, du, dv, duu, dvv, duv);
    const gp_Vec& first = along_u_ ? du : dv;
    const gp_Vec& second = along_u_ ? duu : dvv;
    return {{p.X(), p.Y(), p.Z()}, {first.X(), first.Y(), first.Z()}, {second.X(), second.Y(), second.Z()}};
  }

  std::vector<double> interval_ends() const {
    const int count = along_u_ ? surface_->NbUIntervals(GeomAbs_C3) : surface_->NbVIntervals(GeomAbs_C3);
    TColStd_Array1OfReal ends(1, count + 1);
    if (along_u_) {
      surface_->UIntervals(ends, GeomAbs_C3);
    } else {
      surface_->VIntervals(ends, GeomAbs_C3);
    }
    std::vector<double> inside{start()};
    const double nearest = 1e-7 * (end() - start());
    for (const double parameter : ends) {
      if (parameter > inside.back() + nearest && parameter < end() - nearest) inside.push_back(parameter);
    }
    inside.push_back(end());
    return inside;
  }

 private:
  const GeomAdaptor_Surface* surface_;
  ParameterBox box_;
  bool along_u_;
};

// Up to which order, of 0 to 2, the derivatives just before `left` and just after `right` agree; -1 where not
// even the points do.
int continuity_across(const ParameterLine& line, double left, double right, double scale) {
  const double step = 1e-9 * (line.end() - line.start());
  const double length = line.end() - line.start();
  int continuity = 2;
  for (int k = 0; k < lines_compared; ++k) {
    const Derivatives a = line.at(left - step, k), b = line.at(right + step, k);
    const double first = std::max(a.first.norm(), b.first.norm());
    const double second = std::max({a.second.norm(), b.second.norm(), first / length});
    if (scale * ((a.position - b.position).norm() - 2.0 * step * first) > coincidence_m) return -1;
    if ((a.first - b.first).norm() > 1e-6 * first + 2.0 * step * second) continuity = 0;
    if ((a.second - b.second).norm() > 1e-4 * second) continuity = std::min(continuity, 1);
  }
  return continuity;
}

PatchDirection direction_of(const ParameterLine& line, double scale) {
  PatchDirection direction;
  const std::vector<double> ends = line.interval_ends();
  for (const double parameter : ends) direction.breaks.push_back({parameter, 2});
  for (std::size_t k = 1; k + 1 < ends.size(); ++k) {
    direction.breaks[k].continuity = std::max(0, continuity_across(line, ends[k], ends[k], scale));
  }
  // An edge of one point meets anything that is the same point.
  double turn = 0.0;
  for (int k = 0; k < lines_compared; ++k) {
    const Vector3 middle = line.at(0.5 * (line.start() + line.end()), k).position;
    turn = std::max(turn, scale * (middle - line.at(line.start(), k).position).norm());
  }
  const int seam = continuity_across(line, line.end(), line.start(), scale);
  direction.closed = seam >= 0 && turn > coincidence_m;
  direction.breaks.front().continuity = std::max(0, seam);
  return direction;
}

}  // namespace

Result<PatchFit> approximate_patch(const opencascade::handle<Geom_Surface>& surface, const ParameterBox& box,
                                   double scale, double tolerance_m) {
  const GeomAdaptor_Surface adaptor(surface, box.u_start, box.u_end, box.v_start, box.v_end);
  Patch patch;
  patch.u = direction_of(ParameterLine(adaptor, box, true), scale);
  patch.v = direction_of(ParameterLine(adaptor, box, false), scale);
  patch.at = [&](double u, double v) -> Vector3 {
    const gp_Pnt point = surface->Value(u, v);
    return scale * Vector3(point.X(), point.Y(), point.Z());
  };
  return approximate(patch, tolerance_m);
}

}  // namespace spoonbill
