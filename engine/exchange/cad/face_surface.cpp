#include "engine/exchange/cad/face_surface.h"

#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
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
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gp_XYZ.hxx>
#include <optional>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad/approximation.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

constexpr int samples_per_edge = 16;
// Largest distance of an edge on the side of a box, as a fraction of the box's length; files store curves
// less exactly than surfaces.
constexpr double side_fraction = 1e-5;

// Returns the projections of a point to the four sides of a box.
std::array<gp_Pnt2d, 4> project_to_sides(const gp_Pnt2d& point, const ParameterBox& box) {
  return {gp_Pnt2d(box.u_start, point.Y()), gp_Pnt2d(box.u_end, point.Y()), gp_Pnt2d(point.X(), box.v_start),
          gp_Pnt2d(point.X(), box.v_end)};
}

// Returns the nearest point of a box.
gp_Pnt2d clamp_into(const gp_Pnt2d& point, const ParameterBox& box) {
  return {std::clamp(point.X(), box.u_start, box.u_end), std::clamp(point.Y(), box.v_start, box.v_end)};
}

// Returns true where all samples of the edge are on one side of the box. An edge that overshoots the box
// counts as the side that it overshoots, to within the same distance.
bool is_on_side(const TopoDS_Edge& edge, const TopoDS_Face& face, const ParameterBox& box, double tolerance) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return false;
  const auto surface = BRep_Tool::Surface(face);
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

// Returns true where an edge of the face is not on one of the sides of its box, to within `tolerance` (in the
// face's unit) or the edge's own tolerance.
bool is_trimmed(const TopoDS_Face& face, const ParameterBox& box, double tolerance) {
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    if (!is_on_side(edge, face, box, tolerance)) return true;
  }
  return false;
}

using Point = Eigen::Vector2d;
// Control points of a cubic Bezier curve.
using CubicPiece = std::array<Point, 4>;

// Largest distance between loops and the file's curves, as a fraction of the domain: the default, and the
// smallest that a tight tolerance leads to.
constexpr double curve_fraction = 1e-6, smallest_curve_fraction = 1e-9;
// Largest gap between edges that is closed by moving their ends, as a fraction of the domain.
constexpr double meeting_fraction = 1e-3;
constexpr int halving_limit = 12;

Point to_point(const gp_Pnt2d& p) {
  return {p.X(), p.Y()};
}

Point evaluate(const CubicPiece& piece, double t) {
  const double s = 1.0 - t;
  return s * s * s * piece[0] + 3.0 * s * s * t * piece[1] + 3.0 * s * t * t * piece[2] +
         t * t * t * piece[3];
}

// Lengths of a surface's domain, and the tolerance of curves over it as a fraction of these lengths.
struct CurveTolerance {
  Point lengths;
  double fraction;
};

CurveTolerance find_curve_tolerance(const Surface& surface, double tolerance_m) {
  const double fraction = tolerance_m / std::max(stretch_bound_m(surface), 1e-300);
  return {
      {surface.u.domain_end() - surface.u.domain_start(), surface.v.domain_end() - surface.v.domain_start()},
      std::clamp(fraction, smallest_curve_fraction, curve_fraction)};
}

// Fit of a curve by cubic pieces with its tangents (Hermite), halved until they are within the tolerance.
class CurveFit {
 public:
  CurveFit(const Geom2dAdaptor_Curve& curve, const CurveTolerance& tolerance)
      : curve_(curve), tolerance_(tolerance) {
    add(curve.FirstParameter(), curve.LastParameter(), 0);
  }

  std::vector<CubicPiece> pieces;

 private:
  void add(double from, double to, int halvings) {
    gp_Pnt2d start, end;
    gp_Vec2d start_tangent, end_tangent;
    curve_.D1(from, start, start_tangent);
    curve_.D1(to, end, end_tangent);
    const double third = (to - from) / 3.0;
    const Point p = to_point(start), q = to_point(end);
    const CubicPiece piece{p, p + third * Point(start_tangent.X(), start_tangent.Y()),
                           q - third * Point(end_tangent.X(), end_tangent.Y()), q};
    if (halvings < halving_limit && is_outside_tolerance(piece, from, to)) {
      const double midpoint = 0.5 * (from + to);
      add(from, midpoint, halvings + 1);
      add(midpoint, to, halvings + 1);
    } else {
      pieces.push_back(piece);
    }
  }

  bool is_outside_tolerance(const CubicPiece& piece, double from, double to) const {
    for (const double t : {0.2, 0.5, 0.8}) {
      const Point gap = (evaluate(piece, t) - to_point(curve_.Value(from + t * (to - from))))
                            .cwiseQuotient(tolerance_.lengths);
      if (!(gap.norm() <= tolerance_.fraction)) return true;
    }
    return false;
  }

