#include "engine/exchange/cad/cad_reader.h"

#include <IGESCAFControl_Reader.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFApp_Application.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/base/geometry.h"
#include "engine/exchange/cad/external_files.h"
#include "engine/exchange/cad/face_surface.h"
#include "engine/exchange/cad/file_unit.h"
#include "engine/exchange/cad/iges_globals.h"
#include "engine/exchange/cad/iges_lines.h"
#include "engine/exchange/cad/lost_faces.h"
#include "engine/exchange/cad/named_faces.h"
#include "engine/exchange/cad/placements.h"

namespace spoonbill {
namespace {

constexpr double share_of_parsing = 0.3, share_of_transfer = 0.5;

using OcctDocument = opencascade::handle<TDocStd_Document>;

struct Content {
  OcctDocument document;
  FileUnit unit;
  LossCount losses = {};
  int external_files = 0;
  int unread_placements = 0;
  double model_scale = 1.0;  // of IGES
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
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return Error{"is no STEP file, or a damaged one"};
  if (!progress.report(share_of_parsing)) return Progress::stopped();
  Content content{new_document(), unit_of(reader.Reader().StepModel())};
  content.external_files = forget_external_files(reader.Reader().StepModel());
  if (!reader.Transfer(content.document)) return Error{"holds no shape"};
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
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return Error{"is no IGES file, or a damaged one"};
  if (!progress.report(share_of_parsing)) return Progress::stopped();
  Content content{new_document(), unit_of(reader.IGESModel(), file)};
  if (!reader.Transfer(content.document)) return Error{"holds no shape"};
  content.losses = count_losses(reader.WS(), FileFormat::iges);
  content.losses.unread -= std::min(content.losses.unread, null_entities.value());
  content.unread_placements = count_unread_placements(reader.IGESModel());
  content.model_scale = iges_model_scale(file);
  return content;
}

void say_unit(const FileUnit& unit, const CadReading& reading, CadModel& model) {
  model.unit = unit.name;
  model.unit_declared = unit.declared;
  if (!unit.declared && reading.unit_m == 0.0) {
    model.unit = "mm";
    model.notes.push_back(
        "the file declares no unit of length that is known; millimetres are taken (--unit names another)");
  }
}

Error no_surface(const Content& content) {
  if (content.losses.faces > 0) {
    return Error{"has " + std::to_string(content.losses.faces) +
                 " faces, none of which can be read; export it anew"};
  }
  if (content.external_files > 0) return Error{"holds no surface but names other files; export all as one"};
  return Error{"holds no surface"};
}

void say_losses(const Content& content, CadModel& model) {
  const LossCount& losses = content.losses;
  const auto say = [&](int lost, int all, const char* what) {
    if (lost == 0) return;
    model.notes.push_back(std::to_string(lost) + " of the file's " + std::to_string(all) + " " + what +
                          " cannot be read and are missing; repair them in the CAD system");
  };
  say(losses.lost_faces, losses.faces, "faces");
  say(losses.lost_instances, losses.instances, "placed parts");
  if (losses.unread > 0) {
    model.notes.push_back("damaged entities of the file: " + std::to_string(losses.unread) +
                          "; what they belong to is missing or wrong; export it anew");
  }
  if (content.unread_placements > 0) {
    model.notes.push_back(
        "placements that scale, stretch or mirror: " + std::to_string(content.unread_placements) +
        ", which are not read; what they place has its own size and shape; export it "
        "without them");
  }
  if (content.model_scale != 1.0) {
    model.notes.push_back("the file calls itself a model of scale " + number_text(content.model_scale) +
                          ", which is not applied: sizes are those of the model (--unit changes them)");
  }
  if (content.external_files > 0) {
    model.notes.push_back("the file names " + std::to_string(content.external_files) +
                          " others, which are not opened: their parts are missing; export all as one file");
  }
}

// A body of ours is one surface.
void say_solids(const NamedFaces& named, CadModel& model) {
  if (named.solids == 0) return;
  const std::string faces = std::to_string(named.faces_of_solids);
  model.notes.push_back("the " + faces + " faces of " +
                        (named.solids == 1 ? "a solid" : std::to_string(named.solids) + " solids") +
                        " come in as a body each; they leave joined where they still close");
}

// Metres for each of what OpenCASCADE made of the file's numbers, which are millimetres if the unit is right.
double scale_of(const FileUnit& unit, const CadReading& reading) {
  if (reading.unit_m > 0.0) return reading.unit_m / unit.millimetres;
  return unit.declared ? 1e-3 : 1e-3 / unit.millimetres;
}

CadSurface surface_of(const NamedFace& face, FaceSurface found) {
  CadSurface surface;
  surface.name = face.name;
  surface.surface = std::move(found.surface);
  surface.deviation_m = found.deviation_m;
  surface.trims = std::move(found.trims);
  surface.trim_problem = std::move(found.trim_problem);
  surface.solid = face.solid;
  return surface;
}

// A document would not take it.
bool is_far_away(const ControlNet& net) {
  for (const auto* coordinates : {&net.x, &net.y, &net.z}) {
    for (const double coordinate : *coordinates) {
      if (!position_range_m.contains(coordinate)) return true;
    }
  }
  return false;
}

Result<FaceSurface> near_surface(const TopoDS_Face& face, double scale, double tolerance_m) {
  auto found = face_surface(face, scale, tolerance_m);
  if (found && is_far_away(found->surface.net)) {
    return Error{"lies more than " + number_text(position_range_m.high) +
                 " m from the origin; move it nearer in the CAD system, or check the unit"};
  }
  return found;
}

// Those that are no surfaces of ours are told in notes. Refused: when all are.
Status take_faces(const std::vector<NamedFace>& faces, double scale, const CadReading& reading,
                  const TakeSurface& take, const Progress& progress, CadModel& model) {
  std::optional<Error> first;
  std::size_t taken = 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    auto found = near_surface(faces[k].face, scale, reading.tolerance_m);
    if (found) {
      take(surface_of(faces[k], std::move(found).value()));
      ++taken;
    } else {
      if (!first) first = Error{"'" + faces[k].name + "': " + found.error().message};
      model.notes.push_back("'" + faces[k].name + "' is left out: " + found.error().message);
    }
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(faces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return taken > 0 ? Status() : *first;
}

Result<CadModel> read(const std::filesystem::path& file, const CadReading& reading, const TakeSurface& take,
                      const Progress& progress) {
  const auto content =
      reading.format == FileFormat::step ? read_step(file, progress) : read_iges(file, progress);
  if (!content) return content.error();
  if (!progress.report(share_of_transfer)) return Progress::stopped();
  const NamedFaces named = named_faces(content->document);
  const std::vector<NamedFace>& faces = named.faces;
  if (faces.empty()) return no_surface(content.value());
  if (faces.size() > reading.face_limit) {
    return Error{"has " + std::to_string(faces.size()) + " faces, more than the " +
                 std::to_string(reading.face_limit) + " that are read; export fewer"};
  }
  CadModel model;
  say_unit(content->unit, reading, model);
  say_losses(content.value(), model);
  say_solids(named, model);
  const Status taken = take_faces(faces, scale_of(content->unit, reading), reading, take,
                                  progress.part(share_of_transfer, 1.0), model);
  if (!taken) return taken.error();
  return model;
}

}  // namespace

Result<CadModel> read_cad(const std::filesystem::path& file, const CadReading& reading,
                          const TakeSurface& take, const Progress& progress) {
  SPOONBILL_ASSERT(static_cast<bool>(take));
  try {
    return read(file, reading, take, progress);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")"};
  } catch (const std::bad_alloc&) {
    return Error{"bad allocation"};
  } catch (const std::exception& exception) {
    return Error{std::string("OpenCASCADE fails on it (") + exception.what() + ")"};
  }
}

}  // namespace spoonbill
