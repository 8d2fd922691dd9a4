#include "engine/exchange/cad/cad_writer.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBndLib.hxx>
#include <BRepToIGESBRep_Entity.hxx>
#include <Bnd_Box.hxx>
#include <IGESBasic_Name.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESData_Protocol.hxx>
#include <IGESSelect_WorkLibrary.hxx>
#include <Interface_FloatWriter.hxx>
#include <STEPCAFControl_Writer.hxx>
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
#include <new>
#include <sstream>
#include <utility>

#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/session.h"
#include "engine/exchange/cad/step_text.h"
#include "engine/exchange/cad/written_bodies.h"

namespace spoonbill {
namespace {

// Seventeen digits, which read back as the same number; OpenCASCADE's own choice is six decimals. Leaving out
// trailing zeros would lose the exponent of a number as long.
void set_digits(Interface_FloatWriter& writer) {
  writer.SetFormat("%.16E");
}

std::string text_of(const opencascade::handle<StepData_StepModel>& model) {
  StepData_StepWriter writer(model);
  set_digits(writer.FloatWriter());
  writer.SendModel(opencascade::handle<StepData_Protocol>::DownCast(model->Protocol()));
  std::ostringstream text;
  writer.Print(text);
  return std::move(text).str();
}

std::string text_of(const opencascade::handle<IGESData_IGESModel>& model) {
  IGESData_IGESWriter writer(model);
  set_digits(writer.FloatWriter());
  writer.SendModel(IGESSelect_WorkLibrary::DefineProtocol());
  std::ostringstream text;
  writer.Print(text);
  return std::move(text).str();
}

opencascade::handle<TCollection_HAsciiString> text(const char* letters) {
  return new TCollection_HAsciiString(letters);
}

const char* const program_name = "Spoonbill";

// OpenCASCADE fills in itself, and in IGES files the name that the person is logged in by.
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

// Of the work; putting the file together takes the rest.
constexpr double share_of_shapes = 0.5;

Result<CadFileContent> write_step(const CadModel& model, const CadWriting& writing,
                                  const Progress& progress) {
  choose_schema(writing.schema);
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  CadFileContent content;
  const auto bodies = written_bodies(model, progress.part(0.0, share_of_shapes), content);
  if (!bodies) return bodies.error();
  for (const WrittenBody& body : bodies.value()) {
    const TDF_Label label = shapes->AddShape(body.shape, false);
    TDataStd_Name::Set(label, TCollection_ExtendedString(body.name.c_str(), true));
  }
  STEPCAFControl_Writer writer;
  writer.SetColorMode(false);
  writer.SetLayerMode(false);
  if (!writer.Transfer(document)) return Error{"OpenCASCADE makes no STEP file of it"};
  const auto step = opencascade::handle<StepData_StepModel>::DownCast(writer.Writer().WS()->Model());
  fill_header(step);
  content.text = step_text_in_ascii(text_of(step));
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

// The entities that stand for a surface are among those after `before`, of this type.
void name_entities(const opencascade::handle<IGESData_IGESModel>& model, int before, int type,
                   const std::string& name) {
  for (int k = before + 1, count = model->NbEntities(); k <= count; ++k) {
    const opencascade::handle<IGESData_IGESEntity> entity = model->Entity(k);
    if (entity->TypeNumber() == type) name_entity(model, entity, name);
  }
}

// Other than its own shapes the writer does not count those in.
void count_in_extent(const TopoDS_Shape& shape, const opencascade::handle<IGESData_IGESModel>& model) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  IGESData_GlobalSection& header = model->ChangeGlobalSection();
  const double unit_mm = header.UnitValue();
  for (const gp_Pnt& corner : {box.CornerMin(), box.CornerMax()}) header.MaxMaxCoords(corner.XYZ() / unit_mm);
}

// IGESControl_Writer makes all of a file solids, or none.
bool add_solid(IGESControl_Writer& writer, const TopoDS_Shape& solid) {
  BRepToIGESBRep_Entity maker;
  maker.SetModel(writer.Model());
  const auto entity = maker.TransferShape(solid);
  count_in_extent(solid, writer.Model());
  return !entity.IsNull() && writer.AddEntity(entity);
}

// Each by itself: a name within a group is not read.
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

Status add_to(IGESControl_Writer& writer, const WrittenBody& body) {
  constexpr int solid = 186, untrimmed = 128, trimmed = 144;
  const int type = body.solid ? solid : body.surface->trims.empty() ? untrimmed : trimmed;
  const int before = writer.Model()->NbEntities();
  const bool added = type == solid       ? add_solid(writer, body.shape)
                     : type == untrimmed ? add_surface(writer, body.surface->surface)
                                         : add_faces(writer, body.shape);
  if (!added) return Error{"'" + body.name + "': OpenCASCADE makes no IGES entity of it"};
  name_entities(writer.Model(), before, type, body.name);
  return {};
}

Result<CadFileContent> write_iges(const CadModel& model, const Progress& progress) {
  IGESControl_Writer writer;
  CadFileContent content;
  const auto bodies = written_bodies(model, progress.part(0.0, share_of_shapes), content);
  if (!bodies) return bodies.error();
  for (const WrittenBody& body : bodies.value()) {
    if (Status added = add_to(writer, body); !added) return added.error();
  }
  writer.ComputeModel();
  fill_header(writer.Model());
  content.text = text_of(writer.Model());
  return content;
}

}  // namespace

Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing, const Progress& progress) {
  choose_unit(writing.unit);
  try {
    return writing.format == FileFormat::step ? write_step(model, writing, progress)
                                              : write_iges(model, progress);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")"};
  } catch (const std::bad_alloc&) {
    return Error{"bad allocation"};
  }
}

}  // namespace spoonbill
