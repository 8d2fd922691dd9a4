#include "engine/exchange/cad/trimmed_face.h"

#include <Approx_CurveOnSurface.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/exchange/cad/occt_surface.h"

namespace spoonbill {
namespace {

using Curve = opencascade::handle<Geom2d_BSplineCurve>;
using Geometry = opencascade::handle<Geom_BSplineSurface>;
using Polygon = std::vector<Eigen::Vector2d>;

constexpr double coincidence_mm = 1e-7;
// Of the curves in space beside those over (u, v): aimed at, and allowed where a kink asks for it.
constexpr double curve_tolerance_mm = 1e-6, most_curve_error_mm = 1e-2;
constexpr double corner_sine = 1e-4;
constexpr int most_degree = 14, most_segments = 1000;

const std::vector<double>& along(const TrimLoop& loop, Direction direction) {
  return direction == Direction::u ? loop.u : loop.v;
}

// In the middle of the widest range of a period that no loop reaches; nothing where there is none.
std::optional<double> free_seam(const KnotVector& knots, Direction direction,
                                const std::vector<TrimLoop>& trims) {
  const double start = knots.domain_start(), period = knots.domain_end() - start;
  std::vector<std::pair<double, double>> reached;
  for (const TrimLoop& loop : trims) {
    const auto [low, high] =
        std::minmax_element(along(loop, direction).begin(), along(loop, direction).end());
    for (const double shift : {-period, 0.0, period}) reached.emplace_back(*low + shift, *high + shift);
  }
  std::sort(reached.begin(), reached.end());
  double end = start - period, widest = 1e-6 * period;
  std::optional<double> place;
  for (const auto& [low, high] : reached) {
    if (low - end > widest && low > start) {
      widest = low - end;
      place = 0.5 * (low + end);
    }
    end = std::max(end, high);
  }
  return place;
}

bool leaves(const KnotVector& knots, Direction direction, const std::vector<TrimLoop>& trims) {
  const double slack = trim_rounding_fraction * (knots.domain_end() - knots.domain_start());
  for (const TrimLoop& loop : trims) {
    for (const double parameter : along(loop, direction)) {
      if (parameter < knots.domain_start() - slack || parameter > knots.domain_end() + slack) return true;
    }
  }
  return false;
}

// Loops are led by a period to where they are inside.
void bring_inside(const KnotVector& knots, Direction direction, std::vector<TrimLoop>& trims) {
  const double period = knots.domain_end() - knots.domain_start();
  for (TrimLoop& loop : trims) {
    std::vector<double>& values = direction == Direction::u ? loop.u : loop.v;
    const double low = *std::min_element(values.begin(), values.end());
    const double shift = period * std::floor((low - knots.domain_start()) / period + trim_rounding_fraction);
    for (double& value : values) value -= shift;
  }
}

Status free_a_seam(Direction direction, TrimmedSurface& part) {
  const KnotVector knots = direction == Direction::u ? part.surface.u : part.surface.v;
  if (!knots.is_periodic() || !leaves(knots, direction, part.trims)) return {};
  const auto seam = free_seam(knots, direction, part.trims);
  if (!seam) return Error{"its trim loops cross its seam wherever that is laid; make one smaller"};
  auto moved = with_seam_at(part.surface, direction, *seam);
  if (!moved) return moved.error();
  for (TrimLoop& loop : part.trims) loop = with_seam_at(loop, direction, knots, *seam);
  bring_inside(knots, direction, part.trims);
  part.surface = std::move(moved).value();
  return {};
}

bool is_pole(const ControlNet& net, Direction along_edge, int line) {
  const int count = along_edge == Direction::u ? net.rows : net.columns;
  const auto point = [&](int k) {
    return along_edge == Direction::u ? net.point(k, line) : net.point(line, k);
  };
  for (int k = 1; k < count; ++k) {
    if ((point(k) - point(0)).norm() * millimetres_per_metre > coincidence_mm) return false;
  }
  return true;
}

bool has_holes_alone(const TrimmedSurface& part) {
  return std::all_of(part.trims.begin(), part.trims.end(), [&](const TrimLoop& loop) {
    return signed_area(to_polygon(loop, part.surface.u, part.surface.v)) < 0.0;
  });
}

// From the seam to the middle of what lies beyond the last loop that begins in the first half, and the rest.
Result<std::vector<TrimmedSurface>> halves_of(const TrimmedSurface& part, Direction direction) {
  const KnotVector& knots = direction == Direction::u ? part.surface.u : part.surface.v;
  const double start = knots.domain_start(), end = knots.domain_end();
  const auto reach = [&](const TrimLoop& loop) {
    return std::minmax_element(along(loop, direction).begin(), along(loop, direction).end());
  };
  double low = start, high = end;
  for (const TrimLoop& loop : part.trims) {
    if (*reach(loop).first < 0.5 * (start + end)) low = std::max(low, *reach(loop).second);
  }
  for (const TrimLoop& loop : part.trims) {
    if (*reach(loop).first >= low) high = std::min(high, *reach(loop).first);
    if (*reach(loop).first<low&& * reach(loop).second> low) {
      return Error{"its holes leave no place to cut it in two; make one smaller"};
    }
  }
  const double cut = 0.5 * (low + high);
  std::vector<TrimmedSurface> halves;
  for (const auto& [from, to] : {std::pair(start, cut), std::pair(cut, end)}) {
    auto half = part_of(part.surface, direction, from, to);
    if (!half) return half.error();
    halves.push_back({std::move(half).value(), {}});
    for (const TrimLoop& loop : part.trims) {
      if (*reach(loop).first >= from && *reach(loop).second <= to) halves.back().trims.push_back(loop);
    }
  }
  return halves;
}

// A loop is the edge of a strip, which is opened and clamped as surfaces are.
Result<Curve> curve_of(const TrimLoop& loop) {
  ControlNet net(loop.knots.control_point_count(), 2);
  for (int i = 0; i < net.rows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 2; ++j) {
      net.set_point(i, j, Vector3(loop.u[k], loop.v[k], 0.0) / millimetres_per_metre);
    }
  }
  const auto strip = to_occt({loop.knots, KnotVector::clamped_uniform(1, 2).value(), std::move(net)});
  if (!strip) return strip.error();
  const Geometry& edge = strip.value();
  TColgp_Array1OfPnt2d poles(1, edge->NbUPoles());
  for (int i = 1; i <= edge->NbUPoles(); ++i) poles(i) = {edge->Pole(i, 1).X(), edge->Pole(i, 1).Y()};
  return Curve(new Geom2d_BSplineCurve(poles, edge->UKnots(), edge->UMultiplicities(), edge->UDegree()));
}

bool turns_at(const Curve& curve, int knot) {
  gp_Pnt2d point;
  gp_Vec2d before, after;
  const double at = curve->Knot(knot);
  curve->LocalD1(at, knot - 1, knot, point, before);
  curve->LocalD1(at, knot, knot + 1, point, after);
  const double lengths = before.Magnitude() * after.Magnitude();
  return !(std::abs(before.Crossed(after)) <= corner_sine * lengths) || before.Dot(after) < 0.0;
}

// The parameters between which the curve has no corner, both ends included.
std::vector<double> smooth_ends(const Curve& curve) {
  std::vector<double> ends = {curve->FirstParameter()};
  for (int k = curve->FirstUKnotIndex() + 1; k < curve->LastUKnotIndex(); ++k) {
    if (curve->Multiplicity(k) >= curve->Degree() && turns_at(curve, k)) ends.push_back(curve->Knot(k));
  }
  ends.push_back(curve->LastParameter());
  return ends;
}

// Points in one place are one vertex, as of a loop that is led back along a seam.
void add_vertex(const gp_Pnt& at, std::vector<TopoDS_Vertex>& vertices) {
  for (const TopoDS_Vertex& known : vertices) {
    if (BRep_Tool::Pnt(known).Distance(at) > coincidence_mm) continue;
    vertices.push_back(known);
    return;
  }
  vertices.push_back(BRepBuilderAPI_MakeVertex(at));
}

// The curve in space beside the one over (u, v), which alone bounds the face.
Status add_curve_in_space(const Curve& curve, const Geometry& geometry, const TopoDS_Edge& edge) {
  Approx_CurveOnSurface approximation(new Geom2dAdaptor_Curve(curve), new GeomAdaptor_Surface(geometry),
                                      curve->FirstParameter(), curve->LastParameter(), curve_tolerance_mm);
  approximation.Perform(most_segments, most_degree, GeomAbs_C0, true);
  if (!approximation.HasResult() || !(approximation.MaxError3d() <= most_curve_error_mm)) {
    return Error{"OpenCASCADE finds no curve in space for a trim loop"};
  }
  const BRep_Builder builder;
  builder.UpdateEdge(edge, approximation.Curve3d(), std::max(coincidence_mm, approximation.MaxError3d()));
  builder.Range(edge, curve->FirstParameter(), curve->LastParameter());
  builder.SameRange(edge, true);
  builder.SameParameter(edge, true);
  return {};
}

Result<TopoDS_Wire> wire_of(const TrimLoop& loop, const Geometry& geometry) {
  const auto curve = curve_of(loop);
  if (!curve) return curve.error();
  const std::vector<double> ends = smooth_ends(curve.value());
  std::vector<TopoDS_Vertex> vertices;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const gp_Pnt2d at = curve.value()->Value(ends[k]);
    add_vertex(geometry->Value(at.X(), at.Y()), vertices);
  }
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Curve piece = Curve::DownCast(curve.value()->Copy());
    piece->Segment(ends[k], ends[k + 1]);
    BRepBuilderAPI_MakeEdge edge(piece, geometry, vertices[k], vertices[(k + 1) % vertices.size()], ends[k],
                                 ends[k + 1]);
    if (!edge.IsDone()) return Error{"OpenCASCADE makes no edge of a trim loop"};
    if (Status added = add_curve_in_space(piece, geometry, edge.Edge()); !added) return added.error();
    wire.Add(edge.Edge());
  }
  if (!wire.IsDone()) return Error{"OpenCASCADE makes no wire of a trim loop"};
  return wire.Wire();
}

