#include "engine/exchange/cad/occt_surface.h"

#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/bspline/reparameterise.h"

namespace spoonbill {
namespace {

// One direction of theirs, and our control point for each of their poles.
struct OcctDirection {
  TColStd_Array1OfReal knots;
  TColStd_Array1OfInteger multiplicities;
  std::vector<int> controls;
};

// One period from a seam of full multiplicity, clamped.
std::vector<double> period_of(const KnotVector& knots) {
  const auto degree = static_cast<std::size_t>(knots.degree());
  std::vector<double> period(degree + 1, knots.domain_start());
  for (const double knot : knots.extended_knots()) {
    if (knot > knots.domain_start() && knot < knots.domain_end()) period.push_back(knot);
  }
  period.insert(period.end(), degree + 1, knots.domain_end());
  return period;
}

OcctDirection occt_direction(const KnotVector& direction) {
  const bool periodic = direction.is_periodic();
  const std::vector<double> all = periodic ? period_of(direction) : direction.knots();
  std::vector<double> distinct = all;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const int count = static_cast<int>(distinct.size());
  OcctDirection result{TColStd_Array1OfReal(1, count), TColStd_Array1OfInteger(1, count), {}};
  for (int i = 0; i < count; ++i) {
    const double knot = distinct[static_cast<std::size_t>(i)];
    result.knots(i + 1) = knot;
    result.multiplicities(i + 1) = static_cast<int>(std::count(all.begin(), all.end(), knot));
  }
  const int poles = static_cast<int>(all.size()) - direction.degree() - 1;
  const int first = periodic ? direction.control_index(direction.find_span(direction.domain_start()), 0) : 0;
  for (int i = 0; i < poles; ++i) {
    result.controls.push_back(periodic ? (first + i) % direction.control_point_count() : i);
  }
  return result;
}

Result<Surface> with_full_seam(const Surface& surface, Direction direction) {
  const KnotVector& knots = direction == Direction::u ? surface.u : surface.v;
  if (!knots.is_periodic()) return surface;
  return insert_knot(surface, direction, knots.domain_start(), knots.degree());
}

bool is_clamped(const KnotVector& knots) {
  const std::vector<double>& all = knots.knots();
  return knots.is_periodic() || (all.front() == knots.domain_start() && all.back() == knots.domain_end());
}

std::vector<double> flat_knots(const TColStd_Array1OfReal& knots,
                               const TColStd_Array1OfInteger& multiplicities) {
  std::vector<double> flat;
  for (int i = knots.Lower(); i <= knots.Upper(); ++i) {
    flat.insert(flat.end(), static_cast<std::size_t>(multiplicities(i)), knots(i));
  }
  return flat;
}

}  // namespace

Result<opencascade::handle<Geom_BSplineSurface>> to_occt(const Surface& surface) {
  auto opened = with_full_seam(surface, Direction::u);
  if (opened) opened = with_full_seam(opened.value(), Direction::v);
  if (!opened) return opened.error();
  const OcctDirection u = occt_direction(opened->u), v = occt_direction(opened->v);
  TColgp_Array2OfPnt poles(1, static_cast<int>(u.controls.size()), 1, static_cast<int>(v.controls.size()));
  for (std::size_t i = 0; i < u.controls.size(); ++i) {
    for (std::size_t j = 0; j < v.controls.size(); ++j) {
      const Vector3 at = millimetres_per_metre * opened->net.point(u.controls[i], v.controls[j]);
      poles(static_cast<int>(i) + 1, static_cast<int>(j) + 1) = gp_Pnt(at.x(), at.y(), at.z());
    }
  }
  try {
    opencascade::handle<Geom_BSplineSurface> result = new Geom_BSplineSurface(
        poles, u.knots, v.knots, u.multiplicities, v.multiplicities, surface.u.degree(), surface.v.degree());
    if (!is_clamped(surface.u) || !is_clamped(surface.v)) {
      result->Segment(surface.u.domain_start(), surface.u.domain_end(), surface.v.domain_start(),
                      surface.v.domain_end(), 0.0, 0.0);
    }
    return result;
  } catch (const Standard_Failure& failure) {
    return Error{std::string("its knots are too near each other for a CAD file (") +
                 failure.DynamicType()->Name() + "); make near ones equal"};
  }
}

Result<Surface> from_occt(const Geom_BSplineSurface& surface) {
  auto u = KnotVector::open(surface.UDegree(), flat_knots(surface.UKnots(), surface.UMultiplicities()));
  if (!u) return Error{"along u: " + u.error().message};
  auto v = KnotVector::open(surface.VDegree(), flat_knots(surface.VKnots(), surface.VMultiplicities()));
  if (!v) return Error{"along v: " + v.error().message};
  ControlNet net(surface.NbUPoles(), surface.NbVPoles());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const gp_Pnt pole = surface.Pole(i + 1, j + 1);
      net.set_point(i, j, Vector3(pole.X(), pole.Y(), pole.Z()) / millimetres_per_metre);
    }
  }
  return make_surface(std::move(u).value(), std::move(v).value(), std::move(net));
}

}  // namespace spoonbill
