#include "engine/exchange/cad/lost_faces.h"

#include <IGESData_IGESEntity.hxx>
#include <Interface_InterfaceModel.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <algorithm>
#include <array>

namespace spoonbill {
namespace {

using Entity = opencascade::handle<Standard_Transient>;

// A bounded surface, a trimmed one, a face of a solid (IGES 5.3, section 4).
constexpr std::array iges_faces{143, 144, 510};

bool is_face(const Entity& entity, CadFormat format) {
  if (format == CadFormat::step) {
    return !opencascade::handle<StepShape_FaceSurface>::DownCast(entity).IsNull();
  }
  const auto iges = opencascade::handle<IGESData_IGESEntity>::DownCast(entity);
  return !iges.IsNull() &&
         std::find(iges_faces.begin(), iges_faces.end(), iges->TypeNumber()) != iges_faces.end();
}

}  // namespace

FaceCount count_faces(const opencascade::handle<XSControl_WorkSession>& session, CadFormat format) {
  const auto model = session->Model();
  const auto made = session->MapReader();
  FaceCount count;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const Entity entity = model->Value(k);
    if (!is_face(entity, format)) continue;
    ++count.all;
    const auto binder = made->Find(entity);
    if (binder.IsNull() || TransferBRep::ShapeResult(binder).IsNull()) ++count.lost;
  }
  return count;
}

}  // namespace spoonbill
