// Tests random strokes on one to three bodies with any material and any panel setting. The hand moves at up
// to 5 m/s; bodies may be without fixed nodes, and materials may change during a stroke. All numbers of
// documents, frames and the panel must stay finite. Bodies that are not free must stay near their initial
// positions. If there is only one body, none of its cells may stay inverted. The requested force must never
// exceed the device's limit.
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
  material.damping_time_s = random.uniform(damping_time_range_s);
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

Material random_material(Random& random, const std::vector<Material>& bundled) {
  return random.once_in(2) ? bundled[random.bits() % bundled.size()] : any_material(random);
}

// Returns a scene of up to `most_bodies` handles above each other, a millimetre apart.
Scene random_stroke_scene(Random& random, const std::vector<Material>& bundled, int most_bodies) {
  Scene scene = small_handle();
  const Body handle = scene.bodies[0];
  scene.bodies.resize(static_cast<std::size_t>(random.integer(1, most_bodies)), handle);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    Body& body = scene.bodies[b];
    body.name = "handle " + std::to_string(b);
    for (double& y : body.surface.net.y) y += 0.006 * static_cast<double>(b);
    body.material = random_material(random, bundled);
  }
  if (!random.once_in(3)) {
    scene.planes.push_back({Vector3(random.uniform(0.005, 0.04), 0, 0), Vector3::UnitX()});
  }
  scene.tool.kind = random.once_in(3) ? ToolKind::point : ToolKind::sphere;
  scene.tool.action = static_cast<ToolAction>(random.bits() % tool_actions.size());
  scene.tool.radius_m = random.log_uniform(0.001, 0.05);
  scene.tool.substeps = static_cast<int>(1 + random.bits() % 8);
  scene.sculpting.drag_per_s = random.once_in(4) ? 0.0 : random.uniform(0.0, 600.0);
  scene.sculpting.force_scale = random.log_uniform(0.01, 100.0);
  scene.sculpting.free = random.once_in(4);
  return scene;
}

constexpr double fastest_m_per_s = 5.0;
// Half the sides of a box around the body's centre. The hand moves between points of this box, so that
// material that it pulls out also stays in the box.
const Vector3 roam_m(0.06, 0.03, 0.03);
const Vector3 centre_m(0.03, 0.0, 0.0);

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
  std::string words = std::to_string(scene.bodies.size()) + " bodies, " + material.name;
  for (const auto& [name, value] : {std::pair{"E", material.youngs_modulus_pa},
                                    {"nu", material.poissons_ratio},
                                    {"rho", material.density_kg_per_m3},
                                    {"damping time", material.damping_time_s},
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
                                    {"substeps", static_cast<double>(scene.tool.substeps)},
                                    {"drag", scene.sculpting.drag_per_s},
                                    {"scale", scene.sculpting.force_scale},
                                    {"free", scene.sculpting.free ? 1.0 : 0.0}}) {
    words += std::string(", ") + name + " " + std::to_string(value);
  }
  return words;
}

Vector3 mean_node(const std::vector<Vector3>& nodes) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& node : nodes) sum += node;
  return sum / static_cast<double>(nodes.size());
}

// Centre and size of a scene as it was loaded.
struct Place {
  Vector3 centre_m = Vector3::Zero();
  double size_m = 0.0;
};

Place find_place(const Scene& scene) {
  Box box;
  for (const Body& body : scene.bodies) box.join(bounding_box(body.surface.net));
  return {box.centre(), box.size()};
}

// Returns true if the distance of every node from a centre is below twice the scene's size. The centre is the
// scene's initial centre, or the mean of the body's nodes if the body may move.
bool is_in_bounds(const Simulation& simulation, const Place& place) {
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const SpringLattice& lattice = simulation.lattice(static_cast<int>(b));
    const std::vector<Vector3> nodes = lattice.positions();
    const bool may_move = simulation.scene().sculpting.free && !lattice.has_fixed_nodes();
    const Vector3 centre = may_move ? mean_node(nodes) : place.centre_m;
    for (const Vector3& node : nodes) {
      if (!((node - centre).norm() < 2.0 * place.size_m)) return false;
    }
  }
  return true;
}

template <class Number>
bool is_finite(const std::vector<Number>& values) {
  return std::all_of(values.begin(), values.end(), [](Number value) { return std::isfinite(value); });
}

