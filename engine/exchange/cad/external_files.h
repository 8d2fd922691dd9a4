// Other files that a STEP file names as the places of its parts.
#pragma once

#include <StepData_StepModel.hxx>

namespace spoonbill {

// How many of its documents are such files. It names none afterwards: OpenCASCADE would open whatever path
// stands there, a pipe or device among them.
int forget_external_files(const opencascade::handle<StepData_StepModel>& model);

}  // namespace spoonbill
