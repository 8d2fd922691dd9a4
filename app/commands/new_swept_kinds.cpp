#include <memory>
#include <string>
#include <utility>

#include "app/commands/new_kinds.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/start/point_table.h"
#include "engine/material/lattice/shell_lattice.h"
#include "engine/scene/scene.h"
#include "engine/shapes/lathe.h"
#include "engine/shapes/swept_shapes.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {
namespace {

Length add_thickness(OptionSet parser) {
  return add_length(parser, "--thickness", "Of the shell that an open shape is; 2mm unless told");
}

// An open shape is a shell; a closed one has no use for a thickness.
Result<NewShape> with_thickness(ExactShape shape, const Length& thickness) {
  constexpr double usual_m = 0.002;
  const bool open = !shape.is_closed();
  if (!open && *thickness) return Error{"--thickness is of an open shape, and this one is closed"};
  NewShape made{std::move(shape)};
  if (!open) return made;
  made.shell_thickness_m = thickness->value_or(usual_m);
  if (Status status = check_length("thickness", *made.shell_thickness_m, shell_thickness_range_m); !status) {
    return status.error();
  }
  return made;
}

Result<std::vector<Vector3>> read_path(const std::string& path) {
  if (path.find(';') != std::string::npos) return parse_points(path);
  const auto table = read_point_table(path, {"x", "y", "z"}, false);
  if (!table) return table.error();
  std::vector<Vector3> points;
  for (const auto& row : table->rows_m) points.emplace_back(row[0], row[1], row[2]);
  return points;
}

NewKind add_tube(OptionSet root) {
  const OptionSet parser = root.add_command("tube", "A tube along a line, with round ends");
  auto path = std::make_shared<std::string>();
  parser
      .add_option("--path", *path,
                  "The points that its middle line goes through: a CSV file with the columns "
                  "x_mm,y_mm,z_mm, or the points themselves, like '0,0,0;30,10,0;60,0,0mm'")
      .require()
      .show_as("FILE|POINTS");
  const Length radius = add_length(parser, "--radius", "Of a round section; 5mm unless told");
  const Length width = add_length(parser, "--width", "Of an elliptic section, level at its start");
  const Length height = add_length(parser, "--height", "Of an elliptic section");
  const CommandOption round = parser.option("--radius"), wide = parser.option("--width"),
                      high = parser.option("--height");
  round.exclude(wide).exclude(high);
  wide.need(high);
  high.need(wide);
  return {parser, [=]() -> Result<NewShape> {
            const auto points = read_path(*path);
            if (!points) return points.error();
            auto middle = SmoothCurve::through(points.value(), false);
            if (!middle) return Error{"--path: " + middle.error().message};
            TubeSize size{std::move(middle).value()};
            size.half_width_m = *width ? 0.5 * **width : radius->value_or(size.half_width_m);
            size.half_height_m = *height ? 0.5 * **height : radius->value_or(size.half_height_m);
            auto shape = tube_shape(size);
            if (!shape) return shape.error();
            return NewShape{std::move(shape).value()};
          }};
}

NewKind add_lathe(OptionSet root) {
  const OptionSet parser = root.add_command("lathe", "A profile turned about the upright axis");
  auto profile = std::make_shared<std::string>();
  parser
      .add_option(
          "--profile", *profile,
          "A CSV file with the columns radius_mm,height_mm: the points that the profile goes through. "
          "An end of radius 0 closes the shape; a last point that is the first makes a ring")
      .require()
      .show_as("FILE");
  const Length thickness = add_thickness(parser);
  return {parser, [=]() -> Result<NewShape> {
            const auto table = read_point_table(*profile, {"radius", "height"}, false);
            if (!table) return table.error();
            std::vector<MeridianPoint> points;
            for (const auto& row : table->rows_m) points.emplace_back(row[0], row[1]);
            auto shape = lathe_shape(points);
            if (!shape) return Error{*profile + ": " + shape.error().message};
            return with_thickness(std::move(shape).value(), thickness);
          }};
}

Result<std::vector<std::vector<Vector3>>> read_sections(const std::string& file) {
  const auto table = read_point_table(file, {"x", "y", "z"}, true);
  if (!table) return table.error();
  std::vector<std::vector<Vector3>> sections;
  for (std::size_t k = 0; k < table->rows_m.size(); ++k) {
    if (k == 0 || table->sections[k] != table->sections[k - 1]) sections.emplace_back();
    const auto& row = table->rows_m[k];
    sections.back().emplace_back(row[0], row[1], row[2]);
  }
  return sections;
}

NewKind add_loft(OptionSet root) {
  const OptionSet parser = root.add_command("loft", "A surface through sections");
  auto file = std::make_shared<std::string>();
  parser
      .add_option("--sections", *file,
                  "A CSV file with the columns section,x_mm,y_mm,z_mm: the points of each section in their "
                  "order, rows with the same number together. A first or last section of one point is a pole")
      .require()
      .show_as("FILE");
  const auto open = std::make_shared<bool>(false), no_caps = std::make_shared<bool>(false);
  CommandOption sheet =
      parser.add_flag("--open", *open, "Sections are lines, not rings: the shape is a sheet");
  CommandOption pipe = parser.add_flag("--no-caps", *no_caps, "Leave both ends open").exclude(sheet);
  const Length cap = add_length(parser, "--cap",
                                "How far the ends bulge; half the mean radius of the ring there unless told");
  parser.option("--cap").exclude(sheet).exclude(pipe);
  const Length thickness = add_thickness(parser);
  return {parser, [=]() -> Result<NewShape> {
            auto sections = read_sections(*file);
            if (!sections) return sections.error();
            LoftSections loft{std::move(sections).value(), !*open, *cap, !*no_caps};
            auto shape = loft_shape(std::move(loft));
            if (!shape) return Error{*file + ": " + shape.error().message};
            return with_thickness(std::move(shape).value(), thickness);
          }};
}

}  // namespace

std::vector<NewKind> add_swept_kinds(OptionSet parser) {
  return {add_tube(parser), add_lathe(parser), add_loft(parser)};
}

}  // namespace spoonbill
