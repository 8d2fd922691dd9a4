#include "engine/exchange/cad/joined_faces.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/sewn_faces.h"

namespace spoonbill {
namespace {

// Sewing tolerances in the order in which they are tried: from the rounding of files to the gap between two
// approximated faces.
constexpr double tolerances_mm[] = {1e-5, 1e-4, 1e-3, 1e-2, 3e-2, largest_sewn_gap_mm};

// Width up to which gaps between two faces are not reported. The limit is twice the largest deviation of a
// face from its original, if that is more.
constexpr double expected_gap_m = 2e-5;
constexpr int gap_samples = 16;

// Index of the part to which each surface geometry belongs. Sewing makes new faces but keeps their
// geometries, which thus identify the parts.
using PartOf = std::map<const Geom_Surface*, std::size_t>;

// Number of faces of each part, by the index of the part.
using FaceCounts = std::map<std::size_t, int>;

struct ClosedShell {
  TopoDS_Shell shell;  // oriented like most of its faces
  FaceCounts faces;
  bool is_cavity = false;
};

const Geom_Surface* get_geometry(const TopoDS_Face& face) {
  return BRep_Tool::Surface(face).get();
}

ClosedShell make_closed_shell(const TopoDS_Shell& sewn, const PartOf& part_of) {
  ClosedShell closed;
  int balance = 0;
  for (TopExp_Explorer faces(sewn, TopAbs_FACE); faces.More(); faces.Next()) {
    const auto part = part_of.find(get_geometry(TopoDS::Face(faces.Current())));
    if (part != part_of.end()) ++closed.faces[part->second];
    balance += faces.Current().Orientation() == TopAbs_REVERSED ? -1 : 1;
  }
  closed.shell = balance < 0 ? TopoDS::Shell(sewn.Reversed()) : sewn;
  closed.is_cavity = measure_volume_mm3(closed.shell) < 0.0;
  return closed;
}

std::vector<ClosedShell> sew_shells(const std::vector<TopoDS_Face>& faces, const PartOf& part_of,
                                    double tolerance_mm) {
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  std::vector<ClosedShell> shells;
  const TopoDS_Shape& shape = sewing.SewedShape();
  if (shape.IsNull()) return shells;
  const auto add_if_closed = [&](const TopoDS_Shell& shell) {
    if (BRep_Tool::IsClosed(shell)) shells.push_back(make_closed_shell(shell, part_of));
  };
  for (TopExp_Explorer each(shape, TopAbs_SHELL); each.More(); each.Next()) {
    add_if_closed(TopoDS::Shell(each.Current()));
  }
  for (TopExp_Explorer each(shape, TopAbs_FACE, TopAbs_SHELL); each.More(); each.Next()) {
    add_if_closed(make_shell(TopoDS::Face(each.Current())));
  }
  return shells;
}

TopoDS_Solid make_solid(const TopoDS_Shell& outside) {
  TopoDS_Solid solid;
  const BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, outside);
  return solid;
}

bool encloses(const TopoDS_Solid& solid, const TopoDS_Shell& shell) {
  const TopExp_Explorer vertex(shell, TopAbs_VERTEX);
  if (!vertex.More()) return false;
  const gp_Pnt at = BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()));
  return BRepClass3d_SolidClassifier(solid, at, tolerances_mm[0]).State() == TopAbs_IN;
}

void add(const FaceCounts& more, FaceCounts& counts) {
  for (const auto& [part, count] : more) counts[part] += count;
}

// Returns the largest distance between the curves that an edge has on its two faces.
double edge_gap_m(const TopoDS_Edge& edge, const TopoDS_Face& one, const TopoDS_Face& other) {
  const BRepAdaptor_Curve first_curve(edge, one), second_curve(edge, other);
  double widest_mm = 0.0;
  for (int k = 0; k <= gap_samples; ++k) {
    const double fraction = static_cast<double>(k) / gap_samples;
    const auto at = [fraction](const BRepAdaptor_Curve& curve) {
      return curve.Value(curve.FirstParameter() +
                         fraction * (curve.LastParameter() - curve.FirstParameter()));
    };
    widest_mm = std::max(widest_mm, at(first_curve).Distance(at(second_curve)));
  }
  return widest_mm / millimetres_per_metre;
}

