#include "app/study/spoon_measures.h"

#include <algorithm>
#include <cmath>

#include "engine/inspection/mass_properties.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

constexpr double grip_step_m = 0.02;
constexpr int samples_along = 400, samples_around = 96;

struct PlanPoint {
  double along_m = 0.0, across_m = 0.0;  // from the rim's centre
};

std::vector<PlanPoint> sample_points(const StudySpoon& spoon) {
  std::vector<PlanPoint> points;
  const Surface& surface = spoon.body.surface;
  for (int i = 0; i < samples_around; ++i) {
    for (int j = 0; j <= samples_along; ++j) {
      const Vector3 offset =
          position(surface, surface.u.parameter_at(static_cast<double>(i) / samples_around),
                   surface.v.parameter_at(static_cast<double>(j) / samples_along)) -
          spoon.bowl.centre_m;
      points.push_back({spoon.bowl.front.dot(offset), spoon.bowl.left().dot(offset)});
    }
  }
  return points;
}

// Returns the width of the spoon within a millimetre of a place along it.
double find_width_m(const std::vector<PlanPoint>& points, double along_m) {
  double low = infinity, high = -infinity;
  for (const PlanPoint& point : points) {
    if (std::abs(point.along_m - along_m) > 1e-3) continue;
    low = std::min(low, point.across_m);
    high = std::max(high, point.across_m);
  }
  return std::max(0.0, high - low);
}

}  // namespace

double find_food_kg(const StudyFood& food) {
  return compute_enclosed_mass(food.body.surface).volume_m3 * food.body.material.density_kg_per_m3;
}

Result<SpoonMeasures> measure_spoon(const StudySpoon& spoon, const Material& material, double food_kg) {
  const EnclosedMass mass = compute_enclosed_mass(spoon.body.surface);
  if (!(mass.volume_m3 > 0.0)) {
    return Error{ErrorCode::degenerate, spoon.file.string() + ": the surface encloses no volume"};
  }
  SpoonMeasures measures;
  measures.mass_kg = mass.volume_m3 * material.density_kg_per_m3;
  measures.centre_m = mass.centre_m;
  const std::vector<PlanPoint> points = sample_points(spoon);
  const auto [end, tip] =
      std::minmax_element(points.begin(), points.end(),
                          [](const PlanPoint& a, const PlanPoint& b) { return a.along_m < b.along_m; });
  const double end_m = end->along_m;
  measures.length_m = tip->along_m - end_m;
  const double centre_along_m = spoon.bowl.front.dot(mass.centre_m - spoon.bowl.centre_m);
  measures.balance_m = centre_along_m - end_m;
  // The handle ends where the bowl begins.
  for (double from_end_m = grip_step_m; end_m + from_end_m < -0.5 * spoon.bowl.length_m - grip_step_m;
       from_end_m += grip_step_m) {
    GripMeasure grip;
    grip.from_end_m = from_end_m;
    const double along_m = end_m + from_end_m;
    grip.width_m = find_width_m(points, along_m);
    grip.torque_nm = standard_gravity_m_per_s2 *
                     std::abs(measures.mass_kg * (centre_along_m - along_m) - food_kg * along_m);
    if (!(grip.width_m > 0.0)) continue;
    grip.force_n = grip.torque_nm / (skin_friction * grip.width_m);
    measures.grips.push_back(grip);
  }
  return measures;
}

}  // namespace spoonbill
