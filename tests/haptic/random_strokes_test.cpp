// Tests random strokes with any material and any panel setting, by a hand that moves at up to 5 m/s. The body
// stays finite and near its original position, no cell stays inverted, and the requested force never exceeds
// the device's limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"
#include "haptic/safe_device.h"
#include "haptic/tick.h"
#include "tests/engine/effort.h"
#include "tests/engine/random.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

std::vector<Material> bundled_materials() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(SPOONBILL_ASSETS) / "materials")) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Material> materials;
  materials.reserve(files.size());
  for (const auto& file : files) materials.push_back(read_material(file).value());
  return materials;
}

// Returns a random material with any values that a file may contain.
Material any_material(Random& random) {
  Material material;
  material.name = material.source = "random";
  material.youngs_modulus_pa = random.log_uniform(youngs_modulus_range_pa.low, youngs_modulus_range_pa.high);
  material.density_kg_per_m3 = random.log_uniform(density_range_kg_per_m3.low, density_range_kg_per_m3.high);
  material.damping_ratio = random.uniform(damping_ratio_range);
  switch (random.bits() % 4) {
    case 0:
      material.plastic = true;
      material.yield_strain = random.log_uniform(yield_strain_range.low, yield_strain_range.high);
      material.flow_rate_per_s = random.uniform(flow_rate_range_per_s);
      material.hardening = random.uniform(hardening_range);
      break;
    case 1:
      material.relaxing_fraction = random.uniform(relaxing_fraction_range);
      material.relaxation_time_s =
          random.log_uniform(relaxation_time_range_s.low, relaxation_time_range_s.high);
      break;
    case 2:
      material.stiffening = random.uniform(stiffening_range);
      break;
    default:
      break;
  }
  material.friction = random.uniform(0.0, 1.0);
  const double least = is_linear_elastic(material) ? poissons_ratio_range.low : min_spring_poissons_ratio;
  material.poissons_ratio = random.uniform(least, poissons_ratio_range.high);
  return material;
}

Scene random_stroke_scene(Random& random, const std::vector<Material>& bundled) {
  Scene scene = small_handle();
  scene.bodies[0].material =
      random.once_in(2) ? bundled[random.bits() % bundled.size()] : any_material(random);
  if (!random.once_in(4)) {
    scene.planes.push_back({Vector3(random.uniform(0.005, 0.04), 0, 0), Vector3::UnitX()});
  }
  scene.tool.kind = random.once_in(3) ? ToolKind::point : ToolKind::sphere;
  scene.tool.action = static_cast<ToolAction>(random.bits() % tool_actions.size());
  scene.tool.radius_m = random.log_uniform(0.001, 0.05);
  scene.tool.iterations = static_cast<int>(1 + random.bits() % 8);
  scene.sculpting.damping_per_s = random.once_in(4) ? 0.0 : random.uniform(0.0, 100.0);
  scene.sculpting.force_scale = random.log_uniform(0.01, 100.0);
  return scene;
}

constexpr double fastest_m_per_s = 5.0;
constexpr int stroke_ticks = 2000, rest_ticks = 1000;
// The hand stays in the box with these half sides around the body's centre. Material that the hand pulls out
// therefore stays there too.
const Vector3 roam_m(0.06, 0.03, 0.03);
const Vector3 centre_m(0.03, 0.0, 0.0);
constexpr double bounds_m = 0.5;

class WanderingHand {
 public:
  explicit WanderingHand(Random& random) : random_(random) {}

  DeviceReading next() {
    if ((target_ - place_).norm() < 1e-9 || random_.once_in(400)) {
      target_ = centre_m + random_.in_box(roam_m);
      speed_m_per_s_ = random_.log_uniform(0.02, fastest_m_per_s);
      if (random_.once_in(3)) buttons_ = random_.once_in(2) ? button_main : 0u;
    }
    const Vector3 way = target_ - place_;
    place_ += way * std::min(1.0, speed_m_per_s_ * tick_s / std::max(way.norm(), 1e-12));
    return DeviceReading::from({place_, Quaternion::Identity()}, buttons_);
  }

  static DeviceReading far_away() {
    return DeviceReading::from({Vector3(0.0, 0.3, 0.0), Quaternion::Identity()}, 0u);
  }

 private:
  Random& random_;
  Vector3 place_ = Vector3(0.03, 0.08, 0.0), target_ = place_;
  double speed_m_per_s_ = 0.1;
  unsigned buttons_ = 0;
};

