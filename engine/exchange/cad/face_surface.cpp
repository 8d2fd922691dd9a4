#include "engine/exchange/cad/face_surface.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/exchange/cad/closing.h"
#include "engine/exchange/cad/face_trims.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/smooth_patch.h"
#include "engine/exchange/cad/trim_reader.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

using Geometry = opencascade::handle<Geom_Surface>;

// What a file rounds away of coordinates.
constexpr double coincidence_m = 1e-9;
constexpr double longest_parameter = 1e9;

Geometry without_trims(Geometry surface) {
  while (const auto trimmed = opencascade::handle<Geom_RectangularTrimmedSurface>::DownCast(surface)) {
    surface = trimmed->BasisSurface();
  }
  return surface;
}

// A bound within rounding of the surface's own is that.
double snapped(double bound, double own, double length) {
  return std::abs(bound - own) < 1e-7 * length ? own : bound;
}

Result<ParameterBox> bounding_box(const TopoDS_Face& face, const Geometry& surface) {
  ParameterBox box, own;
  BRepTools::UVBounds(face, box.u_start, box.u_end, box.v_start, box.v_end);
  surface->Bounds(own.u_start, own.u_end, own.v_start, own.v_end);
  for (const double bound : {box.u_start, box.u_end, box.v_start, box.v_end}) {
    if (!(std::abs(bound) < longest_parameter)) {
      return Error{"has no finite extent; trim it in the CAD system"};
    }
  }
  const double u_length = box.u_end - box.u_start, v_length = box.v_end - box.v_start;
  if (!(u_length > 0.0 && v_length > 0.0)) return Error{"has no extent; leave it out in the CAD system"};
  box.u_start = snapped(box.u_start, own.u_start, u_length);
  box.u_end = snapped(box.u_end, own.u_end, u_length);
  box.v_start = snapped(box.v_start, own.v_start, v_length);
  box.v_end = snapped(box.v_end, own.v_end, v_length);
  return box;
}

bool is_polynomial(const opencascade::handle<Geom_Curve>& curve) {
  if (const auto trimmed = opencascade::handle<Geom_TrimmedCurve>::DownCast(curve)) {
    return is_polynomial(trimmed->BasisCurve());
  }
  if (const auto spline = opencascade::handle<Geom_BSplineCurve>::DownCast(curve)) {
    return !spline->IsRational();
  }
  if (const auto bezier = opencascade::handle<Geom_BezierCurve>::DownCast(curve)) {
    return !bezier->IsRational();
  }
  return !opencascade::handle<Geom_Line>::DownCast(curve).IsNull();
}

// Whether OpenCASCADE's conversion of it is the surface itself.
bool is_polynomial(const Geometry& surface) {
  if (const auto spline = opencascade::handle<Geom_BSplineSurface>::DownCast(surface)) {
    return !spline->IsURational() && !spline->IsVRational();
  }
  if (const auto bezier = opencascade::handle<Geom_BezierSurface>::DownCast(surface)) {
    return !bezier->IsURational() && !bezier->IsVRational();
  }
  if (const auto extrusion = opencascade::handle<Geom_SurfaceOfLinearExtrusion>::DownCast(surface)) {
    return is_polynomial(extrusion->BasisCurve());
  }
  return !opencascade::handle<Geom_Plane>::DownCast(surface).IsNull();
}

bool is_whole(const Geometry& surface, const ParameterBox& box) {
  ParameterBox own;
  surface->Bounds(own.u_start, own.u_end, own.v_start, own.v_end);
  return box.u_start == own.u_start && box.u_end == own.u_end && box.v_start == own.v_start &&
         box.v_end == own.v_end;
}

// A spline that loops trim needs no other cut, unless the face crosses its seam.
ParameterBox widened(const Geometry& surface, const ParameterBox& box) {
  ParameterBox own;
  surface->Bounds(own.u_start, own.u_end, own.v_start, own.v_end);
  const bool is_spline = !opencascade::handle<Geom_BSplineSurface>::DownCast(surface).IsNull();
  const bool is_inside = own.u_start <= box.u_start && box.u_end <= own.u_end && own.v_start <= box.v_start &&
                         box.v_end <= own.v_end;
  return is_spline && is_inside && is_polynomial(surface) ? own : box;
}

