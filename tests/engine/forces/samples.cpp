#include "tests/engine/forces/samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "engine/exchange/document.h"
#include "engine/shapes/fit_shape.h"

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

Surface stock_surface(const StockShapeSize& size) {
  const ExactShape shape = stock_shape(size).value();
  ShapeFit fit;
  fit.tolerance_m = default_tolerance_m(shape);
  fit.degree = stock_shape_degree(size);
  return fit_shape(shape, fit).value().surface;
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
  return material;
}

}  // namespace spoonbill
