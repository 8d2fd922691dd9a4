#include "engine/exchange/cad/body_shape.h"

#include <Approx_CurveOnSurface.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <ShapeFix_Shape.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/exchange/cad/occt_surface.h"

namespace spoonbill {
namespace {

struct TrimmedSurface {
  Surface surface;
  std::vector<TrimLoop> trims;
};

using Curve = opencascade::handle<Geom2d_BSplineCurve>;
using SplineGeometry = opencascade::handle<Geom_BSplineSurface>;
using Polygon = std::vector<Eigen::Vector2d>;

constexpr double vertex_distance_mm = 1e-7;
// Largest distance between an edge's curve in space and its curve over (u, v). OpenCASCADE aims at the
// tolerance and exceeds it only at kinks. A larger error than the limit is refused.
constexpr double curve_tolerance_mm = 1e-6, curve_error_limit_mm = 1e-2;
constexpr double corner_sine = 1e-4;
// Largest tolerance that a repaired face may get.
constexpr double healing_tolerance_mm = 1e-2;
constexpr int degree_limit = 14, segment_limit = 1000;

const std::vector<double>& along(const TrimLoop& loop, Direction direction) {
  return direction == Direction::u ? loop.u : loop.v;
}

// Returns the centre of the widest range of parameters, within one period, that no loop reaches. Returns
// nullopt if there is no such range.
std::optional<double> find_free_seam(const KnotVector& knots, Direction direction,
                                     const std::vector<TrimLoop>& trims) {
  const double start = knots.domain_start(), period = knots.domain_end() - start;
  std::vector<std::pair<double, double>> occupied;
  for (const TrimLoop& loop : trims) {
    const auto [low, high] =
        std::minmax_element(along(loop, direction).begin(), along(loop, direction).end());
    for (const double shift : {-period, 0.0, period}) occupied.emplace_back(*low + shift, *high + shift);
  }
  std::sort(occupied.begin(), occupied.end());
  double end = start - period, widest = 1e-6 * period;
  std::optional<double> seam;
  for (const auto& [low, high] : occupied) {
    if (low - end > widest && low > start) {
      widest = low - end;
      seam = 0.5 * (low + end);
    }
    end = std::max(end, high);
  }
  return seam;
}

bool has_loop_outside(const KnotVector& knots, Direction direction, const std::vector<TrimLoop>& trims) {
  const double slack = trim_rounding_fraction * knots.domain_length();
  for (const TrimLoop& loop : trims) {
    for (const double parameter : along(loop, direction)) {
      if (parameter < knots.domain_start() - slack || parameter > knots.domain_end() + slack) return true;
    }
  }
  return false;
}

// Shifts loops by whole periods into the domain.
void shift_into_domain(const KnotVector& knots, Direction direction, std::vector<TrimLoop>& trims) {
  const double period = knots.domain_length();
  for (TrimLoop& loop : trims) {
    std::vector<double>& values = direction == Direction::u ? loop.u : loop.v;
    const double low = *std::min_element(values.begin(), values.end());
    const double shift = period * std::floor((low - knots.domain_start()) / period + trim_rounding_fraction);
    for (double& value : values) value -= shift;
  }
}

Status move_seam(Direction direction, TrimmedSurface& part) {
  const KnotVector knots = direction == Direction::u ? part.surface.u : part.surface.v;
  if (!knots.is_periodic() || !has_loop_outside(knots, direction, part.trims)) return {};
  const auto seam = find_free_seam(knots, direction, part.trims);
  if (!seam) {
    return Error{ErrorCode::unsupported,
                 "its trim loops cross the seam wherever the seam is placed; make a loop smaller"};
  }
  auto moved = with_seam_at(part.surface, direction, *seam);
  if (!moved) return moved.error();
  for (TrimLoop& loop : part.trims) loop = with_seam_at(loop, direction, knots, *seam);
  shift_into_domain(knots, direction, part.trims);
  part.surface = std::move(moved).value();
  return {};
}

bool is_pole(const ControlNet& net, Direction along_edge, int line) {
  const int count = along_edge == Direction::u ? net.rows : net.columns;
  const auto point = [&](int k) {
    return along_edge == Direction::u ? net.point(k, line) : net.point(line, k);
  };
  for (int k = 1; k < count; ++k) {
    if ((point(k) - point(0)).norm() * millimetres_per_metre > vertex_distance_mm) return false;
  }
  return true;
}

bool has_only_holes(const TrimmedSurface& part) {
  return std::all_of(part.trims.begin(), part.trims.end(), [&](const TrimLoop& loop) {
    return signed_area(to_polygon(loop, part.surface.u, part.surface.v)) < 0.0;
  });
}

// Divides a surface at the centre of a gap between its loops. The gap is the one after all loops that begin
// in the first half of the domain.
Result<std::vector<TrimmedSurface>> divide(const TrimmedSurface& part, Direction direction) {
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
      return Error{ErrorCode::unsupported,
                   "its holes leave no room for a cut into two parts; make a hole smaller"};
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

// Converts a loop to an OpenCASCADE curve over (u, v) with clamped ends. The loop becomes an edge of a strip,
// because to_occt(), which clamps the ends, converts surfaces only.
Result<Curve> to_curve(const TrimLoop& loop) {
  ControlNet net(loop.knots.control_point_count(), 2);
  for (int i = 0; i < net.rows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 2; ++j) {
      net.set_point(i, j, Vector3(loop.u[k], loop.v[k], 0.0) / millimetres_per_metre);
    }
  }
  const auto strip = to_occt({loop.knots, KnotVector::clamped_uniform(1, 2).value(), std::move(net)});
  if (!strip) return strip.error();
  const SplineGeometry& edge = strip.value();
  TColgp_Array1OfPnt2d poles(1, edge->NbUPoles());
  for (int i = 1; i <= edge->NbUPoles(); ++i) poles(i) = {edge->Pole(i, 1).X(), edge->Pole(i, 1).Y()};
  return Curve(new Geom2d_BSplineCurve(poles, edge->UKnots(), edge->UMultiplicities(), edge->UDegree()));
}

bool has_corner_at(const Curve& curve, int knot) {
  gp_Pnt2d point;
  gp_Vec2d before, after;
  const double at = curve->Knot(knot);
  curve->LocalD1(at, knot - 1, knot, point, before);
  curve->LocalD1(at, knot, knot + 1, point, after);
  const double lengths = before.Magnitude() * after.Magnitude();
  return !(std::abs(before.Crossed(after)) <= corner_sine * lengths) || before.Dot(after) < 0.0;
}

// Returns the parameters of the ends and corners of the curve.
std::vector<double> find_corners(const Curve& curve) {
  std::vector<double> ends = {curve->FirstParameter()};
  for (int k = curve->FirstUKnotIndex() + 1; k < curve->LastUKnotIndex(); ++k) {
    if (curve->Multiplicity(k) >= curve->Degree() && has_corner_at(curve, k)) ends.push_back(curve->Knot(k));
  }
  ends.push_back(curve->LastParameter());
  return ends;
}

// Appends the vertex at a point to the list. If a vertex already exists there, appends the same vertex once
// more, because a loop may return along a seam.
void add_vertex(const gp_Pnt& at, std::vector<TopoDS_Vertex>& vertices) {
  for (const TopoDS_Vertex& vertex : vertices) {
    if (BRep_Tool::Pnt(vertex).Distance(at) > vertex_distance_mm) continue;
    vertices.push_back(vertex);
    return;
  }
  vertices.push_back(BRepBuilderAPI_MakeVertex(at));
}

// Adds to an edge the curve in space that matches its curve over (u, v).
Status add_curve_in_space(const Curve& curve, const SplineGeometry& geometry, const TopoDS_Edge& edge) {
  Approx_CurveOnSurface approximation(new Geom2dAdaptor_Curve(curve), new GeomAdaptor_Surface(geometry),
                                      curve->FirstParameter(), curve->LastParameter(), curve_tolerance_mm);
  approximation.Perform(segment_limit, degree_limit, GeomAbs_C0, true);
  if (!approximation.HasResult() || !(approximation.MaxError3d() <= curve_error_limit_mm)) {
    return Error{ErrorCode::unsupported, "OpenCASCADE cannot find a curve in space for a trim loop"};
  }
  const BRep_Builder builder;
  builder.UpdateEdge(edge, approximation.Curve3d(), std::max(vertex_distance_mm, approximation.MaxError3d()));
  builder.Range(edge, curve->FirstParameter(), curve->LastParameter());
  builder.SameRange(edge, true);
  builder.SameParameter(edge, true);
  return {};
}

Result<TopoDS_Wire> make_wire(const TrimLoop& loop, const SplineGeometry& geometry) {
  const auto curve = to_curve(loop);
  if (!curve) return curve.error();
  const std::vector<double> ends = find_corners(curve.value());
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
    if (!edge.IsDone()) {
      return Error{ErrorCode::unsupported, "OpenCASCADE cannot make an edge from a trim loop"};
    }
    if (Status added = add_curve_in_space(piece, geometry, edge.Edge()); !added) return added.error();
    wire.Add(edge.Edge());
  }
  if (!wire.IsDone()) return Error{ErrorCode::unsupported, "OpenCASCADE cannot make a wire from a trim loop"};
  return wire.Wire();
}

struct Outline {
  Polygon polygon;
  double area = 0.0;  // negative for a hole
  TopoDS_Wire wire;
};

Result<std::vector<Outline>> make_outlines(const SplineGeometry& geometry, const TrimmedSurface& part) {
  std::vector<Outline> outlines;
  for (const TrimLoop& loop : part.trims) {
    Outline outline;
    outline.polygon = to_polygon(loop, part.surface.u, part.surface.v);
    outline.area = signed_area(outline.polygon);
    auto wire = make_wire(loop, geometry);
    if (!wire) return wire.error();
    outline.wire = std::move(wire).value();
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// Returns the index of the smallest outer loop around a hole; -1 if no outer loop is around it.
int find_owner(const Outline& hole, const std::vector<Outline>& outlines) {
  int owner = -1;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    if (outlines[k].area <= 0.0 || !is_inside(hole.polygon.front(), outlines[k].polygon)) continue;
    if (owner < 0 || outlines[k].area < outlines[static_cast<std::size_t>(owner)].area) {
      owner = static_cast<int>(k);
    }
  }
  return owner;
}

// Returns true if the surface closes: both directions are periodic, or one is and the other ends in poles.
bool is_closed_surface(const Surface& surface) {
  const ControlNet& net = surface.net;
  const bool u = surface.u.is_periodic(), v = surface.v.is_periodic();
  const bool poles_of_v = is_pole(net, Direction::u, 0) && is_pole(net, Direction::u, net.columns - 1);
  const bool poles_of_u = is_pole(net, Direction::v, 0) && is_pole(net, Direction::v, net.rows - 1);
  return (u && v) || (u && poles_of_v) || (v && poles_of_u);
}

// Moves the seams of periodic directions to where no loop crosses them. A surface that closes and has only
// holes is divided into two parts. Refused: loops that leave no such position for a seam, and holes that
// leave no room for the cut.
Result<std::vector<TrimmedSurface>> open_surface(const Surface& surface, const std::vector<TrimLoop>& trims) {
  TrimmedSurface part{surface, trims};
  for (const Direction direction : {Direction::u, Direction::v}) {
    if (Status freed = move_seam(direction, part); !freed) return freed.error();
  }
  if (trims.empty() || !is_closed_surface(surface) || !has_only_holes(part)) {
    return std::vector{std::move(part)};
  }
  return divide(part, surface.u.is_periodic() ? Direction::u : Direction::v);
}

// Makes a face for each outer loop, with the holes in it. If there are only holes or no loops, makes one face
// of the whole surface with the holes. `geometry` is the surface of the part; it is not periodic, and no loop
// may leave its domain.
Result<std::vector<TopoDS_Face>> make_faces(const SplineGeometry& geometry, const TrimmedSurface& part) {
  const auto outlines = make_outlines(geometry, part);
  if (!outlines) return outlines.error();
  std::vector<TopoDS_Face> faces;
  const auto add = [&](int owner, BRepBuilderAPI_MakeFace maker) -> Status {
    for (const Outline& hole : outlines.value()) {
      if (hole.area < 0.0 && find_owner(hole, outlines.value()) == owner) maker.Add(hole.wire);
    }
    if (!maker.IsDone())
      return Error{ErrorCode::unsupported, "OpenCASCADE cannot make a face from the trim loops"};
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
    if (Status added = add(-1, BRepBuilderAPI_MakeFace(geometry, vertex_distance_mm)); !added) {
      return added.error();
    }
  }
  return faces;
}

// Repairs a face that OpenCASCADE rejects, such as one whose outline touches itself. Returns the faces that
// replace it, or the face itself if the repair leaves an invalid one.
std::vector<TopoDS_Face> heal(const TopoDS_Face& face) {
  if (BRepCheck_Analyzer(face).IsValid()) return {face};
  ShapeFix_Shape repair(face);
  repair.SetMaxTolerance(healing_tolerance_mm);
  repair.Perform();
  std::vector<TopoDS_Face> healed;
  for (TopExp_Explorer each(repair.Shape(), TopAbs_FACE); each.More(); each.Next()) {
    healed.push_back(TopoDS::Face(each.Current()));
    if (!BRepCheck_Analyzer(healed.back()).IsValid()) return {face};
  }
  return healed.empty() ? std::vector{face} : healed;
}

constexpr double sewing_tolerance_mm = 1e-6;

// Returns a compound with one shell for each face.
TopoDS_Shape make_compound(const std::vector<TopoDS_Face>& faces) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, make_shell(face));
  return compound;
}

