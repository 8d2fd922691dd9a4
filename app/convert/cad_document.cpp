#include "app/convert/cad_document.h"

#include <utility>

#include "app/start/shipped_materials.h"
#include "app/start/starting_document.h"

namespace spoonbill {

Result<Document> document_of(const CadModel& model, const std::string& name) {
  const auto most = static_cast<std::size_t>(body_count_range.high);
  if (model.surfaces.size() > most) {
    return Error{"has " + std::to_string(model.surfaces.size()) + " faces, and a document holds " +
                 std::to_string(most) + " bodies; choose some with --bodies 1,3-5"};
  }
  const auto material = shipped_material("modelling-clay");
  if (!material) return material.error();
  Document document = starting_document(name, model.surfaces.front().surface, material.value());
  const Body first = document.scene.bodies.front();
  document.scene.bodies.clear();
  for (const CadSurface& surface : model.surfaces) {
    Body body = first;
    body.name = surface.name;
    body.surface = surface.surface;
    body.trims = surface.trims;
    body.solid = surface.solid;
    document.scene.bodies.push_back(std::move(body));
  }
  return document;
}

}  // namespace spoonbill
