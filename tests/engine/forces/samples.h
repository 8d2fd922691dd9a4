// Provides bodies and materials for the tests of true forces: stock shapes, and the models and materials that
// the program ships.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/shapes/stock_shapes.h"

namespace spoonbill {

// Returns a surface fitted to a stock shape.
Surface stock_surface(const StockShapeSize& size);

// Returns a material that the program ships, by the name of its file without ".json".
Material bundled_material(const std::string& name);

// Names of all materials that the program ships.
std::vector<std::string> bundled_material_names();

// Returns the scene of a model that the program ships, by the name of its file without ".json".
Scene bundled_scene(const std::string& name);

// Names of all models that the program ships.
std::vector<std::string> bundled_model_names();

// Returns the material without flow, creep and stiffening.
Material made_elastic(Material material);

}  // namespace spoonbill
