#include "engine/exchange/cad/joined_faces.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "engine/exchange/cad/body_shape.h"

namespace spoonbill {
namespace {

// From what files round to what two faces, each approximated, may miss each other by.
constexpr double tolerances_mm[] = {1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 1e-1};

// Sewing makes faces anew, on the same geometry.
using PartOf = std::map<const Geom_Surface*, std::size_t>;

// How many faces of each part.
using FaceCounts = std::map<std::size_t, int>;

struct ClosedShell {
  TopoDS_Shell shell;  // most of its faces as they were
  FaceCounts faces;
  bool is_cavity = false;
};

const Geom_Surface* geometry_of(const TopoDS_Face& face) {
  return BRep_Tool::Surface(face).get();
}

double volume_of(const TopoDS_Shape& shell) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shell, properties);
  return properties.Mass();
}

ClosedShell closed_shell(const TopoDS_Shell& sewn, const PartOf& part_of) {
  ClosedShell closed;
  int as_they_were = 0;
  for (TopExp_Explorer faces(sewn, TopAbs_FACE); faces.More(); faces.Next()) {
    const auto part = part_of.find(geometry_of(TopoDS::Face(faces.Current())));
    if (part != part_of.end()) ++closed.faces[part->second];
    as_they_were += faces.Current().Orientation() == TopAbs_REVERSED ? -1 : 1;
  }
  closed.shell = as_they_were < 0 ? TopoDS::Shell(sewn.Reversed()) : sewn;
  closed.is_cavity = volume_of(closed.shell) < 0.0;
  return closed;
}

std::vector<ClosedShell> sewn_shells(const std::vector<TopoDS_Face>& faces, const PartOf& part_of,
                                     double tolerance_mm) {
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  std::vector<ClosedShell> shells;
  const TopoDS_Shape& shape = sewing.SewedShape();
  if (shape.IsNull()) return shells;
  const auto take = [&](const TopoDS_Shell& shell) {
    if (BRep_Tool::IsClosed(shell)) shells.push_back(closed_shell(shell, part_of));
  };
  for (TopExp_Explorer each(shape, TopAbs_SHELL); each.More(); each.Next()) {
    take(TopoDS::Shell(each.Current()));
  }
  for (TopExp_Explorer each(shape, TopAbs_FACE, TopAbs_SHELL); each.More(); each.Next()) {
    take(shell_of(TopoDS::Face(each.Current())));
  }
  return shells;
}

TopoDS_Solid solid_of(const TopoDS_Shell& outside) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, outside);
  return solid;
}

bool holds(const TopoDS_Solid& solid, const TopoDS_Shell& shell) {
  const TopExp_Explorer vertex(shell, TopAbs_VERTEX);
  if (!vertex.More()) return false;
  const gp_Pnt at = BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()));
  return BRepClass3d_SolidClassifier(solid, at, tolerances_mm[0]).State() == TopAbs_IN;
}

void add(const FaceCounts& more, FaceCounts& counts) {
  for (const auto& [part, count] : more) counts[part] += count;
}

struct Solids {
  std::vector<TopoDS_Solid> solids;
  FaceCounts faces;
};

Solids solids_of(const std::vector<ClosedShell>& shells) {
  Solids found;
  for (const ClosedShell& outside : shells) {
    if (outside.is_cavity) continue;
    const TopoDS_Solid whole = solid_of(outside.shell);
    TopoDS_Solid solid = solid_of(outside.shell);
    FaceCounts faces = outside.faces;
    for (const ClosedShell& cavity : shells) {
      if (!cavity.is_cavity || !holds(whole, cavity.shell)) continue;
      BRep_Builder().Add(solid, cavity.shell);
      add(cavity.faces, faces);
    }
    if (!BRepCheck_Analyzer(solid).IsValid()) continue;
    found.solids.push_back(solid);
    add(faces, found.faces);
  }
  return found;
}

struct AllFaces {
  std::vector<TopoDS_Face> faces;
  PartOf part_of;
  FaceCounts counts;
};

Result<AllFaces> all_faces(const std::vector<const CadSurface*>& parts) {
  AllFaces all;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto of_part = faces_of(*parts[k]);
    if (!of_part) return Error{"'" + parts[k]->name + "': " + of_part.error().message};
    for (const TopoDS_Face& face : of_part->faces) {
      all.faces.push_back(face);
      all.part_of[geometry_of(face)] = k;
      ++all.counts[k];
    }
  }
  return all;
}

// Faces of one surface, of which some would be in a solid and some not, are none of it.
bool are_whole(const FaceCounts& found, const FaceCounts& all) {
  return std::all_of(found.begin(), found.end(),
                     [&](const auto& count) { return count.second == all.at(count.first); });
}

Result<JoinedFaces> join(const std::vector<const CadSurface*>& parts) {
  const auto all = all_faces(parts);
  if (!all) return all.error();
  Solids best;
  for (const double tolerance_mm : tolerances_mm) {
    Solids found = solids_of(sewn_shells(all->faces, all->part_of, tolerance_mm));
    if (found.faces.size() > best.faces.size() && are_whole(found.faces, all->counts)) {
      best = std::move(found);
    }
    if (best.faces.size() == parts.size()) break;
  }
  JoinedFaces joined;
  joined.solids = std::move(best.solids);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (!best.faces.contains(k)) joined.loose.push_back(k);
  }
  return joined;
}

}  // namespace

Result<JoinedFaces> join_faces(const std::vector<const CadSurface*>& parts) {
  try {
    return join(parts);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("its faces cannot be joined (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
