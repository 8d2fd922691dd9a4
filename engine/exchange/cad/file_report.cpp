#include "engine/exchange/cad/file_report.h"

#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_TransfEntity.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_DocumentFile.hxx>
#include <StepBasic_ExternalIdentificationAssignment.hxx>
#include <StepBasic_ExternalSource.hxx>
#include <StepBasic_SourceItem.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_GTrsf.hxx>
#include <gp_Mat.hxx>
#include <gp_XYZ.hxx>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/cad/iges_file.h"

namespace spoonbill {
namespace {

constexpr int millimetre_flag = 2;  // IGES 5.3, section 2.2.4.3.14

std::string unit_name(double millimetres) {
  static constexpr std::pair<double, const char*> units[] = {
      {1.0, "mm"},     {10.0, "cm"}, {1000.0, "m"}, {25.4, "inch"},
      {304.8, "foot"}, {1e-3, "um"}, {1e6, "km"},   {0.0254, "thousandth of an inch"}};
  for (const auto& [length, name] : units) {
    if (std::abs(millimetres - length) < 1e-6 * length) return name;
  }
  return number_text(millimetres) + " mm";
}

opencascade::handle<StepRepr_GlobalUnitAssignedContext> get_unit_context(
    const opencascade::handle<Standard_Transient>& entity) {
  using Plain = StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext;
  using Uncertain = StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx;
  if (const auto plain = opencascade::handle<Plain>::DownCast(entity)) {
    return plain->GlobalUnitAssignedContext();
  }
  if (const auto uncertain = opencascade::handle<Uncertain>::DownCast(entity)) {
    return uncertain->GlobalUnitAssignedContext();
  }
  return opencascade::handle<StepRepr_GlobalUnitAssignedContext>::DownCast(entity);
}

// Returns true if the context lists units and none of them is null. Units of a damaged file can be null.
bool has_all_units(const opencascade::handle<StepRepr_GlobalUnitAssignedContext>& context) {
  if (context.IsNull() || context->Units().IsNull()) return false;
  for (int k = 1; k <= context->NbUnits(); ++k) {
    if (context->UnitsValue(k).IsNull()) return false;
  }
  return true;
}

using Entity = opencascade::handle<Standard_Transient>;

// IGES entity types of faces: bounded surface, trimmed surface, face of a solid (IGES 5.3, section 4).
constexpr std::array iges_faces{143, 144, 510};
// IGES entity types of surfaces. A surface is a face unless another entity uses it.
constexpr std::array iges_surfaces{108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198};
// IGES entity types of collections, which do not change their members: subfigure, group, subfigure instance.
constexpr std::array iges_collections{308, 402, 408};
constexpr int iges_instance = 408, physically_dependent = 1, dependent_both_ways = 3;

template <std::size_t count>
bool contains(int type, const std::array<int, count>& types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// Returns true if another entity, other than a collection, uses this entity. Some systems do not mark a used
// entity as dependent.
bool is_used_by_another(const Entity& entity, const Interface_Graph& graph) {
  for (Interface_EntityIterator users = graph.Sharings(entity); users.More(); users.Next()) {
    const auto user = opencascade::handle<IGESData_IGESEntity>::DownCast(users.Value());
    if (!user.IsNull() && !contains(user->TypeNumber(), iges_collections)) return true;
  }
  return false;
}

bool is_independent(const IGESData_IGESEntity& entity) {
  return entity.SubordinateStatus() != physically_dependent &&
         entity.SubordinateStatus() != dependent_both_ways;
}

// Returns true for curves, surfaces, solids, groups and parts; false for annotations.
bool is_geometric(int type) {
  return (type >= 100 && type < 200) || (type >= 500 && type < 600) || type == 308 || type == 402 ||
         type == iges_instance;
}

bool is_face(const Entity& entity, const Interface_Graph& graph, FileFormat format) {
  if (format == FileFormat::step) {
    return !opencascade::handle<StepShape_FaceSurface>::DownCast(entity).IsNull();
  }
  const auto iges = opencascade::handle<IGESData_IGESEntity>::DownCast(entity);
  if (iges.IsNull()) return false;
  return contains(iges->TypeNumber(), iges_faces) ||
         (contains(iges->TypeNumber(), iges_surfaces) && is_independent(*iges) &&
          !is_used_by_another(entity, graph));
}

void count_iges(const Entity& entity, bool is_made, bool damaged, LossCount& count) {
  const auto iges = opencascade::handle<IGESData_IGESEntity>::DownCast(entity);
  if (iges.IsNull()) return;
  const int type = iges->TypeNumber();
  if (type == 0 || (damaged && is_geometric(type))) ++count.unread;
  if (type != iges_instance || !is_independent(*iges)) return;
  ++count.instances;
  if (!is_made) ++count.lost_instances;
}

using Operator = StepGeom_CartesianTransformationOperator3d;
using UnitDirection = opencascade::handle<StepGeom_Direction>;

// Relative tolerance for numbers that a file has rounded.
constexpr double rounding = 1e-4;

gp_XYZ to_vector(const UnitDirection& direction, const gp_XYZ& fallback) {
  if (direction.IsNull() || direction->NbDirectionRatios() < 3) return fallback;
  return {direction->DirectionRatiosValue(1), direction->DirectionRatiosValue(2),
          direction->DirectionRatiosValue(3)};
}

// Returns true if the placement mirrors. It does not if an axis is missing: the missing axis then follows
// from the other axes, the third as their cross product (ISO 10303-42, 4.4.16).
bool mirrors(const Operator& placement) {
  if (placement.Axis1().IsNull() || placement.Axis2().IsNull() || placement.Axis3().IsNull()) return false;
  const gp_XYZ first = to_vector(placement.Axis1(), {1, 0, 0}),
               second = to_vector(placement.Axis2(), {0, 1, 0});
  return first.Crossed(second).Dot(to_vector(placement.Axis3(), {0, 0, 1})) < 0.0;
}

bool keeps_angles(const gp_Mat& matrix) {
  double shortest = matrix.Column(1).Modulus(), longest = shortest;
  for (int k = 2; k <= 3; ++k) {
    shortest = std::min(shortest, matrix.Column(k).Modulus());
    longest = std::max(longest, matrix.Column(k).Modulus());
  }
  if (longest - shortest > rounding * longest) return false;
  for (int k = 1; k <= 3; ++k) {
    const double cosine = matrix.Column(k).Dot(matrix.Column(k % 3 + 1)) / (longest * longest);
    if (!(std::abs(cosine) <= rounding)) return false;
  }
  return true;
}

}  // namespace

FileUnit find_unit(const opencascade::handle<StepData_StepModel>& model) {
  if (model.IsNull()) return {"mm", 1.0, false};
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto units = get_unit_context(model->Value(k));
    if (!has_all_units(units)) continue;
    STEPConstruct_UnitContext context;
    context.ComputeFactors(units);
    if (context.LengthDone()) return {unit_name(context.LengthFactor()), context.LengthFactor(), true};
  }
  return {"mm", 1.0, false};
}

FileUnit find_unit(const opencascade::handle<IGESData_IGESModel>& model, const std::filesystem::path& file) {
  if (model.IsNull()) return {"mm", 1.0, false};
  double millimetres = model->GlobalSection().UnitValue();
  if (!(millimetres > 0.0)) {
    IGESData_GlobalSection section = model->GlobalSection();
    section.SetUnitFlag(millimetre_flag);
    model->SetGlobalSection(section);
    millimetres = 1.0;
  }
  return {unit_name(millimetres), millimetres, declares_iges_unit(file)};
}

LossCount count_losses(const opencascade::handle<XSControl_WorkSession>& session, FileFormat format) {
  LossCount count;
  if (session.IsNull()) return count;
  const auto model = session->Model();
  const auto transfers = session->MapReader();
  if (model.IsNull() || transfers.IsNull()) return count;
  const Interface_Graph& graph = session->Graph();
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const Entity entity = model->Value(k);
    if (entity.IsNull()) continue;
    const auto binder = transfers->Find(entity);
    const bool is_made = !binder.IsNull() && !TransferBRep::ShapeResult(binder).IsNull();
    if (is_face(entity, graph, format)) {
      ++count.faces;
      if (!is_made) ++count.lost_faces;
    } else if (format == FileFormat::iges) {
      count_iges(entity, is_made, model->IsErrorEntity(k) || model->IsRedefinedContent(k), count);
    }
  }
  return count;
}

