#include "engine/exchange/region_json.h"

#include "engine/exchange/field_json.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {
namespace {

MaterialRegion read_material_region(FieldReader reader) {
  MaterialRegion region;
  region.region = read_region(reader.inner("region"));
  if (reader.has("material")) {
    FieldReader material = reader.inner("material");
    region.material = read_fields<Material>(material);
    material.finish();
  }
  if (reader.has("friction")) region.friction = reader.number("friction", friction_range);
  for (const char* field : {"material", "friction"}) reader.ignore(field);
  reader.finish();
  if (!region.material && !region.friction) reader.refuse("must have material or friction, or both");
  return region;
}

}  // namespace

std::vector<MaterialRegion> read_material_regions(FieldReader& body) {
  std::vector<MaterialRegion> regions;
  if (!body.has("regions")) {
    body.ignore("regions");
    return regions;
  }
  for (const Json& item : body.list("regions", material_region_count_range)) {
    regions.push_back(read_material_region(body.element(item, "regions", regions.size())));
  }
  return regions;
}

void add_material_regions(const std::vector<MaterialRegion>& regions, Json& body) {
  for (const MaterialRegion& region : regions) {
    Json& json = body["regions"].emplace_back(Json::object());
    json["region"] = region_to_json(region.region);
    if (region.material) add_fields(*region.material, json["material"]);
    if (region.friction) json["friction"] = number_to_json(*region.friction);
  }
}

}  // namespace spoonbill
