#include "engine/exchange/cad/named_faces.h"

#include <TCollection_AsciiString.hxx>
#include <TDF_Label.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "engine/exchange/cad_names.h"

namespace spoonbill {
namespace {

using Shapes = opencascade::handle<XCAFDoc_ShapeTool>;

// Assemblies nested deeper are no assemblies.
constexpr int deepest = 64;

std::string name_of(const TDF_Label& label) {
  opencascade::handle<TDataStd_Name> name;
  if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();
}

// What OpenCASCADE calls shapes, and the use of a part in an assembly, that have no name.
bool says_nothing(const std::string& name) {
  static constexpr std::array<std::string_view, 9> kinds{
      "", "SOLID", "SHELL", "FACE", "COMPOUND", "COMPSOLID", "WIRE", "ASSEMBLY", "OPEN CASCADE"};
  static constexpr std::string_view use = "NAUO";
  return std::find(kinds.begin(), kinds.end(), name) != kinds.end() || name.starts_with("=>") ||
         name.starts_with("Open CASCADE STEP translator") ||
         (name.starts_with(use) && name.find_first_not_of("0123456789", use.size()) == std::string::npos);
}

// What OpenCASCADE counts for a use without a name.
bool is_number(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos;
}

class Collector {
 public:
  explicit Collector(Shapes shapes) : shapes_(std::move(shapes)) {}

  void visit(const TDF_Label& label, const TopLoc_Location& place, const std::string& name, int depth) {
    if (depth > deepest) return;
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) {
      visit_part(label, place, name);
      return;
    }
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    for (int k = 1; k <= components.Length(); ++k) {
      const TDF_Label& component = components.Value(k);
      TDF_Label part;
      if (!XCAFDoc_ShapeTool::GetReferredShape(component, part)) continue;
      const std::string own = name_of(component), of_part = name_of(part);
      visit(part, place.Multiplied(XCAFDoc_ShapeTool::GetLocation(component)),
            !says_nothing(own) && !is_number(own) ? own
            : says_nothing(of_part)               ? name
                                                  : of_part,
            depth + 1);
    }
  }

  NamedFaces take() {
    std::vector<std::string> names;
    for (const NamedFace& face : found_.faces) names.push_back(face.name);
    names = told_apart(names, "face");
    for (std::size_t k = 0; k < names.size(); ++k) found_.faces[k].name = std::move(names[k]);
    std::vector<std::string> solids;
    for (const Solid& solid : solids_) solids.push_back(solid.name);
    solids = told_apart(solids, "solid");
    for (std::size_t s = 0; s < solids.size(); ++s) {
      for (std::size_t k = solids_[s].first; k < solids_[s].end; ++k) found_.faces[k].solid = solids[s];
    }
    return std::move(found_);
  }

 private:
  void visit_part(const TDF_Label& label, const TopLoc_Location& place, const std::string& part_name) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next()) {
      const std::size_t before = found_.faces.size();
      const std::string name = better_name(label, solids.Current(), part_name);
      add_faces(label, TopExp_Explorer(solids.Current(), TopAbs_FACE), place, name);
      const auto count = static_cast<int>(found_.faces.size() - before);
      if (count < 2) continue;
      solids_.push_back({name, before, found_.faces.size()});
      ++found_.solids;
      found_.faces_of_solids += count;
    }
    add_faces(label, TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID), place, part_name);
  }

  void add_faces(const TDF_Label& label, TopExp_Explorer faces, const TopLoc_Location& place,
                 const std::string& body_name) {
    for (; faces.More(); faces.Next()) {
      const std::string name = better_name(label, faces.Current(), body_name);
      found_.faces.push_back({TopoDS::Face(faces.Current().Moved(place)), name, {}});
    }
  }

  std::string better_name(const TDF_Label& part, const TopoDS_Shape& shape, const std::string& otherwise) {
    TDF_Label label;
    if (!shapes_->FindSubShape(part, shape, label)) return otherwise;
    const std::string name = name_of(label);
    return says_nothing(name) ? otherwise : name;
  }

  // A range of the faces.
  struct Solid {
    std::string name;
    std::size_t first = 0, end = 0;
  };

  Shapes shapes_;
  NamedFaces found_;
  std::vector<Solid> solids_;
};

}  // namespace

NamedFaces named_faces(const opencascade::handle<TDocStd_Document>& document) {
  const Shapes shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  Collector collector(shapes);
  for (int k = 1; k <= roots.Length(); ++k) {
    const std::string name = name_of(roots.Value(k));
    // The shape of a root holds its own place.
    collector.visit(roots.Value(k), TopLoc_Location(), says_nothing(name) ? std::string() : name, 0);
  }
  return collector.take();
}

}  // namespace spoonbill
