#include <gtest/gtest.h>

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_MakePipe.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>
#include <gp_GTrsf.hxx>
#include <numbers>

#include "engine/exchange/cad/cad.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/cad/occt_shapes.h"

namespace spoonbill {

TopoDS_Edge spline_edge(const std::vector<gp_Pnt>& points, bool is_periodic) {
  const opencascade::handle<TColgp_HArray1OfPnt> array =
      new TColgp_HArray1OfPnt(1, static_cast<int>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) array->SetValue(static_cast<int>(k) + 1, points[k]);
  GeomAPI_Interpolate interpolation(array, is_periodic, 1e-6);
  interpolation.Perform();
  return BRepBuilderAPI_MakeEdge(interpolation.Curve());
}

TopoDS_Shape rounded(const TopoDS_Shape& shape, double radius) {
  BRepFilletAPI_MakeFillet maker(shape);
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    maker.Add(radius, TopoDS::Edge(edges.Current()));
  }
  return maker.Shape();
}

namespace {

constexpr double half_turn = std::numbers::pi;

gp_Ax2 at_height(double z) {
  return {gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)};
}

TopoDS_Wire circle_at(double z, double radius) {
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(at_height(z), radius)));
}

TopoDS_Wire ellipse_at(double z, double major, double minor) {
  return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Elips(at_height(z), major, minor)));
}

TopoDS_Wire square(double z, double half) {
  BRepBuilderAPI_MakePolygon polygon(gp_Pnt(-half, -half, z), gp_Pnt(half, -half, z), gp_Pnt(half, half, z),
                                     gp_Pnt(-half, half, z), true);
  return polygon.Wire();
}

TopoDS_Shape loft(const std::vector<TopoDS_Wire>& sections, bool ruled) {
  BRepOffsetAPI_ThruSections maker(true, ruled);
  for (const TopoDS_Wire& section : sections) maker.AddWire(section);
  return maker.Shape();
}

TopoDS_Shape with_one_fillet(const TopoDS_Shape& shape, double radius) {
  BRepFilletAPI_MakeFillet maker(shape);
  maker.Add(radius, TopoDS::Edge(TopExp_Explorer(shape, TopAbs_EDGE).Current()));
  return maker.Shape();
}

TopoDS_Shape chamfered(const TopoDS_Shape& shape, double width) {
  BRepFilletAPI_MakeChamfer maker(shape);
  for (TopExp_Explorer edges(shape, TopAbs_EDGE); edges.More(); edges.Next()) {
    maker.Add(width, TopoDS::Edge(edges.Current()));
  }
  return maker.Shape();
}

TopoDS_Shape hollowed(const TopoDS_Shape& shape, double thickness) {
  TopTools_ListOfShape open;
  open.Append(TopExp_Explorer(shape, TopAbs_FACE).Current());
  BRepOffsetAPI_MakeThickSolid maker;
  maker.MakeThickSolidByJoin(shape, open, -thickness, 1e-3);
  return maker.Shape();
}

TopoDS_Shape as_nurbs(const TopoDS_Shape& shape) {
  return BRepBuilderAPI_NurbsConvert(shape, true).Shape();
}

TopoDS_Shape stretched(const TopoDS_Shape& shape, double x, double y, double z) {
  gp_GTrsf stretch;
  stretch.SetVectorialPart(gp_Mat(x, 0, 0, 0, y, 0, 0, 0, z));
  return BRepBuilderAPI_GTransform(shape, stretch, true).Shape();
}

TopoDS_Shape transformed(const TopoDS_Shape& shape, const gp_Trsf& motion) {
  return BRepBuilderAPI_Transform(shape, motion, true).Shape();
}

gp_Trsf turn() {
  gp_Trsf motion;
  motion.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 1)), 0.7);
  return motion;
}

gp_Trsf mirror() {
  gp_Trsf motion;
  motion.SetMirror(gp_Ax2(gp_Pnt(5, 0, 0), gp_Dir(1, 0.2, 0)));
  return motion;
}

TopoDS_Shape disc(double radius) {
  return BRepBuilderAPI_MakeFace(circle_at(0, radius)).Shape();
}

