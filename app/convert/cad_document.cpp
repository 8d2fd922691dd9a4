#include "app/convert/cad_document.h"

#include <filesystem>
#include <utility>

#include "app/assets_folder.h"

namespace spoonbill {

Result<Document> document_of(const CadModel& model, const std::string& name) {
  const auto most = static_cast<std::size_t>(body_count_range.high);
  if (model.surfaces.size() > most) {
    return Error{"has " + std::to_string(model.surfaces.size()) + " faces, and a document holds " +
                 std::to_string(most) + " bodies; export fewer faces"};
  }
  const auto material =
      read_material(std::filesystem::path(assets_folder) / "materials" / "modelling-clay.json");
  if (!material) return material.error();
  Document document;
  document.name = name;
  for (const CadSurface& surface : model.surfaces) {
    Body body;
    body.name = surface.name;
    body.surface = surface.surface;
    body.material = material.value();
    document.scene.bodies.push_back(std::move(body));
  }
  return document;
}

}  // namespace spoonbill
