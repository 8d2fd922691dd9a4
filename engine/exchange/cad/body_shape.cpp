#include "engine/exchange/cad/body_shape.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>

namespace spoonbill {
namespace {

// Millimetres: OpenCASCADE's own for points that are one.
constexpr double coincidence_mm = 1e-7;

TopoDS_Shell shell_of(const TopoDS_Face& face) {
  TopoDS_Shell shell;
  const BRep_Builder builder;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  return shell;
}

TopoDS_Solid solid_of(const TopoDS_Shell& shell) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

Result<BodyShape> build(const opencascade::handle<Geom_BSplineSurface>& surface) {
  BRepBuilderAPI_MakeFace maker(surface, coincidence_mm);
  if (!maker.IsDone()) return Error{"no face can be built on the surface"};
  const TopoDS_Shell shell = shell_of(maker.Face());
  if (!BRepCheck_Analyzer(shell).IsValid()) return Error{"the face built on the surface is not valid"};
  if (shell.Closed()) {
    const TopoDS_Solid solid = solid_of(shell);
    if (BRepCheck_Analyzer(solid).IsValid()) return BodyShape{solid, true};
  }
  return BodyShape{shell, false};
}

}  // namespace

Result<BodyShape> body_shape(const opencascade::handle<Geom_BSplineSurface>& surface) {
  try {
    return build(surface);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("no face can be built on the surface (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
