#include "app/start/lump_choice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <utility>

#include "app/start/starting_document.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {
namespace {

// Of a lump to be shaped by hand.
constexpr double tolerance_m = 1e-4;

const std::array<LumpKind, 6>& kinds() {
  static const std::array<LumpKind, 6> all = {{
      {"Sphere", {{"Radius", 30.0}}},
      {"Box", {{"Along x", 60.0}, {"Along y", 40.0}, {"Along z", 20.0}, {"Rounding", 3.0}}},
      {"Cylinder", {{"Radius", 20.0}, {"Height", 60.0}, {"Rounding", 3.0}}},
      {"Cone", {{"Radius", 30.0}, {"Height", 60.0}, {"Rounding", 4.0}}},
      {"Plate", {{"Along x", 100.0}, {"Along z", 60.0}, {"Thickness", 5.0}, {"Corners", 8.0}}},
      {"Sheet", {{"Along x", 100.0}, {"Along z", 60.0}, {"Thickness", 2.0}}},
  }};
  return all;
}

struct SizedLump {
  StockShapeSize size;
  std::optional<double> shell_thickness_m = {};
};

SizedLump sized(std::size_t kind, const std::vector<double>& m) {
  switch (kind) {
    case 0:
      return {SphereSize{m[0]}};
    case 1:
      return {BoxSize{{m[0], m[1], m[2]}, m[3]}};
    case 2:
      return {CylinderSize{m[0], m[1], m[2]}};
    case 3:
      return {ConeSize{m[0], m[1], 0.0, m[2]}};
    case 4:
      return {PlateSize{m[0], m[1], m[2], m[3]}};
    default:
      return {SheetSize{m[0], m[1]}, m[2]};
  }
}

std::string lower_case(std::string text) {
  for (char& letter : text) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return text;
}

}  // namespace

std::span<const LumpKind> lump_kinds() {
  return kinds();
}

LumpChoice usual_choice(std::size_t kind) {
  LumpChoice choice{kind, {}};
  for (const LumpField& field : kinds()[kind].fields) choice.sizes_mm.push_back(field.usual_mm);
  return choice;
}

Result<Document> lump_document(const LumpChoice& choice, const Material& material) {
  std::vector<double> sizes_m;
  for (const double size_mm : choice.sizes_mm) sizes_m.push_back(1e-3 * size_mm);
  const SizedLump lump = sized(choice.kind, sizes_m);
  if (lump.shell_thickness_m) {
    Status status = check_length("thickness", *lump.shell_thickness_m, shell_thickness_range_m);
    if (!status) return status.error();
  }
  const auto shape = stock_shape(lump.size);
  if (!shape) return shape.error();
  ShapeFit fit;
  fit.tolerance_m = std::min(tolerance_m, 10.0 * default_tolerance_m(shape.value()));
  auto fitted = fit_shape(shape.value(), fit);
  if (!fitted) return fitted.error();
  return starting_document(lower_case(kinds()[choice.kind].name), std::move(fitted->surface), material,
                           lump.shell_thickness_m);
}

}  // namespace spoonbill