TopoDS_Shape bottle_profile_turned() {
  const TopoDS_Edge edge = spline_edge(
      {gp_Pnt(20, 0, 0), gp_Pnt(26, 0, 15), gp_Pnt(18, 0, 40), gp_Pnt(9, 0, 55), gp_Pnt(11, 0, 70)});
  return BRepPrimAPI_MakeRevol(edge, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape();
}

TopoDS_Shape pipe_along_spline() {
  const TopoDS_Edge path =
      spline_edge({gp_Pnt(0, 0, 0), gp_Pnt(0, 5, 30), gp_Pnt(10, 20, 60), gp_Pnt(30, 25, 80)});
  return BRepOffsetAPI_MakePipe(BRepBuilderAPI_MakeWire(path), disc(4)).Shape();
}

void add_primitives(std::vector<NamedShape>& all) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(30, 20, 10).Shape();
  all.push_back({"box", box});
  all.push_back({"wedge", BRepPrimAPI_MakeWedge(30, 20, 10, 12).Shape()});
  all.push_back({"sphere", BRepPrimAPI_MakeSphere(15).Shape()});
  all.push_back({"part of a sphere", BRepPrimAPI_MakeSphere(15, -0.5, 1.0, 2.0).Shape()});
  all.push_back({"cylinder", BRepPrimAPI_MakeCylinder(8, 40).Shape()});
  all.push_back({"half cylinder", BRepPrimAPI_MakeCylinder(8, 40, half_turn).Shape()});
  all.push_back({"cone", BRepPrimAPI_MakeCone(10, 0, 30).Shape()});
  all.push_back({"frustum", BRepPrimAPI_MakeCone(10, 4, 30).Shape()});
  all.push_back({"part of a cone", BRepPrimAPI_MakeCone(10, 4, 30, 2.0).Shape()});
  all.push_back({"torus", BRepPrimAPI_MakeTorus(30, 8).Shape()});
  all.push_back({"part of a torus", BRepPrimAPI_MakeTorus(30, 8, 2.5).Shape()});
  all.push_back({"box as NURBS", as_nurbs(box)});
  all.push_back({"sphere as NURBS", as_nurbs(BRepPrimAPI_MakeSphere(15).Shape())});
  all.push_back({"cylinder as NURBS", as_nurbs(BRepPrimAPI_MakeCylinder(8, 40).Shape())});
  all.push_back({"cone as NURBS", as_nurbs(BRepPrimAPI_MakeCone(10, 4, 30).Shape())});
  all.push_back({"torus as NURBS", as_nurbs(BRepPrimAPI_MakeTorus(30, 8).Shape())});
  all.push_back({"ellipsoid", stretched(BRepPrimAPI_MakeSphere(10).Shape(), 1.0, 0.6, 2.0)});
  all.push_back({"stretched torus", stretched(BRepPrimAPI_MakeTorus(30, 8).Shape(), 1.3, 0.8, 1.0)});
  all.push_back({"turned cone", transformed(BRepPrimAPI_MakeCone(10, 4, 30).Shape(), turn())});
  all.push_back({"mirrored wedge", transformed(BRepPrimAPI_MakeWedge(30, 20, 10, 12).Shape(), mirror())});
}

void add_sweeps(std::vector<NamedShape>& all) {
  all.push_back(
      {"prism of an ellipse",
       BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(ellipse_at(0, 12, 5)).Shape(), gp_Vec(3, 4, 30))
           .Shape()});
  all.push_back({"prism of a spline",
                 BRepPrimAPI_MakePrism(
                     spline_edge({gp_Pnt(0, 0, 0), gp_Pnt(10, 8, 0), gp_Pnt(20, -3, 0), gp_Pnt(35, 5, 0)}),
                     gp_Vec(0, 2, 25))
                     .Shape()});
  all.push_back({"turned disc",
                 BRepPrimAPI_MakeRevol(disc(5), gp_Ax1(gp_Pnt(20, 0, 0), gp_Dir(0, 1, 0)), 2.0).Shape()});
  all.push_back({"bottle", bottle_profile_turned()});
  all.push_back({"pipe", pipe_along_spline()});
  all.push_back({"smooth loft", loft({circle_at(0, 10), ellipse_at(20, 14, 8), circle_at(45, 6)}, false)});
  all.push_back({"ruled loft", loft({circle_at(0, 10), ellipse_at(20, 14, 8), circle_at(45, 6)}, true)});
  all.push_back({"loft of squares", loft({square(0, 10), square(15, 14), square(40, 7)}, false)});
  all.push_back({"ruled loft of squares", loft({square(0, 10), square(30, 5)}, true)});
}

