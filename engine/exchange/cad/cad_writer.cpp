// Writer of STEP and IGES files, and OpenCASCADE's settings.
#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBndLib.hxx>
#include <BRepToIGESBRep_Entity.hxx>
#include <Bnd_Box.hxx>
#include <IGESBasic_Name.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESData_Protocol.hxx>
#include <IGESSelect_WorkLibrary.hxx>
#include <Interface_FloatWriter.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <Standard_Failure.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_Label.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <cstdint>
#include <cstdio>
#include <new>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/text.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/joined_faces.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/frame_stream.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

struct WrittenBody {
  std::string name;  // name, unique within the file
  TopoDS_Shape shape;
  bool solid = false;
  // Surface of the model; null for a solid joined from several surfaces.
  const CadSurface* surface = nullptr;
};

const char* const two_bytes = "\\X2\\";
const char* const four_bytes = "\\X4\\";

struct Character {
  std::uint32_t code;
  std::size_t bytes;
};

// Decodes the non-ASCII character that begins at `start` in valid UTF-8. A line break within the character is
// skipped.
Character character_at(std::string_view text, std::size_t start) {
  const auto byte = [&](std::size_t k) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k]));
  };
  const std::size_t wanted = byte(start) >= 0xf0 ? 4 : byte(start) >= 0xe0 ? 3 : 2;
  std::uint32_t code = byte(start) & (0xffU >> (wanted + 1));
  std::size_t end = start + 1;
  for (std::size_t read = 1; read < wanted && end < text.size(); ++end) {
    if (text[end] == '\n') continue;
    code = (code << 6) | (byte(end) & 0x3f);
    ++read;
  }
  return {code, end - start};
}

// Replaces characters beyond ASCII, which occur only in strings, by STEP's hexadecimal form (ISO 10303-21,
// 6.4.3): \X2\....\X0\ or \X4\........\X0\.
std::string to_step_ascii(std::string_view text) {
  std::string ascii;
  ascii.reserve(text.size());
  const char* open_prefix = nullptr;  // prefix of the open escape sequence; null within ASCII
  const auto switch_to = [&](const char* wanted) {
    if (open_prefix == wanted) return;
    if (open_prefix != nullptr) ascii += "\\X0\\";
    if (wanted != nullptr) ascii += wanted;
    open_prefix = wanted;
  };
  for (std::size_t k = 0; k < text.size();) {
    if (static_cast<unsigned char>(text[k]) < 0x80) {
      switch_to(nullptr);
      ascii += text[k++];
      continue;
    }
    const Character character = character_at(text, k);
    const bool is_wide = character.code > 0xffff;
    switch_to(is_wide ? four_bytes : two_bytes);
    char digits[12];
    std::snprintf(digits, sizeof digits, is_wide ? "%08X" : "%04X", static_cast<unsigned>(character.code));
    ascii += digits;
    k += character.bytes;
  }
  switch_to(nullptr);
  return ascii;
}

// No note is added if closing a surface moves its points by at most this distance.
constexpr double smallest_move_m = 1e-9;

int face_count(const TopoDS_Shape& shape) {
  int count = 0;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) ++count;
  return count;
}

std::string describe_open_shell(const CadSurface& surface, const BodyShape& body) {
  if (surface.trims.empty()) {
    return "' closes, but OpenCASCADE cannot make a solid of it; an open shell is written";
  }
  const int faces = face_count(body.shape);
  return "' would close but is trimmed; the remaining part is written as an open shell" +
         (faces > 1 ? ", cut in " + std::to_string(faces) + " faces, which are imported as a body each"
                    : std::string());
}