  const Geom2dAdaptor_Curve& curve_;
  CurveTolerance tolerance_;
};

// Returns the cubic pieces of an edge in the direction of its wire; empty where it has no curve over the
// surface.
std::vector<CubicPiece> fit_edge(const TopoDS_Edge& edge, const TopoDS_Face& face,
                                 const CurveTolerance& tolerance) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull() || !(last > first)) return {};
  const Geom2dAdaptor_Curve whole(curve, first, last);
  TColStd_Array1OfReal ends(1, whole.NbIntervals(GeomAbs_C2) + 1);
  whole.Intervals(ends, GeomAbs_C2);
  std::vector<CubicPiece> pieces;
  for (int k = ends.Lower(); k < ends.Upper(); ++k) {
    if (!(ends(k + 1) > ends(k))) continue;
    const Geom2dAdaptor_Curve part(curve, ends(k), ends(k + 1));
    const CurveFit fit(part, tolerance);
    pieces.insert(pieces.end(), fit.pieces.begin(), fit.pieces.end());
  }
  if (edge.Orientation() != TopAbs_REVERSED) return pieces;
  std::reverse(pieces.begin(), pieces.end());
  for (CubicPiece& piece : pieces) std::reverse(piece.begin(), piece.end());
  return pieces;
}

CubicPiece line(const Point& from, const Point& to) {
  return {from, (2.0 * from + to) / 3.0, (from + 2.0 * to) / 3.0, to};
}

// Makes `next` begin at `end`: a small gap is closed by moving its start, a large one by a line.
void join(const Point& end, const Point& lengths, std::vector<CubicPiece>& next) {
  const Point gap = end - next.front()[0];
  if (gap.cwiseQuotient(lengths).norm() <= meeting_fraction) {
    next.front()[0] += gap;
    next.front()[1] += gap;
  } else {
    next.insert(next.begin(), line(end, next.front()[0]));
  }
}

Result<std::vector<CubicPiece>> join_edges(const TopoDS_Wire& wire, const TopoDS_Face& face,
                                           const CurveTolerance& tolerance) {
  int edges = 0, visited = 0;
  for (TopExp_Explorer every(wire, TopAbs_EDGE); every.More(); every.Next()) ++edges;
  std::vector<CubicPiece> chain;
  for (BRepTools_WireExplorer explorer(wire, face); explorer.More(); explorer.Next(), ++visited) {
    std::vector<CubicPiece> pieces = fit_edge(explorer.Current(), face, tolerance);
    if (pieces.empty()) {
      return Error{ErrorCode::malformed, "an edge has no curve over the surface's parameters"};
    }
    if (!chain.empty()) join(chain.back()[3], tolerance.lengths, pieces);
    chain.insert(chain.end(), pieces.begin(), pieces.end());
  }
  if (visited != edges) return Error{ErrorCode::mismatch, "its edges are not connected"};
  if (chain.empty()) return chain;
  std::vector<CubicPiece> start = {line(chain.front()[0], chain.front()[0])};
  join(chain.back()[3], tolerance.lengths, start);
  if (start.size() > 1) chain.push_back(start.front());
  chain.back()[3] = chain.front()[0];
  return chain;
}

Result<TrimLoop> make_loop(const std::vector<CubicPiece>& chain, const KnotVector& along_u,
                           const KnotVector& along_v) {
  std::vector<double> knots(4, 0.0), u, v;
  const auto add = [&](const Point& point) {
    // Rounding may put a point outside an open domain.
    u.push_back(along_u.is_periodic() ? point.x() : along_u.into_domain(point.x()));
    v.push_back(along_v.is_periodic() ? point.y() : along_v.into_domain(point.y()));
  };
  add(chain.front()[0]);
  for (std::size_t k = 0; k < chain.size(); ++k) {
    for (std::size_t i = 1; i < 4; ++i) add(chain[k][i]);
    const bool is_last = k + 1 == chain.size();
    knots.insert(knots.end(), is_last ? 4 : 3, static_cast<double>(k + 1));
  }
  auto along = KnotVector::open(3, std::move(knots));
  if (!along) return along.error();
  return make_trim_loop(along_u, along_v, std::move(along).value(), std::move(u), std::move(v));
}

double domain_area(const KnotVector& along_u, const KnotVector& along_v) {
  return (along_u.domain_end() - along_u.domain_start()) * (along_v.domain_end() - along_v.domain_start());
}

