#include "app/start/shipped_materials.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "app/assets_folder.h"
#include "engine/exchange/document.h"

namespace spoonbill {
namespace {

std::filesystem::path materials_folder() {
  return std::filesystem::path(assets_folder) / "materials";
}

}  // namespace

std::vector<std::string> shipped_material_names() {
  std::vector<std::string> names;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(materials_folder(), problem)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<Material> shipped_material(const std::string& name) {
  const std::vector<std::string> names = shipped_material_names();
  std::vector<std::string> fitting;
  std::string all;
  for (const std::string& known : names) {
    all += (all.empty() ? "" : ", ") + known;
    if (known == name) {
      fitting = {known};
      break;
    }
    if (!name.empty() && known.find(name) != std::string::npos) fitting.push_back(known);
  }
  if (fitting.size() == 1) return read_material(materials_folder() / (fitting[0] + ".json"));
  return Error{"'" + name.substr(0, 40) + "' " +
               (fitting.empty() ? "is no material that comes with the program: "
                                : "may be several materials, name one whole: ") +
               all};
}

}  // namespace spoonbill
