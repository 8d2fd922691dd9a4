// Facts about a CAD file that OpenCASCADE does not report: its unit, lost entities, ignored placements,
// references to other files.
#pragma once

#include <IGESData_IGESModel.hxx>
#include <StepData_StepModel.hxx>
#include <XSControl_WorkSession.hxx>
#include <filesystem>
#include <string>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Unit of length of a file.
struct FileUnit {
  // Name of the unit, such as "mm" or "inch". A unit without a known name is given as a length, such as "3
  // mm".
  std::string name;
  double millimetres = 1.0;  // length in millimetres that OpenCASCADE assumed for one unit
  bool declared = false;
};

FileUnit find_unit(const opencascade::handle<StepData_StepModel>& model);
// Returns the unit of an IGES file. Also sets an invalid unit of the model to millimetres, because
// OpenCASCADE would otherwise convert nothing.
FileUnit find_unit(const opencascade::handle<IGESData_IGESModel>& model, const std::filesystem::path& file);

// Numbers of entities in a file, and of those that OpenCASCADE omits although it reports success.
struct LossCount {
  int faces = 0, lost_faces = 0;          // faces of the file, and faces that did not become a shape
  int instances = 0, lost_instances = 0;  // placed copies of parts of an IGES file, and those lost
  int unread = 0;                         // IGES entities that could not be parsed or have no type
};

// Counts the entities that OpenCASCADE has omitted. Call after OpenCASCADE has converted the entities to
// shapes.
LossCount count_losses(const opencascade::handle<XSControl_WorkSession>& session, FileFormat format);

// Returns the number of placements that OpenCASCADE ignores because they do more than translate and rotate.
// In STEP these are placements that scale or mirror, in IGES placements that change angles.
int count_unread_placements(const opencascade::handle<StepData_StepModel>& model);
int count_unread_placements(const opencascade::handle<IGESData_IGESModel>& model);

// Removes the names of other files from the model and returns their number. OpenCASCADE would open such a
// file even if it were a pipe or a device.
int remove_external_files(const opencascade::handle<StepData_StepModel>& model);

}  // namespace spoonbill