double widest_gap_m(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
  double widest_m = 0.0;
  for (int k = 1; k <= faces_of_edge.Extent(); ++k) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of_edge.FindKey(k));
    const TopTools_ListOfShape& faces = faces_of_edge(k);
    if (BRep_Tool::Degenerated(edge) || faces.Extent() != 2) continue;
    widest_m = std::max(widest_m, edge_gap_m(edge, TopoDS::Face(faces.First()), TopoDS::Face(faces.Last())));
  }
  return widest_m;
}

struct Solids {
  std::vector<JoinedSolid> solids;
  FaceCounts faces;
};

Solids make_solids(const std::vector<ClosedShell>& shells) {
  Solids found;
  for (const ClosedShell& outside : shells) {
    if (outside.is_cavity) continue;
    const TopoDS_Solid whole = make_solid(outside.shell);
    TopoDS_Solid solid = make_solid(outside.shell);
    FaceCounts faces = outside.faces;
    for (const ClosedShell& cavity : shells) {
      if (!cavity.is_cavity || !encloses(whole, cavity.shell)) continue;
      BRep_Builder().Add(solid, cavity.shell);
      add(cavity.faces, faces);
    }
    if (!BRepCheck_Analyzer(solid).IsValid()) continue;
    JoinedSolid joined{solid, widest_gap_m(solid), {}};
    for (const auto& [part, count] : faces) joined.parts.push_back(part);
    found.solids.push_back(std::move(joined));
    add(faces, found.faces);
  }
  return found;
}

struct AllFaces {
  std::vector<TopoDS_Face> faces;
  PartOf part_of;
  FaceCounts counts;
};

Result<AllFaces> collect_all_faces(const std::vector<const CadSurface*>& parts) {
  AllFaces all;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    CadSurface part = *parts[k];
    part.surface = close_exactly(part.surface).surface;
    const auto part_faces = build_faces(part);
    if (!part_faces) return part_faces.error().in("'" + parts[k]->name + "'");
    for (const TopoDS_Face& face : part_faces->faces) {
      all.faces.push_back(face);
      all.part_of[get_geometry(face)] = k;
      ++all.counts[k];
    }
  }
  return all;
}

// Returns true if every part that has a face in `found` has all its faces there. A part with only some of its
// faces in solids could be neither joined nor loose.
bool are_complete(const FaceCounts& found, const FaceCounts& all) {
  return std::all_of(found.begin(), found.end(),
                     [&](const auto& count) { return count.second == all.at(count.first); });
}

Result<JoinedFaces> join(const std::vector<const CadSurface*>& parts) {
  const auto all = collect_all_faces(parts);
  if (!all) return all.error();
  Solids best;
  for (const double tolerance_mm : tolerances_mm) {
    Solids found = make_solids(sew_shells(all->faces, all->part_of, tolerance_mm));
    if (found.faces.size() > best.faces.size() && are_complete(found.faces, all->counts)) {
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

double explained_gap_m(const std::vector<const CadSurface*>& parts) {
  double explained_m = expected_gap_m;
  for (const CadSurface* part : parts) explained_m = std::max(explained_m, 2.0 * part->deviation_m);
  return explained_m;
}

}  // namespace

std::vector<std::string> describe_joining(const JoinedFaces& joined, const std::string& name,
                                          const std::vector<const CadSurface*>& parts,
                                          const std::string& loose_outcome) {
  std::vector<std::string> notes;
  double gap_m = 0.0;
  for (const JoinedSolid& solid : joined.solids) gap_m = std::max(gap_m, solid.gap_m);
  if (gap_m > explained_gap_m(parts)) {
    notes.push_back("the faces of '" + name + "' have gaps of up to " + short_length_text(gap_m) +
                    "; they are joined as if there were none");
  }
  if (!joined.loose.empty()) {
    notes.push_back(std::to_string(joined.loose.size()) + " of the " + std::to_string(parts.size()) +
                    " faces of '" + name + "' together enclose no volume" + loose_outcome);
  }
  return notes;
}

Result<JoinedFaces> join_faces(const std::vector<const CadSurface*>& parts) {
  try {
    return join(parts);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::mismatch,
                 std::string("its faces cannot be joined (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
