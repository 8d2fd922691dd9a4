#include "engine/exchange/cad/body_shape.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <vector>

#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/trimmed_face.h"

namespace spoonbill {
namespace {

TopoDS_Shell shell_of(const TopoDS_Face& face) {
  TopoDS_Shell shell;
  const BRep_Builder builder;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  return shell;
}

// Faces apart are no shell.
TopoDS_Shape together(const std::vector<TopoDS_Face>& faces) {
  if (faces.size() == 1) return shell_of(faces.front());
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, shell_of(face));
  return compound;
}

TopoDS_Solid solid_of(const TopoDS_Shell& shell) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

Result<std::vector<TopoDS_Face>> faces_of(const CadSurface& part) {
  const auto opened = opened_parts(part.surface, part.trims);
  if (!opened) return opened.error();
  std::vector<TopoDS_Face> faces;
  for (const TrimmedSurface& piece : opened.value()) {
    const auto geometry = to_occt(piece.surface);
    if (!geometry) return geometry.error();
    const auto of_piece = trimmed_faces(geometry.value(), piece);
    if (!of_piece) return of_piece.error();
    faces.insert(faces.end(), of_piece->begin(), of_piece->end());
  }
  return faces;
}

Result<BodyShape> build(const CadSurface& part) {
  const auto faces = faces_of(part);
  if (!faces) return faces.error();
  const TopoDS_Shape shape = together(faces.value());
  if (!BRepCheck_Analyzer(shape).IsValid()) return Error{"OpenCASCADE calls the face of it invalid"};
  if (shape.ShapeType() == TopAbs_SHELL && shape.Closed()) {
    const TopoDS_Solid solid = solid_of(TopoDS::Shell(shape));
    if (BRepCheck_Analyzer(solid).IsValid()) return BodyShape{solid, true};
  }
  return BodyShape{shape, false};
}

}  // namespace

Result<BodyShape> body_shape(const CadSurface& part) {
  try {
    return build(part);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("no face can be built on the surface (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