int count_unread_placements(const opencascade::handle<StepData_StepModel>& model) {
  int count = 0;
  if (model.IsNull()) return count;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto placement = opencascade::handle<Operator>::DownCast(model->Value(k));
    if (placement.IsNull()) continue;
    const bool scales = placement->HasScale() && !(std::abs(placement->Scale() - 1.0) <= rounding);
    if (scales || mirrors(*placement)) ++count;
  }
  return count;
}

int count_unread_placements(const opencascade::handle<IGESData_IGESModel>& model) {
  int count = 0;
  if (model.IsNull()) return count;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto entity = model->Entity(k);
    if (entity.IsNull() || !entity->HasTransf()) continue;
    // The matrix is null if a damaged file names another entity in its place.
    const auto transformation = entity->Transf();
    if (transformation.IsNull() || !keeps_angles(transformation->Value().VectorialPart())) ++count;
  }
  return count;
}

int remove_external_files(const opencascade::handle<StepData_StepModel>& model) {
  if (model.IsNull()) return 0;
  const opencascade::handle<TCollection_HAsciiString> empty = new TCollection_HAsciiString("");
  int files = 0;
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto entity = model->Value(k);
    if (const auto file = opencascade::handle<StepBasic_DocumentFile>::DownCast(entity)) {
      file->SetId(empty);
      ++files;
    }
    using Assignment = StepBasic_ExternalIdentificationAssignment;
    if (const auto assignment = opencascade::handle<Assignment>::DownCast(entity)) {
      assignment->SetAssignedId(empty);
    }
    if (const auto source = opencascade::handle<StepBasic_ExternalSource>::DownCast(entity)) {
      source->SetSourceId(StepBasic_SourceItem());
    }
  }
  return files;
}

}  // namespace spoonbill
