#include "tests/bench/presses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptic/recording.h"

namespace spoonbill {
namespace {

constexpr double edge_m = 0.06;

// Returns a tube that is nearly a box: sections of equal width and height, and nearly flat caps.
Surface box_like_tube() {
  constexpr int around = 16;
  const std::vector<double> stations = {0, 0, 0.02, 0.06, 0.2, 0.4, 0.6, 0.8, 0.94, 0.98, 1, 1};
  const std::vector<double> scale = {0, 0.85, 0.98, 1, 1, 1, 1, 1, 1, 0.98, 0.85, 0};
  const int along = static_cast<int>(stations.size());
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / around;
    const double c = std::cos(angle), s = std::sin(angle);
    const double radius = 0.5 * edge_m / std::pow(std::pow(c, 4) + std::pow(s, 4), 0.25);
    for (int j = 0; j < along; ++j) {
      net.set_point(i, j, {edge_m * stations[j], -scale[j] * radius * s, scale[j] * radius * c});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, around).value(),
                      KnotVector::clamped_uniform(3, along).value(), std::move(net))
      .value();
}

Material clay() {
  Material clay;
  clay.name = clay.source = "benchmark";
  clay.youngs_modulus_pa = 1e5;
  clay.poissons_ratio = 0.45;
  clay.density_kg_per_m3 = 1700.0;
  clay.damping_time_s = 1.1e-5;
  clay.plastic = true;
  clay.yield_strain = 0.005;
  clay.flow_rate_per_s = 300.0;
  return clay;
}

Material abs() {
  Material abs;
  abs.name = abs.source = "benchmark";
  abs.youngs_modulus_pa = 2e9;
  abs.poissons_ratio = 0.39;
  abs.density_kg_per_m3 = 1040.0;
  abs.damping_time_s = 1.1e-5;
  return abs;
}

// Returns the readings of a hand that presses a sphere `depth_m` deep within a second, waits a moment and
// moves up again.
std::vector<DeviceReading> readings_of_press(double surface_m, double radius_m, double depth_m) {
  std::vector<DeviceReading> readings;
  for (int t = 0; t < 1700; ++t) {
    const double down = t < 1000 ? 1e-3 * t : t < 1200 ? 1.0 : 1.0 - 2e-3 * (t - 1200);
    const double y = surface_m + radius_m + 0.05 * depth_m - 1.05 * depth_m * std::max(down, 0.0);
    readings.push_back(DeviceReading::from({Vector3(0.7 * edge_m, y, 0), Quaternion::Identity()}, 0));
  }
  return readings;
}

}  // namespace

Result<Press> recorded_press(const std::filesystem::path& file) {
  auto recording = read_recording(file);
  if (!recording) return recording.error();
  return Press{recording->header.document.scene, recording->header.device, recording->readings,
               recording->commands};
}

Result<Press> stiff_press(const std::filesystem::path& recording) {
  auto press = recorded_press(recording);
  if (press.ok()) {
    for (Body& body : press->scene.bodies) body.material = abs();
  }
  return press;
}

Press block_press(int count, int substeps) {
  Press press{Scene{{Body{"block", box_like_tube(), clay(), LatticeRequest{40000, {{count, count, count}}}}},
                    {},
                    Tool{},
                    Sculpting{}},
              DeviceSpecification{},
              {},
              {}};
  press.scene.tool.radius_m = 0.012;
  press.scene.tool.substeps = substeps;
  press.scene.sculpting.force_scale = 20.0;
  press.scene.planes.push_back({Vector3(0.15 * edge_m, 0, 0), Vector3::UnitX()});
  press.readings = readings_of_press(0.5 * edge_m, press.scene.tool.radius_m, 0.1 * edge_m);
  return press;
}

}  // namespace spoonbill
