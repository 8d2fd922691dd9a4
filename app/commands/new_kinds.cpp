#include "app/commands/new_kinds.h"

#include <memory>
#include <string>

#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "engine/material/lattice/shell_lattice.h"
#include "engine/scene/scene.h"
#include "engine/shapes/stock_shapes.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {
namespace {

// Wider than any shape may be: those say themselves what they need.
constexpr Range<double> length_range_m{-1e3, 1e3};

std::shared_ptr<std::vector<double>> add_size(OptionSet parser, std::size_t count, const std::string& help) {
  auto size = std::make_shared<std::vector<double>>();
  add_parsed_option(
      parser, "--size", count == 2 ? "XxZ" : "XxYxZ",
      [count](const std::string& text) { return parse_lengths(text, count, length_range_m); },
      [size](const std::vector<double>& lengths) { *size = lengths; }, help)
      .require();
  return size;
}

Result<NewShape> new_shape(const StockShapeSize& size) {
  auto shape = stock_shape(size);
  if (!shape) return shape.error();
  return NewShape{std::move(shape).value(), {}, reach_m(size)};
}

NewKind add_sphere(OptionSet root) {
  const OptionSet parser = root.add_command("sphere", "A ball, its poles up and down");
  const Length radius = add_length(parser, "--radius", "Its radius; 30mm unless told");
  return {parser, [radius] { return new_shape(SphereSize{radius->value_or(SphereSize().radius_m)}); }};
}

NewKind add_box(OptionSet root) {
  const OptionSet parser = root.add_command("box", "A box with rounded edges");
  const auto sides = add_size(parser, 3, "Along x, y and z, like 60x40x20mm");
  const Length rounding =
      add_length(parser, "--rounding",
                 "Of the edges about its end faces, those of its longest side unless they are slender; the "
                 "four edges between have twice that. A tenth of the shortest side unless told, at most two "
                 "fifths of it");
  return {parser, [=] {
            BoxSize size{{(*sides)[0], (*sides)[1], (*sides)[2]}};
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return new_shape(size);
          }};
}

NewKind add_cylinder(OptionSet root) {
  const OptionSet parser = root.add_command("cylinder", "A cylinder with rounded edges, upright");
  const Length radius = add_length(parser, "--radius", "Its radius; 20mm unless told");
  const Length height = add_length(parser, "--height", "From face to face; 60mm unless told");
  const Length rounding = add_length(parser, "--rounding",
                                     "Of both edges: a tenth of the shorter of diameter and height unless "
                                     "told, at most half of it");
  return {parser, [=] {
            CylinderSize size;
            size.radius_m = radius->value_or(size.radius_m);
            size.height_m = height->value_or(size.height_m);
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return new_shape(size);
          }};
}

NewKind add_cone(OptionSet root) {
  const OptionSet parser = root.add_command("cone", "A cone, or a part of one, rounded within the sharp one");
  const Length radius = add_length(parser, "--radius", "Of its base; 30mm unless told");
  const Length height = add_length(parser, "--height", "To the sharp tip or the top; 60mm unless told");
  const Length top = add_length(parser, "--top", "The radius of its top; none unless told: a tip");
  const Length rounding = add_length(parser, "--rounding",
                                     "Of edges and tip; a tenth of the shortest of its diameters and its "
                                     "height unless told");
  return {parser, [=] {
            ConeSize size;
            size.radius_m = radius->value_or(size.radius_m);
            size.height_m = height->value_or(size.height_m);
            size.top_radius_m = top->value_or(0.0);
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return new_shape(size);
          }};
}

NewKind add_plate(OptionSet root) {
  const OptionSet parser = root.add_command(
      "plate", "A level plate: a closed slab with a half round rim, or an open sheet with a thickness");
  const auto sides = add_size(parser, 2, "Along x and z, like 100x60mm");
  const Length thickness = add_length(parser, "--thickness", "3mm unless told");
  const Length corner = add_length(parser, "--corner",
                                   "The radius of its four corners, seen from above, at least the thickness; "
                                   "a tenth of its width unless told");
  auto sheet = std::make_shared<bool>(false);
  parser.add_flag("--sheet", *sheet, "An open surface, whose body is a shell of the thickness below it")
      .exclude(parser.option("--corner"));
  return {parser, [=]() -> Result<NewShape> {
            PlateSize size{(*sides)[0], (*sides)[1]};
            size.thickness_m = thickness->value_or(size.thickness_m);
            size.corner_m = corner->value_or(default_corner_m(size));
            if (!*sheet) return new_shape(size);
            if (Status status = check_length("thickness", size.thickness_m, shell_thickness_range_m);
                !status) {
              return status.error();
            }
            auto open = new_shape(SheetSize{size.x_size_m, size.z_size_m});
            if (open) open->shell_thickness_m = size.thickness_m;
            return open;
          }};
}

NewKind add_torus(OptionSet root) {
  const OptionSet parser = root.add_command("torus", "A ring, lying level, closed both ways");
  const Length ring = add_length(parser, "--ring", "The radius of the ring's middle line; 40mm unless told");
  const Length tube = add_length(parser, "--tube", "The radius of its tube; 10mm unless told");
  return {parser, [=] {
            TorusSize size;
            size.ring_radius_m = ring->value_or(size.ring_radius_m);
            size.tube_radius_m = tube->value_or(size.tube_radius_m);
            return new_shape(size);
          }};
}

}  // namespace

Length add_length(OptionSet parser, const std::string& name, const std::string& help) {
  auto length = std::make_shared<std::optional<double>>();
  add_parsed_option(
      parser, name, "LENGTH", [](const std::string& text) { return parse_length(text, length_range_m); },
      [length](double value) { *length = value; }, help);
  return length;
}

std::vector<NewKind> add_lump_kinds(OptionSet parser) {
  return {add_sphere(parser), add_box(parser),   add_cylinder(parser),
          add_cone(parser),   add_plate(parser), add_torus(parser)};
}

}  // namespace spoonbill
