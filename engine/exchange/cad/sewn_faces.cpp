#include "engine/exchange/cad/sewn_faces.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>

#include "engine/exchange/cad/body_shape.h"

namespace spoonbill {

double find_file_tolerance_mm(const std::vector<TopoDS_Face>& faces) {
  double tolerance_mm = Precision::Confusion();
  for (const TopoDS_Face& face : faces) {
    for (TopExp_Explorer each(face, TopAbs_EDGE); each.More(); each.Next())
      tolerance_mm = std::max(tolerance_mm, BRep_Tool::Tolerance(TopoDS::Edge(each.Current())));
    for (TopExp_Explorer each(face, TopAbs_VERTEX); each.More(); each.Next())
      tolerance_mm = std::max(tolerance_mm, BRep_Tool::Tolerance(TopoDS::Vertex(each.Current())));
  }
  return std::min(tolerance_mm, largest_sewn_gap_mm);
}

std::vector<std::vector<std::size_t>> sew_closed_shells(std::vector<TopoDS_Face>& faces,
                                                        double tolerance_mm) {
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  std::vector<std::vector<std::size_t>> shells;
  if (sewing.SewedShape().IsNull()) return shells;
  TopTools_DataMapOfShapeInteger index_of;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const TopoDS_Shape sewn = sewing.IsModified(faces[k]) ? sewing.Modified(faces[k]) : faces[k];
    if (!index_of.IsBound(sewn)) index_of.Bind(sewn, static_cast<int>(k));
  }
  for (TopExp_Explorer each(sewing.SewedShape(), TopAbs_SHELL); each.More(); each.Next()) {
    if (!BRep_Tool::IsClosed(each.Current())) continue;
    const bool is_inside_out = measure_volume_mm3(each.Current()) < 0.0;
    std::vector<std::size_t> indices;
    std::vector<TopAbs_Orientation> orientations;
    for (TopExp_Explorer inner(each.Current(), TopAbs_FACE); inner.More(); inner.Next()) {
      if (!index_of.IsBound(inner.Current())) continue;
      indices.push_back(static_cast<std::size_t>(index_of.Find(inner.Current())));
      const TopAbs_Orientation orientation = inner.Current().Orientation();
      orientations.push_back(is_inside_out ? TopAbs::Reverse(orientation) : orientation);
    }
    if (indices.size() < 2) continue;
    for (std::size_t k = 0; k < indices.size(); ++k) faces[indices[k]].Orientation(orientations[k]);
    std::sort(indices.begin(), indices.end());
    shells.push_back(std::move(indices));
  }
  return shells;
}

}  // namespace spoonbill