// Counts a body. Adds a note if its surface was moved to close it, or if its surface closes although the body
// is not a solid.
void add_body_notes(const CadSurface& surface, const BodyShape& body, double moved_m,
                    CadFileContent& content) {
  ++(body.solid ? content.solids : content.open_shells);
  if (body.solid && moved_m > smallest_move_m) {
    content.notes.push_back("'" + surface.name + "' is open by " + short_length_text(moved_m) +
                            "; it is written closed");
  }
  if (body.solid || !surface.solid.empty()) return;
  if (find_closing(surface.surface).closedness != Closedness::solid) return;
  content.notes.push_back("'" + surface.name + describe_open_shell(surface, body));
}

// Collector of the bodies of a model in the order of its surfaces. A body from which OpenCASCADE cannot make
// a shape is left out with a note.
class BodyCollector {
 public:
  BodyCollector(const CadModel& model, CadFileContent& content) : model_(model), content_(content) {}

  void add(const CadSurface& surface) {
    if (surface.solid.empty()) {
      add_surface_body(surface);
    } else if (added_solids_.insert(surface.solid).second) {
      add_solid(surface.solid);
    }
  }

  // Fails if nothing can be written.
  Result<std::vector<WrittenBody>> release_bodies() {
    if (bodies_.empty() && failure_) return *failure_;
    std::vector<std::string> names;
    for (const WrittenBody& body : bodies_) names.push_back(body.name);
    names = make_names_unique(names, "body");
    for (std::size_t k = 0; k < names.size(); ++k) bodies_[k].name = std::move(names[k]);
    return std::move(bodies_);
  }

 private:
  void add_surface_body(const CadSurface& surface) {
    CadSurface closed = surface;
    auto [exact, moved_m] = close_exactly(surface.surface);
    closed.surface = std::move(exact);
    const auto body = build_body_shape(closed);
    if (!body) return leave_out(surface, body.error());
    add_body_notes(surface, body.value(), moved_m, content_);
    bodies_.push_back({surface.name, body->shape, body->solid, &surface});
  }

  void leave_out(const CadSurface& surface, const Error& error) {
    if (!failure_) failure_ = error.in("'" + surface.name + "'");
    const auto centre = [](const KnotVector& knots) {
      return 0.5 * (knots.domain_start() + knots.domain_end());
    };
    content_.notes.push_back(
        "'" + surface.name + "'" + (surface.solid.empty() ? "" : " of '" + surface.solid + "'") + " at " +
        position_text(position(surface.surface, centre(surface.surface.u), centre(surface.surface.v))) +
        " is not written: " + error.message + "; simplify or remove its trims");
  }

  void add_solid(const std::string& name) {
    std::vector<const CadSurface*> parts;
    for (const CadSurface& surface : model_.surfaces) {
      if (surface.solid == name) parts.push_back(&surface);
    }
    const auto joined = join_faces(parts);
    if (!joined) {
      content_.notes.push_back("'" + name + "' is not written as a solid: " + joined.error().message);
      for (const CadSurface* part : parts) add_surface_body(*part);
      return;
    }
    for (const JoinedSolid& solid : joined->solids) bodies_.push_back({name, solid.shape, true, nullptr});
    content_.solids += static_cast<int>(joined->solids.size());
    for (const std::size_t index : joined->loose) add_surface_body(*parts[index]);
    const auto notes = describe_joining(joined.value(), name, parts, "; they are written one by one");
    content_.notes.insert(content_.notes.end(), notes.begin(), notes.end());
  }

  const CadModel& model_;
  CadFileContent& content_;
  std::vector<WrittenBody> bodies_;
  std::optional<Error> failure_;  // of the first body that was left out
  std::set<std::string> added_solids_;
};

// Returns the bodies of a file in the order of the surfaces; a joined solid is at the position of its first
// face. Counts and notes are added to `content`.
Result<std::vector<WrittenBody>> collect_bodies(const CadModel& model, const Progress& progress,
                                                CadFileContent& content) {
  BodyCollector collector(model, content);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    collector.add(model.surfaces[k]);
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return collector.release_bodies();
}

