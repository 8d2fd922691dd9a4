#include "engine/exchange/cad/face_surface.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
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
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gp_XYZ.hxx>
#include <optional>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"
#include "engine/exchange/cad/approximation.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/trim_reader.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

constexpr int samples_per_edge = 16;
// An edge counts as on a side of the parameter box if its distance from the side in (u, v) is at most this
// fraction of the box's length across the side. Files store curves less exactly than surfaces.
constexpr double side_fraction = 1e-5;

// Returns the projections of a point onto the four sides of a box.
std::array<gp_Pnt2d, 4> project_to_sides(const gp_Pnt2d& point, const ParameterBox& box) {
  return {gp_Pnt2d(box.u_start, point.Y()), gp_Pnt2d(box.u_end, point.Y()), gp_Pnt2d(point.X(), box.v_start),
          gp_Pnt2d(point.X(), box.v_end)};
}

// Returns the point of a box that is nearest to `point`.
gp_Pnt2d clamp_into(const gp_Pnt2d& point, const ParameterBox& box) {
  return {std::clamp(point.X(), box.u_start, box.u_end), std::clamp(point.Y(), box.v_start, box.v_end)};
}

// Returns true if all samples of the edge are on the same side of the box. A sample is on a side if its
// distance from the side in space is at most `tolerance` or the edge's own tolerance, whichever is larger. If
// the sample is inside the box, its distance from the side in (u, v) must also be at most side_fraction of
// the box's length.
bool is_on_side(const TopoDS_Edge& edge, const TopoDS_Face& face, const ParameterBox& box, double tolerance) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return false;
  const auto surface = BRep_Tool::Surface(face);
  if (surface.IsNull()) return false;
  const double u_reach = side_fraction * (box.u_end - box.u_start);
  const double v_reach = side_fraction * (box.v_end - box.v_start);
  const double reach = std::max(tolerance, BRep_Tool::Tolerance(edge));
  std::array<bool, 4> is_near{true, true, true, true};
  for (int i = 0; i <= samples_per_edge; ++i) {
    const gp_Pnt2d sample = curve->Value(first + (last - first) * i / samples_per_edge);
    const gp_Pnt position = surface->Value(sample.X(), sample.Y());
    const gp_Pnt2d uv = clamp_into(sample, box);
    const std::array<gp_Pnt2d, 4> sides = project_to_sides(uv, box);
    for (std::size_t side = 0; side < sides.size(); ++side) {
      const gp_Pnt2d& projected = sides[side];
      is_near[side] = is_near[side] && std::abs(uv.X() - projected.X()) <= u_reach &&
                      std::abs(uv.Y() - projected.Y()) <= v_reach &&
                      surface->Value(projected.X(), projected.Y()).Distance(position) <= reach;
    }
  }
  return std::any_of(is_near.begin(), is_near.end(), [](bool near) { return near; });
}

// Returns true if an edge of the face is on none of the four sides of the parameter box, within `tolerance`
// (in the face's unit) or the edge's own tolerance.
bool is_trimmed(const TopoDS_Face& face, const ParameterBox& box, double tolerance) {
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    if (!is_on_side(edge, face, box, tolerance)) return true;
  }
  return false;
}

using Geometry = opencascade::handle<Geom_Surface>;

// Distance below which coordinates count as equal, because files round them.
constexpr double coincidence_m = 1e-9;
constexpr double parameter_limit = 1e9;

Geometry basis_surface(Geometry surface) {
  while (const auto trimmed = opencascade::handle<Geom_RectangularTrimmedSurface>::DownCast(surface)) {
    surface = trimmed->BasisSurface();
  }
  return surface;
}

// Returns `full`, the surface's own bound, if `bound` equals it within rounding; otherwise returns `bound`.
double snap_bound(double bound, double full, double length) {
  return std::abs(bound - full) < 1e-7 * length ? full : bound;
}

bool is_polynomial(const Geometry& surface);