opencascade::handle<Geom_BSplineSurface> spline_of(const Geometry& surface, const ParameterBox& box) {
  if (!opencascade::handle<Geom_BSplineSurface>::DownCast(surface).IsNull() && is_whole(surface, box)) {
    return opencascade::handle<Geom_BSplineSurface>::DownCast(surface->Copy());
  }
  return GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(surface, box.u_start, box.u_end, box.v_start, box.v_end));
}

// Nothing where the surface must be approximated.
std::optional<Surface> exact_surface(const Geometry& surface, const ParameterBox& box) {
  if (!is_polynomial(surface)) return {};
  const auto spline = spline_of(surface, box);
  if (spline.IsNull() || spline->IsURational() || spline->IsVRational()) return {};
  if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
  if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
  auto exact = from_occt(*spline);
  if (!exact || !control_point_count_range.contains(exact->net.rows) ||
      !control_point_count_range.contains(exact->net.columns)) {
    return {};
  }
  return std::move(exact).value();
}

void scale_net(ControlNet& net, double factor) {
  for (auto* coordinates : {&net.x, &net.y, &net.z}) {
    for (double& coordinate : *coordinates) coordinate *= factor;
  }
}

// The surface over the very parameters that the curves of the face's edges have.
Status match_domain(const ParameterBox& box, Surface& surface) {
  const auto match = [&](Direction direction, const KnotVector& knots, double start, double end) -> Status {
    if (knots.domain_start() == start && knots.domain_end() == end) return {};
    auto matched = with_domain(surface, direction, start, end);
    if (!matched) return matched.error();
    surface = std::move(matched).value();
    return {};
  };
  const Status status = match(Direction::u, surface.u, box.u_start, box.u_end);
  return status ? match(Direction::v, surface.v, box.v_start, box.v_end) : status;
}

// The same face from the other side.
void turn_round(FaceSurface& face) {
  for (TrimLoop& loop : face.trims) loop = reversed(loop, Direction::u, face.surface.u);
  face.surface = reversed(face.surface, Direction::u);
}

Result<FaceSurface> convert(const TopoDS_Face& face, double scale, double tolerance_m) {
  const Geometry surface = without_trims(BRep_Tool::Surface(face));
  if (surface.IsNull()) return Error{"has no surface; export it anew"};
  auto box = bounding_box(face, surface);
  if (!box) return box.error();
  const bool trimmed = is_trimmed(face, box.value(), tolerance_m / scale);
  if (trimmed) box = widened(surface, box.value());
  FaceSurface result;
  if (auto exact = exact_surface(surface, box.value())) {
    result.surface = *std::move(exact);
    scale_net(result.surface.net, scale * millimetres_per_metre);
    result.surface = closed_where_it_meets(result.surface, Direction::u, coincidence_m);
    result.surface = closed_where_it_meets(result.surface, Direction::v, coincidence_m);
  } else {
    auto approximation = approximate_patch(surface, box.value(), scale, tolerance_m);
    if (!approximation) return approximation.error();
    result.surface = std::move(approximation->surface);
    result.deviation_m = approximation->deviation_m;
  }
  close_poles(result.surface, coincidence_m);
  if (Status matched = match_domain(box.value(), result.surface); !matched) return matched.error();
  if (trimmed) {
    auto trims = trims_of(face, result.surface, tolerance_m);
    if (trims) {
      result.trims = std::move(trims).value();
    } else {
      result.trim_problem = trims.error().message;
    }
  }
  if (face.Orientation() == TopAbs_REVERSED) turn_round(result);
  return result;
}

}  // namespace

Result<FaceSurface> face_surface(const TopoDS_Face& face, double scale, double tolerance_m) {
  try {
    return convert(face, scale, tolerance_m);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("cannot be converted (") + failure.DynamicType()->Name() + "); export it anew"};
  }
}

}  // namespace spoonbill