// Sews the faces of a divided surface into one shell with shared edges. Returns a null shape if this does not
// result in a valid shell with all faces.
TopoDS_Shape sew(const std::vector<TopoDS_Face>& faces) {
  BRepBuilderAPI_Sewing sewing(sewing_tolerance_mm);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  const TopoDS_Shape& shape = sewing.SewedShape();
  if (shape.IsNull() || shape.ShapeType() != TopAbs_SHELL || !BRepCheck_Analyzer(shape).IsValid()) return {};
  int count = 0;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) ++count;
  return count == static_cast<int>(faces.size()) ? shape : TopoDS_Shape();
}

TopoDS_Solid make_oriented_solid(const TopoDS_Shell& shell) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

Result<TopoDS_Shape> build_shape(const CadSurface& part) {
  const auto made = build_faces(part);
  if (!made) return made.error();
  const std::vector<TopoDS_Face>& faces = made->faces;
  if (faces.size() == 1) return TopoDS_Shape(make_shell(faces.front()));
  const TopoDS_Shape shell = made->was_cut ? sew(faces) : TopoDS_Shape();
  return shell.IsNull() ? make_compound(faces) : shell;
}

// Returns true if the surface closes and its normals point inwards.
bool is_inside_out(const Surface& surface) {
  if (!is_closed_surface(surface)) return false;
  const auto geometry = to_occt(surface);
  if (!geometry) return false;
  const auto faces = make_faces(geometry.value(), {surface, {}});
  if (!faces || faces->size() != 1) return false;
  const TopoDS_Solid solid = make_oriented_solid(make_shell(faces->front()));
  return TopoDS_Iterator(solid).Value().Orientation() == TopAbs_REVERSED;
}