// Removes the part of the box that is beyond the end of a polynomial surface, because OpenCASCADE cannot cut
// the surface there. Edges overshoot such an end by the rounding or the tolerance of their file. A periodic
// direction has no end.
void clip_to_surface(const Geometry& surface, const ParameterBox& full, ParameterBox& box) {
  if (!is_polynomial(surface)) return;
  if (!surface->IsUPeriodic()) {
    box.u_start = std::clamp(box.u_start, full.u_start, full.u_end);
    box.u_end = std::clamp(box.u_end, full.u_start, full.u_end);
  }
  if (!surface->IsVPeriodic()) {
    box.v_start = std::clamp(box.v_start, full.v_start, full.v_end);
    box.v_end = std::clamp(box.v_end, full.v_start, full.v_end);
  }
}

Result<ParameterBox> find_parameter_box(const TopoDS_Face& face, const Geometry& surface) {
  ParameterBox box, full;
  BRepTools::UVBounds(face, box.u_start, box.u_end, box.v_start, box.v_end);
  surface->Bounds(full.u_start, full.u_end, full.v_start, full.v_end);
  for (const double bound : {box.u_start, box.u_end, box.v_start, box.v_end}) {
    if (!(std::abs(bound) < parameter_limit)) {
      return Error{ErrorCode::unsupported, "has no finite extent; trim it in the CAD system"};
    }
  }
  clip_to_surface(surface, full, box);
  const double u_length = box.u_end - box.u_start, v_length = box.v_end - box.v_start;
  if (!(u_length > 0.0 && v_length > 0.0)) {
    return Error{ErrorCode::degenerate, "has no extent; remove it in the CAD system"};
  }
  box.u_start = snap_bound(box.u_start, full.u_start, u_length);
  box.u_end = snap_bound(box.u_end, full.u_end, u_length);
  box.v_start = snap_bound(box.v_start, full.v_start, v_length);
  box.v_end = snap_bound(box.v_end, full.v_end, v_length);
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

// Returns true if OpenCASCADE converts the surface exactly to a B-spline surface that is not rational.
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
  ParameterBox full;
  surface->Bounds(full.u_start, full.u_end, full.v_start, full.v_end);
  return box.u_start == full.u_start && box.u_end == full.u_end && box.v_start == full.v_start &&
         box.v_end == full.v_end;
}

// Returns the whole domain of a non-rational B-spline surface, because the loops of the face trim it. Returns
// the box for any other surface, or if the face crosses the surface's seam.
ParameterBox widen_to_spline(const Geometry& surface, const ParameterBox& box) {
  ParameterBox full;
  surface->Bounds(full.u_start, full.u_end, full.v_start, full.v_end);
  const bool is_spline = !opencascade::handle<Geom_BSplineSurface>::DownCast(surface).IsNull();
  const bool is_inside = full.u_start <= box.u_start && box.u_end <= full.u_end &&
                         full.v_start <= box.v_start && box.v_end <= full.v_end;
  return is_spline && is_inside && is_polynomial(surface) ? full : box;
}

opencascade::handle<Geom_BSplineSurface> to_spline(const Geometry& surface, const ParameterBox& box) {
  if (!opencascade::handle<Geom_BSplineSurface>::DownCast(surface).IsNull() && is_whole(surface, box)) {
    return opencascade::handle<Geom_BSplineSurface>::DownCast(surface->Copy());
  }
  return GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(surface, box.u_start, box.u_end, box.v_start, box.v_end));
}

// Converts the surface exactly. Returns nullopt if it must be approximated.
std::optional<Surface> exact_surface(const Geometry& surface, const ParameterBox& box) {
  if (!is_polynomial(surface)) return {};
  const auto spline = to_spline(surface, box);
  if (spline.IsNull() || spline->IsURational() || spline->IsVRational()) return {};
  if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
  if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
  auto exact = from_occt(*spline);
  if (!exact || !control_point_count_range.contains(exact->net.rows) ||
      !control_point_count_range.contains(exact->net.columns) ||
      exact->net.size() > static_cast<std::size_t>(document_control_point_limit)) {
    return {};
  }
  return std::move(exact).value();
}

