#include "tests/engine/forces/samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "engine/exchange/document.h"
#include "engine/shapes/fit_shape.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::filesystem::path assets = SPOONBILL_ASSETS;

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::string find_skip_reason(ForceRun smallest) {
  if (sanitized) return long_when_sanitized;
  if (smallest == ForceRun::always || is_long_run()) return "";
  if (smallest == ForceRun::whole_table) return only_in_long;
  return is_full_run() ? "" : only_in_full;
}

void print_result(const std::string& row, const std::string& what, double measured, const std::string& unit) {
  std::printf("| %s | %s | %.6g%s |\n", row.c_str(), what.c_str(), measured,
              unit.empty() ? "" : (" " + unit).c_str());
}

Surface stock_surface(const StockShapeSize& size, const Vector3& centre_m,
                      std::optional<double> tolerance_m) {
  const ExactShape shape = stock_shape(size).value();
  ShapeFit fit;
  fit.tolerance_m = tolerance_m.value_or(default_tolerance_m(shape));
  fit.degree = stock_shape_degree(size);
  return placed(fit_shape(shape, fit).value().surface, {centre_m, Quaternion::Identity()});
}

Material bundled_material(const std::string& name) {
  return read_material(assets / "materials" / (name + ".json")).value();
}

std::vector<std::string> bundled_material_names() {
  return names_in(assets / "materials");
}

Scene bundled_scene(const std::string& name) {
  return read_document(assets / "models" / (name + ".json")).value().scene;
}

std::vector<std::string> bundled_model_names() {
  return names_in(assets / "models");
}

Material made_elastic(Material material) {
  material.plastic = false;
  material.relaxing_fraction = 0.0;
  material.stiffening = 0.0;
  material.friction = 0.0;
  return material;
}

Body stock_body(const std::string& name, const StockShapeSize& size, const Vector3& centre_m,
                const Material& material, int node_budget) {
  Body body;
  body.name = name;
  body.surface = stock_surface(size, centre_m);
  body.material = material;
  body.lattice.node_budget = node_budget;
  return body;
}

BodyRegion end_region(const Surface& tube, int axis, bool at_larger, double length) {
  const double start = position(tube, tube.u.domain_start(), tube.v.domain_start())[axis];
  const double end = position(tube, tube.u.domain_start(), tube.v.domain_end())[axis];
  BodyRegion region;
  region.along = (end > start) == at_larger ? Range<double>{1.0 - length, 1.0} : Range<double>{0.0, length};
  return region;
}

Scene settling_scene(std::vector<Body> bodies) {
  Scene scene;
  scene.bodies = std::move(bodies);
  scene.sculpting.is_critically_damped = true;
  return scene;
}

Simulation make_simulation(const Scene& scene) {
  Result<Simulation> simulation = Simulation::make(scene, best_instruction_set());
  EXPECT_TRUE(simulation.ok()) << simulation.error().message;
  return std::move(simulation).value();
}

ToolInput idle_tool() {
  ToolInput input;
  input.pose.position_m = {0.0, 1.0, 0.0};
  return input;
}

double mean_over(Simulation& simulation, int ticks, const ToolInput& input,
                 const std::function<double()>& measure) {
  double sum = 0.0;
  for (int tick = 0; tick < ticks; ++tick) {
    simulation.advance(input);
    sum += measure();
  }
  return sum / ticks;
}

void advance(Simulation& simulation, int ticks, const ToolInput& input) {
  for (int tick = 0; tick < ticks; ++tick) simulation.advance(input);
}

}  // namespace spoonbill