Result<BodyShape> build_checked_shape(const CadSurface& part) {
  const auto made = build_shape(part);
  if (!made) return made.error();
  const TopoDS_Shape& shape = made.value();
  if (!BRepCheck_Analyzer(shape).IsValid()) {
    return Error{ErrorCode::unsupported, "OpenCASCADE rejects the surface's face as invalid"};
  }
  if (!part.solid.empty()) return BodyShape{shape, false};
  if (shape.ShapeType() == TopAbs_SHELL && shape.Closed()) {
    const TopoDS_Solid solid = make_oriented_solid(TopoDS::Shell(shape));
    if (BRepCheck_Analyzer(solid).IsValid()) return BodyShape{solid, true};
  }
  return BodyShape{is_inside_out(part.surface) ? shape.Reversed() : shape, false};
}

}  // namespace

double measure_volume_mm3(const TopoDS_Shape& shell) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shell, properties);
  return properties.Mass();
}

TopoDS_Shell make_shell(const TopoDS_Face& face) {
  TopoDS_Shell shell;
  const BRep_Builder builder;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  return shell;
}

Result<PartFaces> build_faces(const CadSurface& part) {
  const auto opened = open_surface(part.surface, part.trims);
  if (!opened) return opened.error();
  PartFaces made;
  made.was_cut = opened->size() > 1;
  for (const TrimmedSurface& piece : opened.value()) {
    const auto geometry = to_occt(piece.surface);
    if (!geometry) return geometry.error();
    const auto piece_faces = make_faces(geometry.value(), piece);
    if (!piece_faces) return piece_faces.error();
    for (const TopoDS_Face& face : piece_faces.value()) {
      const std::vector<TopoDS_Face> healed = heal(face);
      made.faces.insert(made.faces.end(), healed.begin(), healed.end());
    }
  }
  return made;
}

Result<BodyShape> build_body_shape(const CadSurface& part) {
  try {
    return build_checked_shape(part);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported,
                 std::string("no face can be built on the surface (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
