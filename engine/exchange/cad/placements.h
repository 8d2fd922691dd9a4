// Placements that do more than move and turn, which OpenCASCADE passes over.
#pragma once

#include <IGESData_IGESModel.hxx>
#include <StepData_StepModel.hxx>

namespace spoonbill {

// How many scale or mirror.
int count_unread_placements(const opencascade::handle<StepData_StepModel>& model);
// How many entities are placed by a matrix that changes angles; what keeps them is read.
int count_unread_placements(const opencascade::handle<IGESData_IGESModel>& model);

}  // namespace spoonbill
