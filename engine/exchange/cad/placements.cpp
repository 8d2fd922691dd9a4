#include "engine/exchange/cad/placements.h"

#include <IGESData_IGESEntity.hxx>
#include <IGESData_TransfEntity.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <algorithm>
#include <cmath>
#include <gp_GTrsf.hxx>
#include <gp_Mat.hxx>
#include <gp_XYZ.hxx>

namespace spoonbill {
namespace {

using Operator = StepGeom_CartesianTransformationOperator3d;
using UnitDirection = opencascade::handle<StepGeom_Direction>;

// Of files' own rounding.
constexpr double rounding = 1e-4;

gp_XYZ vector_of(const UnitDirection& direction, const gp_XYZ& otherwise) {
  if (direction.IsNull() || direction->NbDirectionRatios() < 3) return otherwise;
  return {direction->DirectionRatiosValue(1), direction->DirectionRatiosValue(2),
          direction->DirectionRatiosValue(3)};
}

// ISO 10303-42, 4.4.16: axes that are left out follow from the others, the third as their cross product.
bool mirrors(const Operator& placement) {
  if (placement.Axis1().IsNull() || placement.Axis2().IsNull() || placement.Axis3().IsNull()) return false;
  const gp_XYZ first = vector_of(placement.Axis1(), {1, 0, 0}),
               second = vector_of(placement.Axis2(), {0, 1, 0});
  return first.Crossed(second).Dot(vector_of(placement.Axis3(), {0, 0, 1})) < 0.0;
}

bool keeps_angles(const gp_Mat& matrix) {
  double least = matrix.Column(1).Modulus(), most = least;
  for (int k = 2; k <= 3; ++k) {
    least = std::min(least, matrix.Column(k).Modulus());
    most = std::max(most, matrix.Column(k).Modulus());
  }
  if (most - least > rounding * most) return false;
  for (int k = 1; k <= 3; ++k) {
    const double cosine = matrix.Column(k).Dot(matrix.Column(k % 3 + 1)) / (most * most);
    if (!(std::abs(cosine) <= rounding)) return false;
  }
  return true;
}

}  // namespace

int count_unread_placements(const opencascade::handle<StepData_StepModel>& model) {
  int count = 0;
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
  for (int k = 1; k <= model->NbEntities(); ++k) {
    const auto entity = model->Entity(k);
    if (!entity.IsNull() && entity->HasTransf() && !keeps_angles(entity->Transf()->Value().VectorialPart())) {
      ++count;
    }
  }
  return count;
}

}  // namespace spoonbill
