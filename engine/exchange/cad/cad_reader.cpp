// Reader of STEP and IGES files.
#include <IGESCAFControl_Reader.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_Label.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/face_surface.h"
#include "engine/exchange/cad/file_report.h"
#include "engine/exchange/cad/iges_file.h"
#include "engine/exchange/cad/sewn_faces.h"
#include "engine/exchange/frame_stream.h"

namespace spoonbill {
namespace {

struct NamedFace {
  TopoDS_Face face;
  std::string name;  // name of the face, of its body or of its product; unique within the file
  // Unique name of the face's solid, if the solid has several faces; otherwise empty.
  std::string solid;
};

using Shapes = opencascade::handle<XCAFDoc_ShapeTool>;

// Depth of nesting beyond which assemblies are ignored.
constexpr int depth_limit = 64;

std::string label_name(const TDF_Label& label) {
  opencascade::handle<TDataStd_Name> name;
  if (label.IsNull() || !label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();
}

// Returns true for names that OpenCASCADE gives to shapes and instances without a name.
bool is_generic_name(const std::string& name) {
  static constexpr std::array<std::string_view, 9> kinds{
      "", "SOLID", "SHELL", "FACE", "COMPOUND", "COMPSOLID", "WIRE", "ASSEMBLY", "OPEN CASCADE"};
  static constexpr std::string_view use = "NAUO";
  return std::find(kinds.begin(), kinds.end(), name) != kinds.end() || name.starts_with("=>") ||
         name.starts_with("Open CASCADE STEP translator") ||
         (name.starts_with(use) && name.find_first_not_of("0123456789", use.size()) == std::string::npos);
}

// Returns true for the numbers that OpenCASCADE gives to instances without a name.
bool is_number(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos;
}

// Traversal of an assembly that collects its faces with their names.
class FaceCollector {
 public:
  explicit FaceCollector(Shapes shapes) : shapes_(std::move(shapes)) {}

  void visit(const TDF_Label& label, const TopLoc_Location& location, const std::string& name, int depth) {
    if (depth > depth_limit) return;
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) {
      visit_part(label, location, name);
      return;
    }
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    for (int k = 1; k <= components.Length(); ++k) {
      const TDF_Label& component = components.Value(k);
      TDF_Label part;
      if (!XCAFDoc_ShapeTool::GetReferredShape(component, part)) continue;
      const std::string instance_name = label_name(component), referred_name = label_name(part);
      visit(part, location.Multiplied(XCAFDoc_ShapeTool::GetLocation(component)),
            !is_generic_name(instance_name) && !is_number(instance_name) ? instance_name
            : is_generic_name(referred_name)                             ? name
                                                                         : referred_name,
            depth + 1);
    }
  }

  std::vector<NamedFace> release_faces() {
    std::vector<std::string> names;
    for (const NamedFace& face : found_) names.push_back(face.name);
    names = make_names_unique(names, "face");
    for (std::size_t k = 0; k < names.size(); ++k) found_[k].name = std::move(names[k]);
    std::vector<std::string> solids;
    for (const Solid& solid : solids_) solids.push_back(solid.name);
    solids = make_names_unique(solids, "solid");
    for (std::size_t s = 0; s < solids.size(); ++s) {
      for (std::size_t k = solids_[s].first; k < solids_[s].end; ++k) found_[k].solid = solids[s];
    }
    return std::move(found_);
  }

 private:
  void visit_part(const TDF_Label& label, const TopLoc_Location& location, const std::string& part_name) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next()) {
      const std::size_t before = found_.size();
      const std::string name = shape_name(label, solids.Current(), part_name);
      add_faces(label, TopExp_Explorer(solids.Current(), TopAbs_FACE), location, name);
      const auto count = static_cast<int>(found_.size() - before);
      if (count < 2) continue;
      solids_.push_back({name, before, found_.size()});
    }
    add_faces(label, TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID), location, part_name);
  }

  void add_faces(const TDF_Label& label, TopExp_Explorer faces, const TopLoc_Location& location,
                 const std::string& body_name) {
    for (; faces.More(); faces.Next()) {
      const std::string name = shape_name(label, faces.Current(), body_name);
      found_.push_back({TopoDS::Face(faces.Current().Moved(location)), name, {}});
    }
  }

  std::string shape_name(const TDF_Label& part, const TopoDS_Shape& shape, const std::string& fallback) {
    TDF_Label label;
    if (!shapes_->FindSubShape(part, shape, label)) return fallback;
    const std::string name = label_name(label);
    return is_generic_name(name) ? fallback : name;
  }

  // A solid of more than one face. Its faces are those with indices from `first` to `end` - 1 in `found_`.
  struct Solid {
    std::string name;
    std::size_t first = 0, end = 0;
  };

  Shapes shapes_;
  std::vector<NamedFace> found_;
  std::vector<Solid> solids_;
};