// Makes OpenCASCADE write seventeen digits, which read back as the same number; its default is six decimals.
// SetFormat() also turns off the removal of trailing zeros, which would lose the exponent of such long
// numbers.
void set_digits(Interface_FloatWriter& writer) {
  writer.SetFormat("%.16E");
}

std::string to_text(const opencascade::handle<StepData_StepModel>& model) {
  StepData_StepWriter writer(model);
  set_digits(writer.FloatWriter());
  writer.SendModel(opencascade::handle<StepData_Protocol>::DownCast(model->Protocol()));
  std::ostringstream text;
  writer.Print(text);
  return std::move(text).str();
}

std::string to_text(const opencascade::handle<IGESData_IGESModel>& model) {
  IGESData_IGESWriter writer(model);
  set_digits(writer.FloatWriter());
  writer.SendModel(IGESSelect_WorkLibrary::DefineProtocol());
  std::ostringstream text;
  writer.Print(text);
  return std::move(text).str();
}

opencascade::handle<TCollection_HAsciiString> text(const char* characters) {
  return new TCollection_HAsciiString(characters);
}

const char* const program_name = "Spoonbill";

// Replaces the header entries that OpenCASCADE writes by default. In IGES these include the user's login
// name.
void fill_header(const opencascade::handle<StepData_StepModel>& model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetDescriptionValue(1, text("Spoonbill model"));
  header.SetName(text("Spoonbill model"));
  header.SetAuthorValue(1, text(""));
  header.SetOrganizationValue(1, text(""));
  header.SetOriginatingSystem(text(program_name));
}

void fill_header(const opencascade::handle<IGESData_IGESModel>& model) {
  IGESData_GlobalSection& header = model->ChangeGlobalSection();
  header.SetSendName(text("Spoonbill model"));
  header.SetReceiveName(text("Spoonbill model"));
  header.SetFileName(text(""));
  header.SetSystemId(text(program_name));
  header.SetInterfaceVersion(text(program_name));
  header.SetAuthorName(text(""));
  header.SetCompanyName(text(""));
}

// Fraction of the work for making the shapes; the rest is for writing the file.
constexpr double shape_fraction = 0.5;

Result<CadFileContent> write_step(const CadModel& model, const CadWriting& writing,
                                  const Progress& progress) {
  set_step_schema(writing.schema);
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  CadFileContent content;
  const auto bodies = collect_bodies(model, progress.part(0.0, shape_fraction), content);
  if (!bodies) return bodies.error();
  for (const WrittenBody& body : bodies.value()) {
    const TDF_Label label = shapes->AddShape(body.shape, false);
    TDataStd_Name::Set(label, TCollection_ExtendedString(body.name.c_str(), true));
  }
  STEPCAFControl_Writer writer;
  writer.SetColorMode(false);
  writer.SetLayerMode(false);
  if (!writer.Transfer(document)) {
    return Error{ErrorCode::unsupported, "OpenCASCADE cannot convert the model to a STEP file"};
  }
  const auto step = opencascade::handle<StepData_StepModel>::DownCast(writer.Writer().WS()->Model());
  if (step.IsNull())
    return Error{ErrorCode::unsupported, "OpenCASCADE cannot convert the model to a STEP file"};
  fill_header(step);
  content.text = to_step_ascii(to_text(step));
  return content;
}

void name_entity(const opencascade::handle<IGESData_IGESModel>& model,
                 const opencascade::handle<IGESData_IGESEntity>& entity, const std::string& name) {
  const opencascade::handle<TCollection_HAsciiString> whole = new TCollection_HAsciiString(name.c_str());
  const opencascade::handle<IGESBasic_Name> property = new IGESBasic_Name;
  property->Init(1, whole);
  entity->AddProperty(property);
  model->AddEntity(property);
}

