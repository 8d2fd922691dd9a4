#include "engine/exchange/cad/cad_writer.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <IGESBasic_Name.hxx>
#include <IGESControl_Writer.hxx>
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

#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/session.h"
#include "engine/exchange/cad/step_text.h"

namespace spoonbill {
namespace {

Error about(const CadSurface& surface, const Error& error) {
  return Error{"'" + surface.name + "': " + error.message};
}

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

void fill_header(const opencascade::handle<StepData_StepModel>& model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(new TCollection_HAsciiString("Spoonbill model"));
  header.SetOriginatingSystem(new TCollection_HAsciiString("Spoonbill"));
}

Result<CadFileContent> write_step(const CadModel& model, const CadWriting& writing,
                                  const CadProgress& progress) {
  choose_schema(writing.schema);
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  CadFileContent content;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    const CadSurface& surface = model.surfaces[k];
    const auto body = body_shape(surface);
    if (!body) return about(surface, body.error());
    ++(body->solid ? content.solids : content.open_shells);
    const TDF_Label label = shapes->AddShape(body->shape, false);
    TDataStd_Name::Set(label, TCollection_ExtendedString(surface.name.c_str(), true));
    if (progress) progress(0.5 * static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size()));
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

// The entities that stand for a surface are among those after `before`: of type 144 if it is trimmed.
void name_entities(const opencascade::handle<IGESData_IGESModel>& model, int before,
                   const CadSurface& surface) {
  constexpr int untrimmed = 128, trimmed = 144;
  const int wanted = surface.trims.empty() ? untrimmed : trimmed;
  for (int k = before + 1, count = model->NbEntities(); k <= count; ++k) {
    const opencascade::handle<IGESData_IGESEntity> entity = model->Entity(k);
    if (entity->TypeNumber() == wanted) name_entity(model, entity, surface.name);
  }
}

Status add_to(IGESControl_Writer& writer, const CadSurface& surface) {
  const int before = writer.Model()->NbEntities();
  bool added = false;
  if (surface.trims.empty()) {
    const auto geometry = to_occt(surface.surface);
    if (!geometry) return geometry.error();
    added = writer.AddGeom(geometry.value());
  } else {
    const auto body = body_shape(surface);
    if (!body) return body.error();
    // Each by itself: a name within a group is not read.
    for (TopExp_Explorer faces(body->shape, TopAbs_FACE); faces.More(); faces.Next()) {
      added = writer.AddShape(faces.Current());
      if (!added) break;
    }
  }
  if (!added) return Error{"OpenCASCADE makes no IGES entity of it"};
  name_entities(writer.Model(), before, surface);
  return {};
}

Result<CadFileContent> write_iges(const CadModel& model, const CadProgress& progress) {
  IGESControl_Writer writer;
  CadFileContent content;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (Status added = add_to(writer, model.surfaces[k]); !added) {
      return about(model.surfaces[k], added.error());
    }
    ++content.open_shells;
    if (progress) progress(0.5 * static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size()));
  }
  writer.ComputeModel();
  content.text = text_of(writer.Model());
  return content;
}

}  // namespace

Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing,
                                 const CadProgress& progress) {
  choose_unit(writing.unit);
  try {
    return writing.format == CadFormat::step ? write_step(model, writing, progress)
                                             : write_iges(model, progress);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")"};
  } catch (const std::bad_alloc&) {
    return Error{"bad allocation"};
  }
}

}  // namespace spoonbill