// Returns the faces of a document where its assemblies place them, each with the most specific name.
std::vector<NamedFace> collect_faces(const opencascade::handle<TDocStd_Document>& document) {
  const Shapes shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  FaceCollector collector(shapes);
  for (int k = 1; k <= roots.Length(); ++k) {
    const std::string name = label_name(roots.Value(k));
    // The shape of a root includes its location.
    collector.visit(roots.Value(k), TopLoc_Location(), is_generic_name(name) ? std::string() : name, 0);
  }
  return collector.release_faces();
}

constexpr double parsing_fraction = 0.3, transfer_fraction = 0.5;

using OcctDocument = opencascade::handle<TDocStd_Document>;

struct Content {
  OcctDocument document;
  FileUnit unit;
  LossCount losses = {};
  int external_files = 0;
  int unread_placements = 0;
  // Size of the model divided by the size of the real object, as stated in an IGES file.
  double model_scale = 1.0;
};

OcctDocument new_document() {
  OcctDocument document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  return document;
}

Result<Content> read_step(const std::filesystem::path& file, const Progress& progress) {
  STEPCAFControl_Reader reader;
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  reader.SetNameMode(true);
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) {
    return Error{ErrorCode::malformed, "is not a STEP file, or is damaged"};
  }
  if (!progress.report(parsing_fraction)) return Progress::stopped();
  Content content{new_document(), find_unit(reader.Reader().StepModel())};
  content.external_files = remove_external_files(reader.Reader().StepModel());
  if (!reader.Transfer(content.document)) return Error{ErrorCode::missing, "contains no shape"};
  content.losses = count_losses(reader.Reader().WS(), FileFormat::step);
  content.unread_placements = count_unread_placements(reader.Reader().StepModel());
  return content;
}

Result<Content> read_iges(const std::filesystem::path& file, const Progress& progress) {
  const auto null_entities = count_null_entities(file);
  if (!null_entities) return null_entities.error();
  IGESCAFControl_Reader reader;
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  reader.SetNameMode(true);
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) {
    return Error{ErrorCode::malformed, "is not an IGES file, or is damaged"};
  }
  if (!progress.report(parsing_fraction)) return Progress::stopped();
  Content content{new_document(), find_unit(reader.IGESModel(), file)};
  if (!reader.Transfer(content.document)) return Error{ErrorCode::missing, "contains no shape"};
  content.losses = count_losses(reader.WS(), FileFormat::iges);
  content.losses.unread -= std::min(content.losses.unread, null_entities.value());
  content.unread_placements = count_unread_placements(reader.IGESModel());
  content.model_scale = iges_model_scale(file);
  return content;
}

// Stores the file's unit of length. Adds a note if neither the file nor the caller states a known unit.
void add_unit(const FileUnit& unit, const CadReading& reading, CadModel& model) {
  model.unit = unit.name;
  model.unit_declared = unit.declared;
  if (!unit.declared && reading.unit_m == 0.0) {
    model.unit = "mm";
    model.notes.push_back(
        "the file declares no unit of length that the program knows; millimetres are assumed (--unit sets "
        "another)");
  }
}

Error no_surface_error(const Content& content) {
  if (content.losses.faces > 0) {
    return Error{ErrorCode::malformed, "has " + std::to_string(content.losses.faces) +
                                           " faces, none of which can be read; export it again"};
  }
  if (content.external_files > 0) {
    return Error{ErrorCode::missing,
                 "contains no surface but names other files; export all parts as one file"};
  }
  return Error{ErrorCode::missing, "contains no surface"};
}

