#include "engine/exchange/cad/external_files.h"

#include <StepBasic_DocumentFile.hxx>
#include <StepBasic_ExternalIdentificationAssignment.hxx>
#include <StepBasic_ExternalSource.hxx>
#include <StepBasic_SourceItem.hxx>
#include <TCollection_HAsciiString.hxx>

namespace spoonbill {

int forget_external_files(const opencascade::handle<StepData_StepModel>& model) {
  const opencascade::handle<TCollection_HAsciiString> nothing = new TCollection_HAsciiString("");
  int files = 0;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto entity = model->Value(k);
    if (const auto file = opencascade::handle<StepBasic_DocumentFile>::DownCast(entity)) {
      file->SetId(nothing);
      ++files;
    }
    using Assignment = StepBasic_ExternalIdentificationAssignment;
    if (const auto assignment = opencascade::handle<Assignment>::DownCast(entity)) {
      assignment->SetAssignedId(nothing);
    }
    if (const auto source = opencascade::handle<StepBasic_ExternalSource>::DownCast(entity)) {
      source->SetSourceId(StepBasic_SourceItem());
    }
  }
  return files;
}

}  // namespace spoonbill
