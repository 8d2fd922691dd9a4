#include "engine/exchange/cad/body_shape.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <vector>

#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/trimmed_face.h"

namespace spoonbill {
namespace {

constexpr double coincidence_mm = 1e-6;

// Faces apart are no shell.
TopoDS_Shape beside_each_other(const std::vector<TopoDS_Face>& faces) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, shell_of(face));
  return compound;
}

// One shell of what was a surface before it was cut in parts, whose edges its faces share; null where they
// do not meet.
TopoDS_Shape sewn(const std::vector<TopoDS_Face>& faces) {
  BRepBuilderAPI_Sewing sewing(coincidence_mm);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  const TopoDS_Shape& shape = sewing.SewedShape();
  if (shape.IsNull() || shape.ShapeType() != TopAbs_SHELL || !BRepCheck_Analyzer(shape).IsValid()) return {};
  int count = 0;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) ++count;
  return count == static_cast<int>(faces.size()) ? shape : TopoDS_Shape();
}

TopoDS_Solid solid_of(const TopoDS_Shell& shell) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

Result<TopoDS_Shape> shape_of(const CadSurface& part) {
  const auto made = faces_of(part);
  if (!made) return made.error();
  const std::vector<TopoDS_Face>& faces = made->faces;
  if (faces.size() == 1) return TopoDS_Shape(shell_of(faces.front()));
  const TopoDS_Shape shell = made->was_cut ? sewn(faces) : TopoDS_Shape();
  return shell.IsNull() ? beside_each_other(faces) : shell;
}

// Whether the normals of a surface that closes point inwards.
bool is_inside_out(const Surface& surface) {
  if (!has_no_edge(surface)) return false;
  const auto geometry = to_occt(surface);
  if (!geometry) return false;
  const auto faces = trimmed_faces(geometry.value(), {surface, {}});
  if (!faces || faces->size() != 1) return false;
  const TopoDS_Solid solid = solid_of(shell_of(faces->front()));
  return TopoDS_Iterator(solid).Value().Orientation() == TopAbs_REVERSED;
}

Result<BodyShape> build(const CadSurface& part) {
  const auto made = shape_of(part);
  if (!made) return made.error();
  const TopoDS_Shape& shape = made.value();
  if (!BRepCheck_Analyzer(shape).IsValid()) return Error{"OpenCASCADE calls the face of it invalid"};
  if (!part.solid.empty()) return BodyShape{shape, false};
  if (shape.ShapeType() == TopAbs_SHELL && shape.Closed()) {
    const TopoDS_Solid solid = solid_of(TopoDS::Shell(shape));
    if (BRepCheck_Analyzer(solid).IsValid()) return BodyShape{solid, true};
  }
  return BodyShape{is_inside_out(part.surface) ? shape.Reversed() : shape, false};
}

}  // namespace

TopoDS_Shell shell_of(const TopoDS_Face& face) {
  TopoDS_Shell shell;
  const BRep_Builder builder;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  return shell;
}

Result<PartFaces> faces_of(const CadSurface& part) {
  const auto opened = opened_parts(part.surface, part.trims);
  if (!opened) return opened.error();
  PartFaces made;
  made.was_cut = opened->size() > 1;
  for (const TrimmedSurface& piece : opened.value()) {
    const auto geometry = to_occt(piece.surface);
    if (!geometry) return geometry.error();
    const auto of_piece = trimmed_faces(geometry.value(), piece);
    if (!of_piece) return of_piece.error();
    made.faces.insert(made.faces.end(), of_piece->begin(), of_piece->end());
  }
  return made;
}

Result<BodyShape> body_shape(const CadSurface& part) {
  try {
    return build(part);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("no face can be built on the surface (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