// Adds notes about everything in the file that is lost, damaged or ignored.
void add_loss_notes(const Content& content, CadModel& model) {
  const LossCount& losses = content.losses;
  const auto add_note = [&](int lost, int all, const char* what) {
    if (lost == 0) return;
    model.notes.push_back(std::to_string(lost) + " of the file's " + std::to_string(all) + " " + what +
                          " cannot be read and are missing; repair them in the CAD system");
  };
  add_note(losses.lost_faces, losses.faces, "faces");
  add_note(losses.lost_instances, losses.instances, "placed parts");
  if (losses.unread > 0) {
    model.notes.push_back("damaged entities of the file: " + std::to_string(losses.unread) +
                          "; the parts that they belong to are missing or wrong; export the file again");
  }
  if (content.unread_placements > 0) {
    model.notes.push_back(
        "placements that scale, stretch or mirror: " + std::to_string(content.unread_placements) +
        ", which are not read; the parts keep their original size and shape; export them without such "
        "placements");
  }
  if (content.model_scale != 1.0) {
    model.notes.push_back("the file states that it is a model of scale " + number_text(content.model_scale) +
                          ", which is not applied: sizes are those of the model (--unit changes them)");
  }
  if (content.external_files > 0) {
    model.notes.push_back("the file refers to " + std::to_string(content.external_files) +
                          " other files, which are not opened: their parts are missing; export all as one "
                          "file");
  }
}

// Adds a note about solids, because each of their faces becomes a body. The note states how many of the faces
// were converted.
void add_solid_notes(const std::vector<NamedFace>& faces, const std::vector<bool>& converted,
                     CadModel& model) {
  std::set<std::string> solids;
  int read = 0, all = 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (faces[k].solid.empty()) continue;
    ++all;
    if (!converted[k]) continue;
    ++read;
    solids.insert(faces[k].solid);
  }
  if (read == 0) return;
  const std::string counted = read < all ? std::to_string(read) + " of the " : "the ";
  model.notes.push_back(counted + std::to_string(all) + " faces of " +
                        (solids.size() == 1 ? "a solid" : std::to_string(solids.size()) + " solids") +
                        (read == 1 ? " is imported as a body" : " are imported as a body each") +
                        "; on export, the bodies of a solid are joined again if they still enclose it");
}

// Gives the faces that belong to no solid the name of one if they enclose a volume once their edges are
// joined. Adds notes about what was joined, and about how to join the rest.
void join_loose_faces(std::vector<NamedFace>& faces, double scale, double sew_m, CadModel& model) {
  std::vector<std::size_t> loose;
  std::vector<TopoDS_Face> shapes;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (!faces[k].solid.empty()) continue;
    loose.push_back(k);
    shapes.push_back(faces[k].face);
  }
  if (loose.size() < 2) return;
  const double tolerance_mm = sew_m > 0.0 ? sew_m / scale : find_file_tolerance_mm(shapes);
  const auto shells = sew_closed_shells(shapes, tolerance_mm);
  std::set<std::string> taken;
  for (const NamedFace& face : faces) taken.insert(face.solid);
  std::size_t joined = 0;
  for (const std::vector<std::size_t>& shell : shells) {
    std::string name = "solid";
    for (int number = 2; !taken.insert(name).second; ++number) name = "solid " + std::to_string(number);
    for (const std::size_t index : shell) {
      faces[loose[index]].face = shapes[index];
      faces[loose[index]].solid = name;
    }
    joined += shell.size();
  }
  const std::string gap = short_length_text(tolerance_mm * scale);
  if (joined > 0) {
    model.notes.push_back(std::to_string(joined) + " of " + std::to_string(loose.size()) +
                          " loose faces meet within " + gap + " and are joined to " +
                          (shells.size() == 1 ? "a solid" : std::to_string(shells.size()) + " solids"));
  } else if (sew_m > 0.0) {
    model.notes.push_back("the " + std::to_string(loose.size()) +
                          " loose faces enclose no volume if their edges are joined within " + gap);
  } else if (!sew_closed_shells(shapes, largest_sewn_gap_mm).empty()) {
    model.notes.push_back("loose faces enclose a volume if edges up to " +
                          short_length_text(largest_sewn_gap_mm * scale) +
                          " apart are joined; convert the file with --sew to join them");
  }
}

// Returns the factor from OpenCASCADE's coordinates to metres. OpenCASCADE has multiplied the file's numbers
// by `unit.millimetres`. The factor undoes this if the caller states a unit. It also does so if the file
// declares none, and one unit of the file then counts as 1 mm.
double find_scale(const FileUnit& unit, const CadReading& reading) {
  if (reading.unit_m > 0.0) return reading.unit_m / unit.millimetres;
  return unit.declared ? 1e-3 : 1e-3 / unit.millimetres;
}

// Larger deviations of trim loops are reported as this value.
constexpr double trim_deviation_limit_m = 1e6;

