#include "engine/exchange/cad/face_trims.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <array>
#include <cmath>

namespace spoonbill {
namespace {

constexpr int samples_per_edge = 16;
// Of the box; files keep curves on a surface less exactly than the surface.
constexpr double side_share = 1e-5;

// The four sides of a box, each where a point of it would be.
std::array<gp_Pnt2d, 4> on_sides(const gp_Pnt2d& at, const ParameterBox& box) {
  return {gp_Pnt2d(box.u_start, at.Y()), gp_Pnt2d(box.u_end, at.Y()), gp_Pnt2d(at.X(), box.v_start),
          gp_Pnt2d(at.X(), box.v_end)};
}

// Whether all its points are on one of the sides.
bool runs_along_a_side(const TopoDS_Edge& edge, const TopoDS_Face& face, const ParameterBox& box,
                       double tolerance) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return false;
  const auto surface = BRep_Tool::Surface(face);
  const double u_reach = side_share * (box.u_end - box.u_start);
  const double v_reach = side_share * (box.v_end - box.v_start);
  const double reach = std::max(tolerance, BRep_Tool::Tolerance(edge));
  std::array<bool, 4> on_side{true, true, true, true};
  for (int i = 0; i <= samples_per_edge; ++i) {
    const gp_Pnt2d at = curve->Value(first + (last - first) * i / samples_per_edge);
    const gp_Pnt place = surface->Value(at.X(), at.Y());
    const std::array<gp_Pnt2d, 4> sides = on_sides(at, box);
    for (std::size_t side = 0; side < sides.size(); ++side) {
      const gp_Pnt2d& there = sides[side];
      on_side[side] = on_side[side] && std::abs(at.X() - there.X()) <= u_reach &&
                      std::abs(at.Y() - there.Y()) <= v_reach &&
                      surface->Value(there.X(), there.Y()).Distance(place) <= reach;
    }
  }
  return std::any_of(on_side.begin(), on_side.end(), [](bool on) { return on; });
}

}  // namespace

bool is_trimmed(const TopoDS_Face& face, const ParameterBox& box, double tolerance) {
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    if (!runs_along_a_side(edge, face, box, tolerance)) return true;
  }
  return false;
}

}  // namespace spoonbill