// Returns true if all numbers that are saved, drawn or shown in the panel are finite.
bool is_shown_finite(const Simulation& simulation) {
  Scene saved;
  simulation.write_scene(saved);
  for (const Body& body : saved.bodies) {
    const ControlNet& net = body.surface.net;
    if (!is_finite(net.x) || !is_finite(net.y) || !is_finite(net.z)) return false;
  }
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  for (const BodySnapshot& body : snapshot.bodies) {
    if (!is_finite<double>({body.residual.largest_m, body.residual.root_mean_square_m})) return false;
    if (!is_finite(body.surface.x) || !is_finite(body.surface.y) || !is_finite(body.surface.z)) return false;
  }
  return snapshot.force_n.allFinite() && snapshot.tool.proxy.position_m.allFinite();
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
  bool is_finite = true;
  double strongest_n = 0.0, limit_n = 0.0;
  int inverted = 0;
  int touches = 0;
};

// Makes a stroke, during which materials may change, and lets the bodies rest for half as long.
WatchedStroke stroke(Random& random, Simulation& simulation, const std::vector<Material>& bundled,
                     int stroke_ticks) {
  WatchedStroke watched;
  const DeviceSpecification device;
  const Place place = find_place(simulation.scene());
  watched.limit_n = device.maximum_force_n;
  CouplingState coupling;
  SafetyState safety;
  WanderingHand hand(random);
  for (int t = 0; t < stroke_ticks + stroke_ticks / 2; ++t) {
    if (t < stroke_ticks && random.once_in(static_cast<std::uint64_t>(stroke_ticks) / 2)) {
      const int body = random.integer(0, static_cast<int>(simulation.scene().bodies.size()) - 1);
      // A refused material changes nothing.
      static_cast<void>(simulation.apply(SetMaterial{random_material(random, bundled), body}));
    }
    const DeviceReading reading = t < stroke_ticks ? hand.next() : WanderingHand::far_away();
    const TickResult result = tick(simulation, coupling, device, reading);
    SafetyInput input;
    input.requested_n = result.force_n;
    input.position_m = reading.pose().position_m;
    const SafeForce safe = make_safe(safety, device, input);
    watched.strongest_n = std::max({watched.strongest_n, result.force_n.norm(), safe.force_n.norm()});
    watched.touches += result.touching;
    if (t % 100 != 99) continue;
    watched.in_bounds = watched.in_bounds && is_in_bounds(simulation, place);
    watched.is_finite = watched.is_finite && is_shown_finite(simulation);
  }
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    watched.inverted += inverted_cells(simulation.lattice(static_cast<int>(b)));
  }
  return watched;
}

void try_strokes(std::uint64_t seed, int strokes, int most_bodies, int stroke_ticks) {
  const std::vector<Material> bundled = bundled_materials();
  ASSERT_GE(bundled.size(), 12U);
  Random random(seed);
  int touched = 0;
  for (int s = 0; s < strokes; ++s) {
    const Scene scene = random_stroke_scene(random, bundled, most_bodies);
    SCOPED_TRACE(std::to_string(s) + ": " + in_words(scene));
    auto made = Simulation::make(scene, best_instruction_set());
    ASSERT_TRUE(made.ok()) << made.error().message;
    const WatchedStroke watched = stroke(random, made.value(), bundled, stroke_ticks);
    EXPECT_TRUE(watched.in_bounds);
    EXPECT_TRUE(watched.is_finite);
    // If several bodies are pressed into each other, cells may be crushed.
    EXPECT_TRUE(watched.inverted == 0 || most_bodies > 1);
    // The relative tolerance allows for rounding of the norm.
    EXPECT_LE(watched.strongest_n, watched.limit_n * (1.0 + 1e-12));
    touched += watched.touches > 0;
  }
  // At least a quarter of the strokes must touch a body. The bound is low, because a hand that wanders for
  // only half a second often misses the bodies.
  EXPECT_GE(touched, std::max(1, strokes / 4));
}

TEST(RandomStrokes, NeverLeaveABodyBroken) {
  try_strokes(21, sanitized ? 3 : random_cases(is_full_run() ? 60 : 3, 200), 1, is_full_run() ? 2000 : 1000);
}

// A tick of bodies that are pressed into each other takes up to 40 ms.
TEST(RandomStrokes, NeverLoseSeveralBodies) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  try_strokes(22, random_cases(4, 40), 3, 500);
}

}  // namespace
}  // namespace spoonbill