CadSurface make_cad_surface(const NamedFace& face, FaceSurface found) {
  CadSurface surface;
  surface.name = face.name;
  surface.surface = std::move(found.surface);
  surface.deviation_m = found.deviation_m;
  surface.trims = std::move(found.trims);
  surface.trim_deviation_m = std::min(found.trim_deviation_m, trim_deviation_limit_m);
  surface.trim_problem = std::move(found.trim_problem);
  // With a face that is whole instead of trimmed, a solid would close without its holes.
  if (surface.trim_problem.empty()) surface.solid = face.solid;
  return surface;
}

// Returns true if a coordinate is outside the range that documents allow.
bool is_far_away(const ControlNet& net) {
  for (const auto* coordinates : {&net.x, &net.y, &net.z}) {
    for (const double coordinate : *coordinates) {
      if (!position_range_m.contains(coordinate)) return true;
    }
  }
  return false;
}

Result<FaceSurface> convert_near_face(const TopoDS_Face& face, double scale, double tolerance_m) {
  auto found = convert_face(face, scale, tolerance_m);
  if (found && is_far_away(found->surface.net)) {
    return Error{ErrorCode::out_of_range,
                 "is more than " + number_text(position_range_m.high) +
                     " m from the origin; move it nearer in the CAD system, or check the unit"};
  }
  return found;
}

// Passes the surfaces of all faces to the sink. Adds notes about solids, about faces that deviate from their
// edges in the file, and about faces that cannot be converted. Fails if no face can be converted.
Status convert_faces(const std::vector<NamedFace>& faces, double scale, const CadReading& reading,
                     const SurfaceSink& sink, const Progress& progress, CadModel& model) {
  std::optional<Error> first;
  std::vector<bool> converted(faces.size(), false);
  std::vector<std::string> skipped, bent;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    auto found = convert_near_face(faces[k].face, scale, reading.tolerance_m);
    if (found) {
      // The deviation of an approximated surface may add to the deviation of its edges.
      if (found->trim_deviation_m > reading.tolerance_m + found->deviation_m) {
        const std::string place = face_place_text(faces[k].face, scale);
        bent.push_back("'" + faces[k].name + "'" + (place.empty() ? "" : " at " + place) + " is up to " +
                       short_length_text(found->trim_deviation_m) +
                       " away from its edges in the file; check it there");
      }
      sink(make_cad_surface(faces[k], std::move(found).value()));
      converted[k] = true;
    } else {
      if (!first) first = found.error().in("'" + faces[k].name + "'");
      const std::string place = face_place_text(faces[k].face, scale);
      skipped.push_back("'" + faces[k].name + "'" + (place.empty() ? "" : " at " + place) +
                        " is skipped: " + found.error().message);
    }
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(faces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  add_solid_notes(faces, converted, model);
  model.notes.insert(model.notes.end(), bent.begin(), bent.end());
  model.notes.insert(model.notes.end(), skipped.begin(), skipped.end());
  return skipped.size() < faces.size() ? Status() : *first;
}

Result<CadModel> read(const std::filesystem::path& file, const CadReading& reading, const SurfaceSink& sink,
                      const Progress& progress) {
  const auto content =
      reading.format == FileFormat::step ? read_step(file, progress) : read_iges(file, progress);
  if (!content) return content.error();
  if (!progress.report(transfer_fraction)) return Progress::stopped();
  std::vector<NamedFace> faces = collect_faces(content->document);
  if (faces.empty()) return no_surface_error(content.value());
  if (faces.size() > reading.face_limit) {
    return Error{ErrorCode::too_many, "has " + std::to_string(faces.size()) + " faces, more than the " +
                                          std::to_string(reading.face_limit) +
                                          " that can be read; export fewer"};
  }
  CadModel model;
  add_unit(content->unit, reading, model);
  add_loss_notes(content.value(), model);
  const double scale = find_scale(content->unit, reading);
  join_loose_faces(faces, scale, reading.sew_m, model);
  const Status status =
      convert_faces(faces, scale, reading, sink, progress.part(transfer_fraction, 1.0), model);
  if (!status) return status.error();
  return model;
}

}  // namespace

Result<CadModel> read_cad(const std::filesystem::path& file, const CadReading& reading,
                          const SurfaceSink& sink, const Progress& progress) {
  SPOONBILL_ASSERT(static_cast<bool>(sink));
  try {
    return read(file, reading, sink, progress);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported,
                 std::string("OpenCASCADE failed to read the file (") + failure.DynamicType()->Name() + ")"};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::too_many, bad_allocation};
  } catch (const std::exception& exception) {
    return Error{ErrorCode::unsupported,
                 std::string("OpenCASCADE failed to read the file (") + exception.what() + ")"};
  }
}

}  // namespace spoonbill