std::string in_words(const Scene& scene) {
  const Material& material = scene.bodies[0].material;
  std::string words = material.name;
  for (const auto& [name, value] : {std::pair{"E", material.youngs_modulus_pa},
                                    {"nu", material.poissons_ratio},
                                    {"rho", material.density_kg_per_m3},
                                    {"z", material.damping_ratio},
                                    {"plastic", material.plastic ? 1.0 : 0.0},
                                    {"yield", material.yield_strain},
                                    {"flow", material.flow_rate_per_s},
                                    {"hardening", material.hardening},
                                    {"stiffening", material.stiffening},
                                    {"relaxing", material.relaxing_fraction},
                                    {"planes", static_cast<double>(scene.planes.size())},
                                    {"kind", static_cast<double>(scene.tool.kind)},
                                    {"action", static_cast<double>(scene.tool.action)},
                                    {"radius", scene.tool.radius_m},
                                    {"iterations", static_cast<double>(scene.tool.iterations)},
                                    {"damping", scene.sculpting.damping_per_s},
                                    {"scale", scene.sculpting.force_scale}}) {
    words += std::string(", ") + name + " " + std::to_string(value);
  }
  return words;
}

// Returns true if every node is finite and near: near the body's original position if the body is fixed, near
// the nodes' centroid if it is free.
bool is_in_bounds(const SpringLattice& lattice) {
  const std::vector<Vector3> nodes = lattice.positions();
  Vector3 middle = centre_m;
  if (!lattice.has_fixed_nodes()) {
    middle.setZero();
    for (const Vector3& node : nodes) middle += node / static_cast<double>(nodes.size());
  }
  return std::all_of(nodes.begin(), nodes.end(),
                     [&](const Vector3& node) { return (node - middle).norm() < bounds_m; });
}

int inverted_cells(const SpringLattice& lattice) {
  LatticeMesh mesh = lattice.mesh();
  mesh.nodes = lattice.positions();
  int count = 0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) count += !(cell_volume(mesh.cell(i, j, k)) > 0.0);
    }
  }
  return count;
}

struct WatchedStroke {
  bool in_bounds = true;
  double strongest_n = 0.0, limit_n = 0.0;
  int inverted = 0;
  int touches = 0;
};

// Makes a stroke and lets the body rest for a second.
WatchedStroke stroke(Random& random, Simulation& simulation) {
  WatchedStroke watched;
  const DeviceSpecification device;
  watched.limit_n = device.maximum_force_n;
  CouplingState coupling;
  SafetyState safety;
  WanderingHand hand(random);
  for (int t = 0; t < stroke_ticks + rest_ticks; ++t) {
    const DeviceReading reading = t < stroke_ticks ? hand.next() : WanderingHand::far_away();
    const TickResult result = tick(simulation, coupling, device, reading);
    SafetyInput input;
    input.requested_n = result.force_n;
    input.position_m = reading.pose().position_m;
    const SafeForce safe = make_safe(safety, device, input);
    watched.strongest_n = std::max({watched.strongest_n, result.force_n.norm(), safe.force_n.norm()});
    watched.touches += result.touching;
    if (t % 100 == 99) watched.in_bounds = watched.in_bounds && is_in_bounds(simulation.lattice());
  }
  watched.inverted = inverted_cells(simulation.lattice());
  return watched;
}

TEST(RandomStrokes, NeverLeaveTheBodyBroken) {
  // Each stroke and its rest last three seconds.
  const int strokes = sanitized ? 3 : random_cases(8, 100);
  const std::vector<Material> bundled = bundled_materials();
  ASSERT_GE(bundled.size(), 12U);
  Random random(21);
  int touched = 0;
  for (int s = 0; s < strokes; ++s) {
    const Scene scene = random_stroke_scene(random, bundled);
    SCOPED_TRACE(std::to_string(s) + ": " + in_words(scene));
    auto made = Simulation::make(scene, best_instruction_set());
    ASSERT_TRUE(made.ok()) << made.error().message;
    const WatchedStroke watched = stroke(random, made.value());
    EXPECT_TRUE(watched.in_bounds);
    EXPECT_EQ(watched.inverted, 0);
    // The relative tolerance allows for rounding of the norm.
    EXPECT_LE(watched.strongest_n, watched.limit_n * (1.0 + 1e-12));
    touched += watched.touches > 0;
  }
  EXPECT_GT(touched, strokes / 2);
}

}  // namespace
}  // namespace spoonbill
