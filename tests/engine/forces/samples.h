// Provides bodies, scenes and measurements for tests that compare forces with exact values, and selects the
// cases that a run tries.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/shapes/stock_shapes.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// The smallest test run that includes a case: tests/run, tests/run --full or tests/run --long.
enum class ForceRun { always, full, whole_table };

// Returns the reason to skip a case in the present run; empty if the case is to be tried.
std::string find_skip_reason(ForceRun smallest);

// Prints a line of the table of results.
void print_result(const std::string& row, const std::string& what, double measured,
                  const std::string& unit = "");

// Returns a surface fitted to a stock shape, moved by `centre_m`. The default tolerance is
// default_tolerance_m() of the shape.
Surface stock_surface(const StockShapeSize& size, const Vector3& centre_m = Vector3::Zero(),
                      std::optional<double> tolerance_m = {});

// Returns a material that the program ships, by the name of its file without ".json".
Material bundled_material(const std::string& name);
// Returns the names of all materials that the program ships.
std::vector<std::string> bundled_material_names();

// Returns the scene of a model that the program ships, by the name of its file without ".json".
Scene bundled_scene(const std::string& name);
// Returns the names of all models that the program ships.
std::vector<std::string> bundled_model_names();

// Returns the material without plastic flow, relaxation, stiffening and friction.
Material made_elastic(Material material);

// Returns a body of a stock shape.
Body stock_body(const std::string& name, const StockShapeSize& size, const Vector3& centre_m,
                const Material& material, int node_budget);

// Returns the region at one end of a tube: the end with the larger coordinate along an axis if `at_larger` is
// true, otherwise the opposite end. `length` is a fraction of the tube's length.
BodyRegion end_region(const Surface& tube, int axis, bool at_larger, double length);

// Returns a scene of these bodies without gravity. Motion is critically damped, so that the scene comes to
// rest quickly.
Scene settling_scene(std::vector<Body> bodies);

Simulation make_simulation(const Scene& scene);

// Returns the input of a tool far from all bodies.
ToolInput idle_tool();

// Advances the simulation and returns the mean of a measurement over the ticks.
double mean_over(Simulation& simulation, int ticks, const ToolInput& input,
                 const std::function<double()>& measure);

void advance(Simulation& simulation, int ticks, const ToolInput& input);

}  // namespace spoonbill
