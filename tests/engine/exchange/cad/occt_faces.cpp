#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Circ2d.hxx>
#include <gp_Elips2d.hxx>

#include "tests/engine/exchange/cad/occt_shapes.h"

namespace spoonbill {
namespace {

constexpr double tolerance_mm = 1e-6;

using Geometry = opencascade::handle<Geom_Surface>;

gp_Ax3 frame() {
  return gp_Ax3(gp_Pnt(3, -2, 5), gp_Dir(0.2, 0.1, 1.0));
}

// Returns the poles of a wavy net that measures 60 x 40 mm.
TColgp_Array2OfPnt wavy_poles(int rows, int columns) {
  TColgp_Array2OfPnt poles(1, rows, 1, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      poles(i + 1, j + 1) = gp_Pnt(60.0 * i / (rows - 1), 40.0 * j / (columns - 1),
                                   6.0 * std::sin(1.3 * i + 0.4 * j) + 2.0 * j);
    }
  }
  return poles;
}

TColStd_Array2OfReal uneven_weights(int rows, int columns) {
  TColStd_Array2OfReal weights(1, rows, 1, columns);
  for (int i = 1; i <= rows; ++i) {
    for (int j = 1; j <= columns; ++j) weights(i, j) = 1.0 + 0.8 * ((i * 7 + j * 3) % 4) / 3.0;
  }
  return weights;
}

struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;
};

// Returns clamped, evenly spaced knots for this number of poles. Each inner knot is single.
Knots knots_for(int poles, int degree) {
  const int inner = poles - degree - 1;
  Knots knots{TColStd_Array1OfReal(1, inner + 2), TColStd_Array1OfInteger(1, inner + 2)};
  for (int k = 0; k < inner + 2; ++k) {
    knots.values(k + 1) = static_cast<double>(k) / (inner + 1);
    knots.multiplicities(k + 1) = k == 0 || k == inner + 1 ? degree + 1 : 1;
  }
  return knots;
}

Geometry spline(int rows, int u_degree, int columns, int v_degree, bool rational) {
  const Knots u = knots_for(rows, u_degree), v = knots_for(columns, v_degree);
  const TColgp_Array2OfPnt poles = wavy_poles(rows, columns);
  if (!rational) {
    return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities, u_degree,
                                   v_degree);
  }
  return new Geom_BSplineSurface(poles, uneven_weights(rows, columns), u.values, v.values, u.multiplicities,
                                 v.multiplicities, u_degree, v_degree);
}

TopoDS_Face whole(const Geometry& surface) {
  return BRepBuilderAPI_MakeFace(surface, tolerance_mm).Face();
}

TopoDS_Face part(const Geometry& surface, double u_start, double u_end, double v_start, double v_end) {
  return BRepBuilderAPI_MakeFace(surface, u_start, u_end, v_start, v_end, tolerance_mm).Face();
}

// Returns the part of a surface inside a closed curve in its parameter plane.
TopoDS_Face inside(const Geometry& surface, const opencascade::handle<Geom2d_Curve>& curve) {
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(curve, surface);
  TopoDS_Face face = BRepBuilderAPI_MakeFace(surface, BRepBuilderAPI_MakeWire(edge).Wire(), true).Face();
  BRepLib::BuildCurves3d(face);
  return face;
}

opencascade::handle<Geom2d_Curve> circle(double u, double v, double radius) {
  return new Geom2d_Circle(gp_Circ2d(gp_Ax2d(gp_Pnt2d(u, v), gp_Dir2d(1, 0)), radius));
}

opencascade::handle<Geom2d_Curve> ellipse(double u, double v, double major, double minor) {
  return new Geom2d_Ellipse(gp_Elips2d(gp_Ax2d(gp_Pnt2d(u, v), gp_Dir2d(1, 0.3)), major, minor));
}

TopoDS_Face with_hole(const Geometry& surface, const opencascade::handle<Geom2d_Curve>& hole) {
  BRepBuilderAPI_MakeFace maker(surface, tolerance_mm);
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(hole, surface);
  maker.Add(TopoDS::Wire(BRepBuilderAPI_MakeWire(edge).Wire().Reversed()));
  TopoDS_Face face = maker.Face();
  BRepLib::BuildCurves3d(face);
  return face;
}

Geometry bezier(int rows, int columns, bool rational) {
  if (rational) return new Geom_BezierSurface(wavy_poles(rows, columns), uneven_weights(rows, columns));
  return new Geom_BezierSurface(wavy_poles(rows, columns));
}

Geometry turned_spline() {
  TColgp_Array1OfPnt poles(1, 5);
  poles(1) = gp_Pnt(10, 0, 0);
  poles(2) = gp_Pnt(18, 0, 8);
  poles(3) = gp_Pnt(5, 0, 20);
  poles(4) = gp_Pnt(14, 0, 30);
  poles(5) = gp_Pnt(9, 0, 42);
  return new Geom_SurfaceOfRevolution(new Geom_BezierCurve(poles), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)));
}

}  // namespace

std::vector<NamedShape> single_faces() {
  std::vector<NamedShape> all;
  const Geometry wavy = spline(7, 3, 6, 3, false), rational = spline(7, 3, 6, 2, true);
  const Geometry cylinder = new Geom_CylindricalSurface(frame(), 12);
  const Geometry sphere = new Geom_SphericalSurface(frame(), 20);
  all.push_back({"spline", whole(wavy)});
  all.push_back({"rational spline", whole(rational)});
  all.push_back({"spline of degree 12", whole(spline(14, 12, 5, 2, false))});
  all.push_back({"rational spline of degree 11", whole(spline(13, 11, 12, 11, true))});
  all.push_back({"rational Bezier", whole(bezier(4, 5, true))});
  all.push_back({"Bezier of degree 14", whole(bezier(15, 3, false))});
  all.push_back({"part of a spline", part(wavy, 0.13, 0.71, 0.2, 0.9)});
  all.push_back({"part of a rational spline", part(rational, 0.13, 0.71, 0.2, 0.9)});
  all.push_back({"spline in an ellipse", inside(wavy, ellipse(0.5, 0.5, 0.4, 0.2))});
  all.push_back({"rational spline with a hole", with_hole(rational, circle(0.5, 0.4, 0.2))});
  all.push_back({"plane in a circle", inside(new Geom_Plane(frame()), circle(5, 7, 11))});
  all.push_back({"cylinder in a circle", inside(cylinder, circle(2.0, 10.0, 0.9))});
  all.push_back({"sphere in a circle", inside(sphere, circle(3.0, 0.3, 0.7))});
  all.push_back({"strip of a torus", part(new Geom_ToroidalSurface(frame(), 30, 7), 1.0, 4.0, 5.0, 7.5)});
  all.push_back({"offset spline", whole(new Geom_OffsetSurface(wavy, 2.0))});
  all.push_back({"turned Bezier", part(turned_spline(), 0.5, 5.0, 0.0, 1.0)});
  return all;
}

}  // namespace spoonbill
