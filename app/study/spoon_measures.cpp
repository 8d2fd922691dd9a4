#include "app/study/spoon_measures.h"

#include <algorithm>
#include <cmath>

#include "engine/inspection/mass_properties.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

constexpr double grip_step_m = 0.02;
constexpr int samples_along = 400, samples_around = 96;

// Returns points of the surface of the spoon, in the frame of its bowl: along the front, up and to the left.
std::vector<Vector3> sample_points(const StudySpoon& spoon) {
  std::vector<Vector3> points;
  const Surface& surface = spoon.body.surface;
  const Bowl& bowl = spoon.bowl;
  for (int i = 0; i < samples_around; ++i) {
    for (int j = 0; j <= samples_along; ++j) {
      const Vector3 offset =
          position(surface, surface.u.parameter_at(static_cast<double>(i) / samples_around),
                   surface.v.parameter_at(static_cast<double>(j) / samples_along)) -
          bowl.centre_m;
      points.emplace_back(bowl.front.dot(offset), bowl.normal.dot(offset), bowl.left().dot(offset));
    }
  }
  return points;
}

double find_end_m(const std::vector<Vector3>& points) {
  double end_m = infinity;
  for (const Vector3& point : points) end_m = std::min(end_m, point.x());
  return end_m;
}

// Returns the box about the part of the spoon within a millimetre of a place along it.
Box find_slice(const std::vector<Vector3>& points, double along_m) {
  Box slice;
  for (const Vector3& point : points) {
    if (std::abs(point.x() - along_m) <= 1e-3) slice.include(point);
  }
  return slice;
}

double find_width_m(const std::vector<Vector3>& points, double along_m) {
  const Box slice = find_slice(points, along_m);
  return slice.is_empty() ? 0.0 : slice.extent().z();
}

}  // namespace

Handle find_handle(const StudySpoon& spoon) {
  const double end_m = find_end_m(sample_points(spoon));
  return {end_m, -0.5 * spoon.bowl.length_m - end_m};
}

SpoonSection find_section(const StudySpoon& spoon, double from_end_m) {
  const std::vector<Vector3> points = sample_points(spoon);
  const Box slice = find_slice(points, find_end_m(points) + from_end_m);
  if (slice.is_empty()) return {};
  const Vector3 centre = slice.centre();
  const Bowl& bowl = spoon.bowl;
  return {bowl.centre_m + centre.x() * bowl.front + centre.y() * bowl.normal + centre.z() * bowl.left(),
          slice.extent().z()};
}

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
  const std::vector<Vector3> points = sample_points(spoon);
  const double end_m = find_end_m(points);
  double tip_m = -infinity;
  for (const Vector3& point : points) tip_m = std::max(tip_m, point.x());
  measures.length_m = tip_m - end_m;
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