// Gives a name to all entities of the given type, except the first `before` entities of the model.
void name_entities(const opencascade::handle<IGESData_IGESModel>& model, int before, int type,
                   const std::string& name) {
  for (int k = before + 1, count = model->NbEntities(); k <= count; ++k) {
    const opencascade::handle<IGESData_IGESEntity> entity = model->Entity(k);
    if (entity->TypeNumber() == type) name_entity(model, entity, name);
  }
}

// Extends the largest coordinates in the header to include a shape that IGESControl_Writer does not know.
void extend_extent(const TopoDS_Shape& shape, const opencascade::handle<IGESData_IGESModel>& model) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  IGESData_GlobalSection& header = model->ChangeGlobalSection();
  const double unit_mm = header.UnitValue();
  for (const gp_Pnt& corner : {box.CornerMin(), box.CornerMax()}) header.MaxMaxCoords(corner.XYZ() / unit_mm);
}

// Adds a solid as a finished entity: IGESControl_Writer converts either all shapes to solids or none.
bool add_solid(IGESControl_Writer& writer, const TopoDS_Shape& solid) {
  BRepToIGESBRep_Entity maker;
  maker.SetModel(writer.Model());
  const auto entity = maker.TransferShape(solid);
  extend_extent(solid, writer.Model());
  return !entity.IsNull() && writer.AddEntity(entity);
}

// Adds each face separately, because readers ignore names within a group.
bool add_faces(IGESControl_Writer& writer, const TopoDS_Shape& shape) {
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    if (!writer.AddShape(faces.Current())) return false;
  }
  return true;
}

bool add_surface(IGESControl_Writer& writer, const Surface& surface) {
  const auto geometry = to_occt(surface);
  return geometry && writer.AddGeom(geometry.value());
}

Status add_body(IGESControl_Writer& writer, const WrittenBody& body) {
  constexpr int solid = 186, untrimmed = 128, trimmed = 144;
  const int type = body.solid ? solid : body.surface->trims.empty() ? untrimmed : trimmed;
  const int before = writer.Model()->NbEntities();
  const bool added = type == solid       ? add_solid(writer, body.shape)
                     : type == untrimmed ? add_surface(writer, body.surface->surface)
                                         : add_faces(writer, body.shape);
  if (!added) {
    return Error{ErrorCode::unsupported,
                 "'" + body.name + "': OpenCASCADE cannot convert the body to an IGES entity"};
  }
  name_entities(writer.Model(), before, type, body.name);
  return {};
}

Result<CadFileContent> write_iges(const CadModel& model, const Progress& progress) {
  IGESControl_Writer writer;
  CadFileContent content;
  const auto bodies = collect_bodies(model, progress.part(0.0, shape_fraction), content);
  if (!bodies) return bodies.error();
  for (const WrittenBody& body : bodies.value()) {
    if (Status added = add_body(writer, body); !added) return added.error();
  }
  writer.ComputeModel();
  fill_header(writer.Model());
  content.text = to_text(writer.Model());
  return content;
}

}  // namespace

void prepare_occt() {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();
  STEPCAFControl_Controller::Init();
  IGESControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  Interface_Static::SetIVal("read.iges.bspline.continuity", 0);
}

void set_step_schema(StepSchema schema) {
  Interface_Static::SetCVal("write.step.schema", schema == StepSchema::ap242 ? "AP242DIS" : "AP214IS");
}

void set_file_unit(std::string_view unit) {
  const char* name = unit == "cm" ? "CM" : unit == "m" ? "M" : unit == "in" ? "INCH" : "MM";
  Interface_Static::SetCVal("write.step.unit", name);
  Interface_Static::SetCVal("write.iges.unit", name);
}

Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing, const Progress& progress) {
  set_file_unit(writing.unit);
  try {
    return writing.format == FileFormat::step ? write_step(model, writing, progress)
                                              : write_iges(model, progress);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported, std::string("OpenCASCADE failed to write the model (") +
                                             failure.DynamicType()->Name() + ")"};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::too_many, bad_allocation};
  }
}

}  // namespace spoonbill