// Orients the largest loop counter-clockwise and the others clockwise; some systems orient wires against the
// normal of their face. The knots of a chain of pieces are symmetric, so that reversing the control points
// suffices.
std::vector<TrimLoop> orient_loops(std::vector<TrimLoop> loops, const KnotVector& along_u,
                                   const KnotVector& along_v) {
  std::vector<double> areas;
  areas.reserve(loops.size());
  for (const TrimLoop& loop : loops) areas.push_back(signed_area(to_polygon(loop, along_u, along_v)));
  const auto largest = std::max_element(areas.begin(), areas.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); });
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const bool outer = areas.begin() + static_cast<std::ptrdiff_t>(k) == largest;
    if ((areas[k] > 0.0) == outer) continue;
    std::reverse(loops[k].u.begin(), loops[k].u.end());
    std::reverse(loops[k].v.begin(), loops[k].v.end());
  }
  return loops;
}

// Returns a loop for each wire of the face except those around the whole domain, over the face's own
// parameters. Its cubic pieces are within a millionth of the domain of the edges' curves, or closer where the
// surface stretches that beyond the tolerance; splines of degree 3 and less are exact. Refused: edges that
// have no curves over the parameters or are not connected, and loops that bound no area.
Result<std::vector<TrimLoop>> read_trim_loops(const TopoDS_Face& face, const Surface& surface,
                                              double tolerance_m) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  const KnotVector &along_u = surface.u, &along_v = surface.v;
  const CurveTolerance tolerance = find_curve_tolerance(surface, tolerance_m);
  std::vector<TrimLoop> loops;
  for (TopExp_Explorer wires(forward, TopAbs_WIRE); wires.More(); wires.Next()) {
    const auto chain = join_edges(TopoDS::Wire(wires.Current()), forward, tolerance);
    if (!chain) return chain.error();
    if (chain->empty()) continue;
    auto loop = make_loop(chain.value(), along_u, along_v);
    if (!loop) return loop.error();
    const double area = std::abs(signed_area(to_polygon(loop.value(), along_u, along_v)));
    if (area > (1.0 - curve_fraction) * domain_area(along_u, along_v)) continue;
    loops.push_back(std::move(loop).value());
  }
  if (TrimmedArea::make(along_u, along_v, loops)) return loops;
  loops = orient_loops(std::move(loops), along_u, along_v);
  if (const auto area = TrimmedArea::make(along_u, along_v, loops); !area) return area.error();
  return loops;
}

using Geometry = opencascade::handle<Geom_Surface>;

// Distance below which coordinates are equal after rounding in a file.
constexpr double coincidence_m = 1e-9;
constexpr double parameter_limit = 1e9;

Geometry basis_surface(Geometry surface) {
  while (const auto trimmed = opencascade::handle<Geom_RectangularTrimmedSurface>::DownCast(surface)) {
    surface = trimmed->BasisSurface();
  }
  return surface;
}

// Returns the surface's own bound where the given one equals it within rounding.
double snap_bound(double bound, double full, double length) {
  return std::abs(bound - full) < 1e-7 * length ? full : bound;
}

bool is_polynomial(const Geometry& surface);

// Cuts off what lies beyond the end of a polynomial surface, where OpenCASCADE cannot cut it out. Edges
// overshoot such an end by the rounding of their file, or by its tolerance. A periodic direction has no end.
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

// Returns true where OpenCASCADE converts the surface to a B-spline surface exactly.
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

// Returns the whole domain of a spline, which its loops trim, unless the face crosses its seam; otherwise the
// box.
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

// Returns nullopt where the surface must be approximated.
std::optional<Surface> exact_surface(const Geometry& surface, const ParameterBox& box) {
  if (!is_polynomial(surface)) return {};
  const auto spline = to_spline(surface, box);
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

// Gives the surface the parameters of the face, which the curves of its edges use.
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
    auto trims = read_trim_loops(face, result.surface, tolerance_m);
    if (trims) {
      result.trims = std::move(trims).value();
    } else {
      result.trim_problem = trims.error().message;
    }
  }
  if (face.Orientation() == TopAbs_REVERSED) reverse_face(result);
  return result;
}

constexpr int place_samples = 8;

// Returns the mean of samples of the face's edges, in the face's unit; nullopt where there is none.
std::optional<gp_XYZ> find_middle(const TopoDS_Face& face) {
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
    const auto middle = find_middle(face);
    if (!middle) return {};
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "(%.4g, %.4g, %.4g) mm",
                  millimetres_per_metre * scale * middle->X(), millimetres_per_metre * scale * middle->Y(),
                  millimetres_per_metre * scale * middle->Z());
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