bool is_inside(const Eigen::Vector2d& point, const Polygon& polygon) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

struct Outline {
  Polygon polygon;
  double area = 0.0;  // negative of a hole
  TopoDS_Wire wire;
};

Result<std::vector<Outline>> outlines_of(const Geometry& geometry, const TrimmedSurface& part) {
  std::vector<Outline> outlines;
  for (const TrimLoop& loop : part.trims) {
    Outline outline;
    outline.polygon = to_polygon(loop, part.surface.u, part.surface.v);
    outline.area = signed_area(outline.polygon);
    auto wire = wire_of(loop, geometry);
    if (!wire) return wire.error();
    outline.wire = std::move(wire).value();
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// The smallest outer loop about a hole; -1 where the hole is in the whole surface.
int owner_of(const Outline& hole, const std::vector<Outline>& outlines) {
  int owner = -1;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    if (outlines[k].area <= 0.0 || !is_inside(hole.polygon.front(), outlines[k].polygon)) continue;
    if (owner < 0 || outlines[k].area < outlines[static_cast<std::size_t>(owner)].area) {
      owner = static_cast<int>(k);
    }
  }
  return owner;
}

}  // namespace

bool has_no_edge(const Surface& surface) {
  const ControlNet& net = surface.net;
  const bool u = surface.u.is_periodic(), v = surface.v.is_periodic();
  const bool poles_of_v = is_pole(net, Direction::u, 0) && is_pole(net, Direction::u, net.columns - 1);
  const bool poles_of_u = is_pole(net, Direction::v, 0) && is_pole(net, Direction::v, net.rows - 1);
  return (u && v) || (u && poles_of_v) || (v && poles_of_u);
}

