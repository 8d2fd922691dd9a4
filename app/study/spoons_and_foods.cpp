#include "app/study/spoons_and_foods.h"

#include <array>
#include <utility>

#include "app/assets_folder.h"
#include "engine/base/text.h"
#include "engine/bspline/strip_volumes.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/exchange/document.h"
#include "engine/scene/place_body.h"

namespace spoonbill {
namespace {

constexpr std::array<double, 3> usual_size_mm{28.0, 14.0, 22.0};
constexpr Range<double> food_size_range_m{1e-3, 0.2};
constexpr std::size_t longest_name = 100;  // bytes
// Rate at which yielding food flows, per second: its stress relaxes within some milliseconds.
constexpr double usual_flow_rate_per_s = 300.0;
// Gelatin that yields at a third of the pressure of its own height, just above what a trial refuses as
// liquid.
constexpr double usual_yield_strain = 0.012;

std::filesystem::path asset(const char* folder, const std::string& name) {
  return std::filesystem::path(assets_folder) / folder / (name + ".json");
}

// Refuses a body that is not bounded by one closed surface with outward normals.
Status check_solid(const Body& body) {
  const bool is_plain = !body.mesh && !body.shell_thickness_m && body.trims.empty();
  if (is_plain && check_closed(body.surface).ok() && compute_closed_volume_m3(body.surface) > 0.0) return {};
  return Error{ErrorCode::unsupported,
               "body \"" + excerpt(body.name) +
                   "\": must be one closed surface with outward normals, without trims "
                   "and shell thickness"};
}

// Returns food of a shape and a size.
Result<StudyFood> make_food(const std::string& name, const std::filesystem::path& shape, Material material,
                            const Vector3& size_m) {
  auto document = read_document(shape);
  if (!document) return document.error();
  StudyFood food{name, document->scene.bodies.front()};
  if (Status solid = check_solid(food.body); !solid) return solid.error().in(shape.string());
  food.body.loads.clear();
  food.body.supports.clear();
  food.body.regions.clear();
  food.body.kind = BodyKind::deformable;
  const Box box = bounding_box(food.body.surface.net);
  scale_body(size_m.cwiseQuotient(box.extent()), box.centre(), food.body);
  food.body.material = std::move(material);
  // Gels relax within half a minute; creep would only keep the food from coming to rest within a case.
  food.body.material.relaxing_fraction = 0.0;
  return food;
}

std::filesystem::path usual_shape() {
  return asset("models", "jelly-on-spoon");
}

void make_yielding(double yield_strain, Material& material) {
  material.plastic = true;
  material.yield_strain = yield_strain;
  if (material.flow_rate_per_s == 0.0) material.flow_rate_per_s = usual_flow_rate_per_s;
}

}  // namespace

Result<Material> read_named_material(const std::string& name) {
  return read_material(asset("materials", name));
}

Result<StudyFood> read_food(FieldReader reader, const std::filesystem::path& folder) {
  const std::string name = reader.text("name");
  Material material;
  if (const std::string wanted = reader.text("material"); reader.status().ok()) {
    auto read = read_named_material(wanted);
    if (!read) {
      reader.refuse("material", "\"" + excerpt(wanted) + "\" does not come with the program",
                    ErrorCode::missing);
    } else {
      material = std::move(read).value();
    }
  }
  if (reader.has("youngs_modulus_pa")) {
    material.youngs_modulus_pa = reader.number("youngs_modulus_pa", youngs_modulus_range_pa);
  }
  if (reader.has("yield_strain")) make_yielding(reader.number("yield_strain", yield_strain_range), material);
  const Vector3 size_m = reader.position_m("size_mm", food_size_range_m);
  const std::filesystem::path shape = reader.has("shape") ? folder / reader.text("shape") : usual_shape();
  reader.finish();
  if (Status status = reader.status(); !status) return status.error();
  return make_food(name, shape, std::move(material), size_m);
}

Result<StudySpoon> read_spoon(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  if (document->scene.bodies.size() != 1) {
    return Error{ErrorCode::too_many, file.string() + ": has " +
                                          std::to_string(document->scene.bodies.size()) +
                                          " bodies; merge the parts of a spoon before a study"};
  }
  StudySpoon spoon{file.stem().string(), file, std::move(document->scene.bodies.front()), {}};
  Body& body = spoon.body;
  // Names are written into files that are read again.
  if (spoon.name.empty() || spoon.name.size() > longest_name || escaped(spoon.name) != spoon.name) {
    return Error{ErrorCode::out_of_range, file.string() + ": the name of a spoon's file must have at most " +
                                              std::to_string(longest_name) +
                                              " bytes of plain text; rename the file"};
  }
  if (Status solid = check_solid(body); !solid) return solid.error().in(file.string());
  // A study holds and turns the spoon itself, and sets its friction.
  body.kind = BodyKind::fixed;
  body.loads.clear();
  body.supports.clear();
  body.regions.clear();
  body.hand.reset();
  body.motion.reset();
  auto bowl = find_bowl(spoon.body, Vector3::UnitY());
  if (!bowl) return bowl.error().in(file.string());
  spoon.bowl = std::move(bowl).value();
  return spoon;
}

Result<std::vector<StudyFood>> read_usual_foods() {
  const auto gelatin = read_named_material("gelatin-20-1");
  if (!gelatin) return gelatin.error();
  Material yielding = gelatin.value();
  make_yielding(usual_yield_strain, yielding);
  std::vector<StudyFood> foods;
  const Vector3 size_m = 1e-3 * Vector3(usual_size_mm[0], usual_size_mm[1], usual_size_mm[2]);
  for (const auto& [name, material] : {std::pair<const char*, const Material&>{"gelatin", gelatin.value()},
                                       {"yielding gelatin", yielding}}) {
    auto food = make_food(name, usual_shape(), material, size_m);
    if (!food) return food.error();
    foods.push_back(std::move(food).value());
  }
  return foods;
}

}  // namespace spoonbill
