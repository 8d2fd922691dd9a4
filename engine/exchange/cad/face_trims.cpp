#include "engine/exchange/cad/face_trims.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
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

// The distances of points of the edge from the four sides of the box: whether all are on one of them.
bool runs_along_a_side(const TopoDS_Edge& edge, const TopoDS_Face& face, const ParameterBox& box) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return false;
  const double u_reach = side_share * (box.u_end - box.u_start);
  const double v_reach = side_share * (box.v_end - box.v_start);
  std::array<bool, 4> on_side{true, true, true, true};
  for (int i = 0; i <= samples_per_edge; ++i) {
    const gp_Pnt2d at = curve->Value(first + (last - first) * i / samples_per_edge);
    on_side[0] = on_side[0] && std::abs(at.X() - box.u_start) <= u_reach;
    on_side[1] = on_side[1] && std::abs(at.X() - box.u_end) <= u_reach;
    on_side[2] = on_side[2] && std::abs(at.Y() - box.v_start) <= v_reach;
    on_side[3] = on_side[3] && std::abs(at.Y() - box.v_end) <= v_reach;
  }
  return std::any_of(on_side.begin(), on_side.end(), [](bool on) { return on; });
}

}  // namespace

bool is_trimmed(const TopoDS_Face& face, const ParameterBox& box) {
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    if (!runs_along_a_side(edge, face, box)) return true;
  }
  return false;
}

}  // namespace spoonbill