void add_features(std::vector<NamedShape>& all) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(30, 20, 10).Shape();
  const TopoDS_Shape cylinder =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(15, 10, -5), gp_Dir(0, 0, 1)), 6, 20).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(30, 20, 10), 9).Shape();
  all.push_back({"rounded box", rounded(box, 3)});
  all.push_back({"box with a fillet", with_one_fillet(box, 4)});
  all.push_back({"rounded cylinder", rounded(BRepPrimAPI_MakeCylinder(8, 40).Shape(), 2)});
  all.push_back({"chamfered box", chamfered(box, 2)});
  all.push_back({"box with a hole", BRepAlgoAPI_Cut(box, cylinder).Shape()});
  all.push_back({"box with a bite", BRepAlgoAPI_Cut(box, ball).Shape()});
  all.push_back({"box and cylinder", BRepAlgoAPI_Fuse(box, cylinder).Shape()});
  all.push_back({"corner of a ball", BRepAlgoAPI_Common(box, ball).Shape()});
  all.push_back(
      {"crossed cylinders",
       BRepAlgoAPI_Fuse(BRepPrimAPI_MakeCylinder(6, 40).Shape(),
                        BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-20, 0, 20), gp_Dir(1, 0, 0)), 5, 40).Shape())
           .Shape()});
  all.push_back({"tray", hollowed(box, 1)});
}

}  // namespace

std::vector<NamedShape> solid_shapes() {
  std::vector<NamedShape> all;
  add_primitives(all);
  add_sweeps(all);
  add_features(all);
  return all;
}

std::vector<NamedShape> every_second(std::vector<NamedShape> shapes, bool from_first) {
  if (is_full_run()) return shapes;
  std::vector<NamedShape> chosen;
  for (std::size_t k = from_first ? 0 : 1; k < shapes.size(); k += 2) chosen.push_back(std::move(shapes[k]));
  return chosen;
}

std::vector<NamedShape> hollow_solids() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(30, 20, 10).Shape();
  const TopoDS_Shape inside = BRepPrimAPI_MakeBox(gp_Pnt(2, 2, 2), 26, 16, 6).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(15, 10, 5), 4).Shape();
  const TopoDS_Shape around = BRepPrimAPI_MakeSphere(gp_Pnt(15, 10, 5), 9).Shape();
  return {{"hollow box", BRepAlgoAPI_Cut(box, inside).Shape()},
          {"box with a bubble", BRepAlgoAPI_Cut(box, ball).Shape()},
          {"hollow ball", BRepAlgoAPI_Cut(around, ball).Shape()}};
}

TopoDS_Shape drilled_box() {
  const TopoDS_Shape box = with_one_fillet(BRepPrimAPI_MakeBox(30, 20, 10).Shape(), 4);
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(18, 10, -5), gp_Dir(0, 0, 1)), 3, 20).Shape();
  return BRepAlgoAPI_Cut(box, drill).Shape();
}

CadModel read_through_step(const TopoDS_Shape& shape, const std::filesystem::path& folder,
                           const CadReading& reading) {
  set_file_unit("mm");
  const auto file = folder / "in.step";
  STEPControl_Writer writer;
  EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
  std::vector<CadSurface> surfaces;
  auto model = read_cad(file, reading, [&](CadSurface part) { surfaces.push_back(std::move(part)); });
  EXPECT_TRUE(model) << model.error().message;
  if (!model) return {};
  model->surfaces = std::move(surfaces);
  return std::move(model).value();
}

int count_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int count = 0;
  for (TopExp_Explorer each(shape, kind); each.More(); each.Next()) ++count;
  return count;
}

}  // namespace spoonbill
