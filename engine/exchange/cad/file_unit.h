// The unit of length that a CAD file declares.
#pragma once

#include <IGESData_IGESModel.hxx>
#include <StepData_StepModel.hxx>
#include <filesystem>
#include <string>

namespace spoonbill {

struct FileUnit {
  std::string name;          // "mm", "inch", or as the file has it
  double millimetres = 1.0;  // that OpenCASCADE took for one of them
  bool declared = false;
};

FileUnit unit_of(const opencascade::handle<StepData_StepModel>& model);
// A unit that is none is millimetres in the model from then on: OpenCASCADE would make nothing of it.
FileUnit unit_of(const opencascade::handle<IGESData_IGESModel>& model, const std::filesystem::path& file);

}  // namespace spoonbill
