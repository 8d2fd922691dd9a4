#include "engine/exchange/cad/lost_faces.h"

#include <IGESData_IGESEntity.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
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
// Surfaces, which are faces by themselves unless another entity has them for its own.
constexpr std::array iges_surfaces{108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198};
// What shows an entity where it stands: a part and its places, a group.
constexpr std::array iges_collections{308, 402, 408};
constexpr int iges_instance = 408, physically_dependent = 1, dependent_both_ways = 3;

template <std::size_t count>
bool is_among(int type, const std::array<int, count>& types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// Some systems do not mark a surface that is a trimmed one's.
bool is_used_by_another(const Entity& entity, const Interface_Graph& graph) {
  for (Interface_EntityIterator users = graph.Sharings(entity); users.More(); users.Next()) {
    const auto user = opencascade::handle<IGESData_IGESEntity>::DownCast(users.Value());
    if (!user.IsNull() && !is_among(user->TypeNumber(), iges_collections)) return true;
  }
  return false;
}

bool stands_alone(const IGESData_IGESEntity& entity) {
  return entity.SubordinateStatus() != physically_dependent &&
         entity.SubordinateStatus() != dependent_both_ways;
}

// Curves, surfaces, solids, groups and parts; not what is drawn beside them.
bool shapes_something(int type) {
  return (type >= 100 && type < 200) || (type >= 500 && type < 600) || type == 308 || type == 402 ||
         type == iges_instance;
}

bool is_face(const Entity& entity, const Interface_Graph& graph, FileFormat format) {
  if (format == FileFormat::step) {
    return !opencascade::handle<StepShape_FaceSurface>::DownCast(entity).IsNull();
  }
  const auto iges = opencascade::handle<IGESData_IGESEntity>::DownCast(entity);
  if (iges.IsNull()) return false;
  return is_among(iges->TypeNumber(), iges_faces) ||
         (is_among(iges->TypeNumber(), iges_surfaces) && stands_alone(*iges) &&
          !is_used_by_another(entity, graph));
}

void count_iges(const Entity& entity, bool made, bool damaged, LossCount& count) {
  const auto iges = opencascade::handle<IGESData_IGESEntity>::DownCast(entity);
  if (iges.IsNull()) return;
  const int type = iges->TypeNumber();
  if (type == 0 || (damaged && shapes_something(type))) ++count.unread;
  if (type != iges_instance || !stands_alone(*iges)) return;
  ++count.instances;
  if (!made) ++count.lost_instances;
}

}  // namespace

LossCount count_losses(const opencascade::handle<XSControl_WorkSession>& session, FileFormat format) {
  const auto model = session->Model();
  const auto made_of = session->MapReader();
  const Interface_Graph& graph = session->Graph();
  LossCount count;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const Entity entity = model->Value(k);
    const auto binder = made_of->Find(entity);
    const bool made = !binder.IsNull() && !TransferBRep::ShapeResult(binder).IsNull();
    if (is_face(entity, graph, format)) {
      ++count.faces;
      if (!made) ++count.lost_faces;
    } else if (format == FileFormat::iges) {
      count_iges(entity, made, model->IsErrorEntity(k) || model->IsRedefinedContent(k), count);
    }
  }
  return count;
}

}  // namespace spoonbill