Result<std::vector<TrimmedSurface>> opened_parts(const Surface& surface, const std::vector<TrimLoop>& trims) {
  TrimmedSurface part{surface, trims};
  for (const Direction direction : {Direction::u, Direction::v}) {
    if (Status freed = free_a_seam(direction, part); !freed) return freed.error();
  }
  if (trims.empty() || !has_no_edge(surface) || !has_holes_alone(part)) return std::vector{std::move(part)};
  return halves_of(part, surface.u.is_periodic() ? Direction::u : Direction::v);
}

Result<std::vector<TopoDS_Face>> trimmed_faces(const Geometry& geometry, const TrimmedSurface& part) {
  const auto outlines = outlines_of(geometry, part);
  if (!outlines) return outlines.error();
  std::vector<TopoDS_Face> faces;
  const auto add = [&](int owner, BRepBuilderAPI_MakeFace maker) -> Status {
    for (const Outline& hole : outlines.value()) {
      if (hole.area < 0.0 && owner_of(hole, outlines.value()) == owner) maker.Add(hole.wire);
    }
    if (!maker.IsDone()) return Error{"OpenCASCADE makes no face of its trim loops"};
    faces.push_back(maker.Face());
    return {};
  };
  for (std::size_t k = 0; k < outlines->size(); ++k) {
    const Outline& outer = outlines.value()[k];
    if (outer.area <= 0.0) continue;
    const Status added = add(static_cast<int>(k), BRepBuilderAPI_MakeFace(geometry, outer.wire, false));
    if (!added) return added.error();
  }
  if (faces.empty()) {
    if (Status added = add(-1, BRepBuilderAPI_MakeFace(geometry, coincidence_mm)); !added) {
      return added.error();
    }
  }
  return faces;
}

}  // namespace spoonbill