void scale_net(ControlNet& net, double factor) {
  for (auto* coordinates : {&net.x, &net.y, &net.z}) {
    for (double& coordinate : *coordinates) coordinate *= factor;
  }
}

// Gives the surface the parameters of the face, because the curves of the face's edges refer to them.
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

// Reverses the normals of a face.
void reverse_face(FaceSurface& face) {
  for (TrimLoop& loop : face.trims) loop = reversed(loop, Direction::u, face.surface.u);
  face.surface = reversed(face.surface, Direction::u);
}

Result<FaceSurface> convert(const TopoDS_Face& face, double scale, double tolerance_m) {
  const Geometry surface = basis_surface(BRep_Tool::Surface(face));
  if (surface.IsNull()) return Error{ErrorCode::malformed, "has no surface; export it again"};
  auto box = find_parameter_box(face, surface);
  if (!box) return box.error();
  const bool trimmed = is_trimmed(face, box.value(), tolerance_m / scale);
  if (trimmed) box = widen_to_spline(surface, box.value());
  FaceSurface result;
  if (auto exact = exact_surface(surface, box.value())) {
    result.surface = *std::move(exact);
    scale_net(result.surface.net, scale * millimetres_per_metre);
    result.surface = close_seam(result.surface, Direction::u, coincidence_m);
    result.surface = close_seam(result.surface, Direction::v, coincidence_m);
  } else {
    auto approximation = approximate_patch(surface, box.value(), scale, tolerance_m);
    if (!approximation) return approximation.error();
    result.surface = std::move(approximation->surface);
    result.deviation_m = approximation->deviation_m;
  }
  close_poles(result.surface, coincidence_m);
  if (Status matched = match_domain(box.value(), result.surface); !matched) return matched.error();
  if (trimmed) {
    auto trims = read_trim_loops(face, result.surface, scale, tolerance_m);
    if (trims) {
      result.trims = std::move(trims->loops);
      result.trim_deviation_m = trims->deviation_m;
    } else {
      result.trim_problem = trims.error().message;
    }
  } else {
    result.trim_deviation_m = measure_sides(face, result.surface, scale, tolerance_m);
  }
  if (face.Orientation() == TopAbs_REVERSED) reverse_face(result);
  return result;
}

constexpr int place_samples = 8;

// Returns the mean of samples of the face's edges, in the face's unit; nullopt if no edge has a curve or if
// the mean is not finite.
std::optional<gp_XYZ> find_centre(const TopoDS_Face& face) {
  gp_XYZ sum(0.0, 0.0, 0.0);
  int count = 0;
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    double first = 0.0, last = 0.0;
    const auto curve = BRep_Tool::Curve(TopoDS::Edge(edges.Current()), first, last);
    if (curve.IsNull()) continue;
    for (int k = 0; k < place_samples; ++k) {
      sum += curve->Value(first + (last - first) * (k + 0.5) / place_samples).XYZ();
      ++count;
    }
  }
  if (count == 0 || !std::isfinite(sum.Modulus())) return {};
  return sum / count;
}

}  // namespace

std::string face_place_text(const TopoDS_Face& face, double scale) {
  try {
    const auto centre = find_centre(face);
    if (!centre) return {};
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "(%.4g, %.4g, %.4g) mm",
                  millimetres_per_metre * scale * centre->X(), millimetres_per_metre * scale * centre->Y(),
                  millimetres_per_metre * scale * centre->Z());
    return text.data();
  } catch (const Standard_Failure&) {
    return {};
  }
}

Result<FaceSurface> convert_face(const TopoDS_Face& face, double scale, double tolerance_m) {
  try {
    return convert(face, scale, tolerance_m);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported,
                 std::string("cannot be converted (") + failure.DynamicType()->Name() + "); export it again"};
  }
}

}  // namespace spoonbill
