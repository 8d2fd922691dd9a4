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
#include <map>

#include "engine/exchange/cad_stream.h"

namespace spoonbill {
namespace {

using Shapes = opencascade::handle<XCAFDoc_ShapeTool>;

// Assemblies nested deeper are no assemblies.
constexpr int deepest = 64;
constexpr std::size_t longest_shared_name = 190;  // bytes

std::string name_of(const TDF_Label& label) {
  opencascade::handle<TDataStd_Name> name;
  if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();
}

// OpenCASCADE calls by these what has no name.
bool says_nothing(const std::string& name) {
  static const char* const kinds[] = {"SOLID",
                                      "SHELL",
                                      "FACE",
                                      "COMPOUND",
                                      "COMPSOLID",
                                      "WIRE",
                                      "NAUO",
                                      "=>",
                                      "ASSEMBLY",
                                      "OPEN CASCADE",
                                      "Open CASCADE STEP translator"};
  for (const char* kind : kinds) {
    if (name.rfind(kind, 0) == 0) return true;
  }
  return name.empty();
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
            !says_nothing(own)      ? own
            : says_nothing(of_part) ? name
                                    : of_part,
            depth + 1);
    }
  }

  std::vector<NamedFace> take() {
    std::map<std::string, int> uses;
    for (NamedFace& face : faces_) {
      // With room for a number.
      face.name = clean_cad_name(face.name.substr(0, longest_shared_name), "face");
      ++uses[face.name];
    }
    std::map<std::string, int> given;
    for (NamedFace& face : faces_) {
      if (uses[face.name] > 1) face.name += " " + std::to_string(++given[face.name]);
    }
    return std::move(faces_);
  }

 private:
  void visit_part(const TDF_Label& label, const TopLoc_Location& place, const std::string& part_name) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next()) {
      add_faces(label, TopExp_Explorer(solids.Current(), TopAbs_FACE), place,
                better_name(label, solids.Current(), part_name));
    }
    add_faces(label, TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID), place, part_name);
  }

  void add_faces(const TDF_Label& label, TopExp_Explorer faces, const TopLoc_Location& place,
                 const std::string& body_name) {
    for (; faces.More(); faces.Next()) {
      const std::string name = better_name(label, faces.Current(), body_name);
      faces_.push_back({TopoDS::Face(faces.Current().Moved(place)), name});
    }
  }

  std::string better_name(const TDF_Label& part, const TopoDS_Shape& shape, const std::string& otherwise) {
    TDF_Label label;
    if (!shapes_->FindSubShape(part, shape, label)) return otherwise;
    const std::string name = name_of(label);
    return says_nothing(name) ? otherwise : name;
  }

  Shapes shapes_;
  std::vector<NamedFace> faces_;
};

}  // namespace

std::vector<NamedFace> named_faces(const opencascade::handle<TDocStd_Document>& document) {
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
