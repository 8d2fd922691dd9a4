#include "engine/exchange/cad/file_unit.h"

#include <IGESData_GlobalSection.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <cmath>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/cad/iges_globals.h"

namespace spoonbill {
namespace {

constexpr int flag_of_millimetres = 2;  // IGES 5.3, section 2.2.4.3.14

std::string name_of(double millimetres) {
  static constexpr std::pair<double, const char*> known[] = {
      {1.0, "mm"},     {10.0, "cm"}, {1000.0, "m"}, {25.4, "inch"},
      {304.8, "foot"}, {1e-3, "um"}, {1e6, "km"},   {0.0254, "thousandth of an inch"}};
  for (const auto& [length, name] : known) {
    if (std::abs(millimetres - length) < 1e-6 * length) return name;
  }
  return number_text(millimetres) + " mm";
}

opencascade::handle<StepRepr_GlobalUnitAssignedContext> units_in(
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

}  // namespace

FileUnit unit_of(const opencascade::handle<StepData_StepModel>& model) {
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto units = units_in(model->Value(k));
    if (units.IsNull() || units->Units().IsNull()) continue;
    STEPConstruct_UnitContext context;
    context.ComputeFactors(units);
    if (context.LengthDone()) return {name_of(context.LengthFactor()), context.LengthFactor(), true};
  }
  return {"mm", 1.0, false};
}

FileUnit unit_of(const opencascade::handle<IGESData_IGESModel>& model, const std::filesystem::path& file) {
  double millimetres = model->GlobalSection().UnitValue();
  if (!(millimetres > 0.0)) {
    IGESData_GlobalSection section = model->GlobalSection();
    section.SetUnitFlag(flag_of_millimetres);
    model->SetGlobalSection(section);
    millimetres = 1.0;
  }
  return {name_of(millimetres), millimetres, declares_iges_unit(file)};
}

}  // namespace spoonbill
