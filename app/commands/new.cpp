#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/report/document_facts.h"
#include "app/report/quantity_text.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/collision/surfaces/surface_self_collider.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/mass_properties.h"
#include "engine/material/lattice/shell_lattice.h"
#include "engine/scene/scene.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/lathe.h"
#include "engine/shapes/stock_shapes.h"
#include "engine/shapes/swept_shapes.h"

namespace spoonbill {
namespace {

constexpr Range<int> new_control_range{4, sculpted_control_point_count_range.high};
constexpr Range<double> new_tolerance_range_m{1e-8, 1e-2};
// Range that the parser allows for all sizes. Each shape checks a narrower range of its own.
constexpr Range<double> size_range_m{-1e3, 1e3};
constexpr double default_shell_thickness_m = 0.002;
// Fraction of the progress bar that the fit takes; the search for self-intersections takes the rest.
constexpr double fit_fraction = 0.8;

struct NewShape {
  ExactShape shape;
  std::optional<double> shell_thickness_m = {};  // empty for a closed shape
  // Reach of the shape (Federer 1959); 0 if unknown. A fitted surface that is nearer to the shape than the
  // reach cannot touch itself, unless it folds.
  double reach_m = 0.0;
  int degree = 3;
  double requested_radius_m = 0.0;  // smallest radius that the sizes ask for; 0: none
};

// One subcommand of `spoonbill new`, and the function that makes its shape after parsing.
struct NewKind {
  OptionSet parser;
  std::function<Result<NewShape>()> make;
};

struct NewOptions {
  OutputOptions how;
  std::optional<Extent> control;
  std::optional<double> tolerance_m;
  std::string material = "modelling-clay", name;
  std::filesystem::path out;
  bool json = false;
};

// The value of a length option, filled by the parser.
using LengthOption = std::shared_ptr<std::optional<double>>;

LengthOption add_length(OptionSet parser, const std::string& name, const std::string& help) {
  auto length = std::make_shared<std::optional<double>>();
  add_parsed_option(
      parser, name, "LENGTH", [](const std::string& text) { return parse_length(text, size_range_m); },
      [length](double value) { *length = value; }, help);
  return length;
}

std::shared_ptr<std::vector<double>> add_size(OptionSet parser, std::size_t count, const std::string& help) {
  auto size = std::make_shared<std::vector<double>>();
  add_parsed_option(
      parser, "--size", count == 2 ? "XxZ" : "XxYxZ",
      [count](const std::string& text) { return parse_lengths(text, count, size_range_m); },
      [size](const std::vector<double>& lengths) { *size = lengths; }, help)
      .require();
  return size;
}

Result<NewShape> make_stock_shape(const StockShapeSize& size) {
  auto shape = stock_shape(size);
  if (!shape) return shape.error();
  return NewShape{std::move(shape).value(), {}, reach_m(size), stock_shape_degree(size), reach_m(size)};
}

NewKind add_sphere(OptionSet root) {
  const OptionSet parser = root.add_command("sphere", "Sphere with its poles at top and bottom");
  const LengthOption radius = add_length(parser, "--radius", "Radius; default: 30mm");
  return {parser, [radius] { return make_stock_shape(SphereSize{radius->value_or(SphereSize().radius_m)}); }};
}

NewKind add_box(OptionSet root) {
  const OptionSet parser = root.add_command("box", "Box with rounded edges");
  const auto sides = add_size(parser, 3, "Lengths along x, y and z, such as 60x40x20mm");
  const LengthOption rounding = add_length(
      parser, "--rounding",
      "Radius of the edges around the two end faces, which are perpendicular to the longest side or, if they "
      "would then be slender, to the shortest side. The other four edges have twice the radius, at "
      "most half the shortest side. Default: a tenth of the shortest side; largest: two fifths of it");
  return {parser, [=] {
            BoxSize size{{(*sides)[0], (*sides)[1], (*sides)[2]}};
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return make_stock_shape(size);
          }};
}

NewKind add_cylinder(OptionSet root) {
  const OptionSet parser = root.add_command("cylinder", "Upright cylinder with rounded edges");
  const LengthOption radius = add_length(parser, "--radius", "Radius; default: 20mm");
  const LengthOption height = add_length(parser, "--height", "Height from face to face; default: 60mm");
  const LengthOption rounding =
      add_length(parser, "--rounding",
                 "Radius of both edges; default: a tenth of the smaller of diameter "
                 "and height; largest: half of it");
  return {parser, [=] {
            CylinderSize size;
            size.radius_m = radius->value_or(size.radius_m);
            size.height_m = height->value_or(size.height_m);
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return make_stock_shape(size);
          }};
}

NewKind add_cone(OptionSet root) {
  const OptionSet parser = root.add_command("cone", "Cone or truncated cone, rounded inside the sharp shape");
  const LengthOption radius = add_length(parser, "--radius", "Radius of the base; default: 30mm");
  const LengthOption height = add_length(parser, "--height", "Height to the sharp tip or top; default: 60mm");
  const LengthOption top = add_length(parser, "--top", "Radius of the top; default: 0mm, a tip");
  const LengthOption rounding = add_length(parser, "--rounding",
                                           "Radius of edges and tip; default: a tenth of the smallest of the "
                                           "cone's diameters and its height");
  return {parser, [=] {
            ConeSize size;
            size.radius_m = radius->value_or(size.radius_m);
            size.height_m = height->value_or(size.height_m);
            size.top_radius_m = top->value_or(0.0);
            size.rounding_m = rounding->value_or(default_rounding_m(size));
            return make_stock_shape(size);
          }};
}

NewKind add_plate(OptionSet root) {
  const OptionSet parser = root.add_command(
      "plate", "Level plate: a closed slab with a half-round rim, or an open sheet with a thickness");
  const auto sides = add_size(parser, 2, "Lengths along x and z, such as 100x60mm");
  const LengthOption thickness = add_length(parser, "--thickness", "Thickness; default: 3mm");
  const LengthOption corner =
      add_length(parser, "--corner",
                 "Radius of the four corners seen from above, at least the thickness; "
                 "default: a tenth of the width");
  auto sheet = std::make_shared<bool>(false);
  parser
      .add_flag("--sheet", *sheet,
                "Make an open surface; its body is a shell that extends down from it by --thickness")
      .exclude(parser.option("--corner"));
  return {parser, [=]() -> Result<NewShape> {
            PlateSize size{(*sides)[0], (*sides)[1]};
            size.thickness_m = thickness->value_or(size.thickness_m);
            size.corner_m = corner->value_or(default_corner_m(size));
            if (!*sheet) return make_stock_shape(size);
            if (Status status = check_length("thickness", size.thickness_m, shell_thickness_range_m);
                !status) {
              return status.error();
            }
            auto open = make_stock_shape(SheetSize{size.x_size_m, size.z_size_m});
            if (open) open->shell_thickness_m = size.thickness_m;
            return open;
          }};
}

NewKind add_torus(OptionSet root) {
  const OptionSet parser = root.add_command("torus", "Level ring, closed in both directions");
  const LengthOption ring = add_length(parser, "--ring", "Radius of the ring's centre line; default: 40mm");
  const LengthOption tube = add_length(parser, "--tube", "Radius of the tube; default: 10mm");
  return {parser, [=] {
            TorusSize size;
            size.ring_radius_m = ring->value_or(size.ring_radius_m);
            size.tube_radius_m = tube->value_or(size.tube_radius_m);
            return make_stock_shape(size);
          }};
}

NewKind add_bowl(OptionSet root) {
  const OptionSet parser =
      root.add_command("bowl", "Bowl of a spoon, with its back at -x and its front at +x");
  const LengthOption length = add_length(parser, "--length", "Outer length along x; default: 60mm");
  const LengthOption width =
      add_length(parser, "--width",
                 "Outer width along z, at least a quarter and at most 4 times the length; default: 42mm");
  const LengthOption depth =
      add_length(parser, "--depth",
                 "Depth of the inside below the highest point of the rim; default: 10mm, "
                 "at least a fiftieth and at most half of the shorter side");
  const LengthOption rim =
      add_length(parser, "--rim",
                 "Thickness of the round rim and of the wall; default: 1mm, at least a hundredth and at "
                 "most a tenth of the shorter side");
  const auto pitch = std::make_shared<double>(0.0);
  add_parsed_option(
      parser, "--pitch", "ANGLE",
      [](const std::string& text) { return parse_angle_deg(text, bowl_pitch_range_deg); },
      [pitch](double angle_deg) { *pitch = angle_deg; },
      "Angle by which the front is lifted, such as -10deg; default: 0, range: -60deg to 60deg");
  return {parser, [=] {
            BowlSize size;
            size.length_m = length->value_or(size.length_m);
            size.width_m = width->value_or(size.width_m);
            size.depth_m = depth->value_or(size.depth_m);
            size.rim_m = rim->value_or(size.rim_m);
            size.pitch_deg = *pitch;
            auto made = make_stock_shape(size);
            if (made) made->requested_radius_m = 0.0;  // no size asks for the radius of the rim's shoulders
            return made;
          }};
}

LengthOption add_shell_thickness(OptionSet parser) {
  return add_length(parser, "--thickness", "Thickness of the shell that an open shape becomes; default: 2mm");
}

// Makes an open shape a shell with the given or default thickness. Returns an error if a closed shape is
// given a thickness.
Result<NewShape> apply_thickness(ExactShape shape, const LengthOption& thickness) {
  const bool open = !shape.is_closed();
  if (!open && *thickness) {
    return Error{ErrorCode::inconsistent,
                 "--thickness applies to open shapes, and this one is closed; remove --thickness",
                 "--thickness"};
  }
  NewShape made{std::move(shape)};
  if (!open) return made;
  made.shell_thickness_m = thickness->value_or(default_shell_thickness_m);
  if (Status status = check_length("thickness", *made.shell_thickness_m, shell_thickness_range_m); !status) {
    return status.error();
  }
  return made;
}

// Reads the points of a path: a list of points, or the name of a CSV file.
Result<std::vector<Vector3>> read_path(const std::string& path) {
  if (path.find(';') != std::string::npos) return parse_points(path);
  const auto table = read_point_table(path, {"x", "y", "z"}, false);
  if (!table) return table.error();
  std::vector<Vector3> points;
  for (const auto& row : table->rows_m) points.emplace_back(row[0], row[1], row[2]);
  return points;
}

NewKind add_tube(OptionSet root) {
  const OptionSet parser = root.add_command("tube", "Tube along a line, with round ends");
  auto path = std::make_shared<std::string>();
  parser
      .add_option("--path", *path,
                  "Points on the centre line: a CSV file with the columns x_mm,y_mm,z_mm, or the points "
                  "themselves, such as '0,0,0;30,10,0;60,0,0mm'")
      .require()
      .show_as("FILE|POINTS");
  const LengthOption radius = add_length(parser, "--radius", "Radius of a round section; default: 5mm");
  const LengthOption width =
      add_length(parser, "--width", "Width of an elliptic section, horizontal at the start");
  const LengthOption height = add_length(parser, "--height", "Height of an elliptic section");
  const CommandOption round = parser.option("--radius"), wide = parser.option("--width"),
                      high = parser.option("--height");
  round.exclude(wide).exclude(high);
  wide.need(high);
  high.need(wide);
  return {parser, [=]() -> Result<NewShape> {
            const auto points = read_path(*path);
            if (!points) return points.error();
            auto centre_line = SmoothCurve::through(points.value(), false);
            if (!centre_line) return centre_line.error().in("--path");
            TubeSize size{std::move(centre_line).value()};
            size.half_width_m = *width ? 0.5 * **width : radius->value_or(size.half_width_m);
            size.half_height_m = *height ? 0.5 * **height : radius->value_or(size.half_height_m);
            auto shape = tube_shape(size);
            if (!shape) return shape.error();
            return NewShape{std::move(shape).value()};
          }};
}

NewKind add_lathe(OptionSet root) {
  const OptionSet parser = root.add_command("lathe", "Profile revolved about the vertical axis");
  auto profile = std::make_shared<std::string>();
  parser
      .add_option("--profile", *profile,
                  "CSV file with the columns radius_mm,height_mm: points on the profile. An end of radius 0 "
                  "closes the shape; a last point equal to the first makes a ring")
      .require()
      .show_as("FILE");
  const LengthOption thickness = add_shell_thickness(parser);
  return {parser, [=]() -> Result<NewShape> {
            const auto table = read_point_table(*profile, {"radius", "height"}, false);
            if (!table) return table.error();
            std::vector<MeridianPoint> points;
            for (const auto& row : table->rows_m) points.emplace_back(row[0], row[1]);
            auto shape = lathe_shape(points);
            if (!shape) return shape.error().in(*profile);
            return apply_thickness(std::move(shape).value(), thickness);
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
  const OptionSet parser = root.add_command("loft", "Surface through sections");
  auto file = std::make_shared<std::string>();
  parser
      .add_option(
          "--sections", *file,
          "CSV file with the columns section,x_mm,y_mm,z_mm: the points of each section in order, rows "
          "of the same section together. A first or last section of one point is a pole")
      .require()
      .show_as("FILE");
  const auto open = std::make_shared<bool>(false), no_caps = std::make_shared<bool>(false);
  CommandOption sheet = parser.add_flag("--open", *open, "Treat sections as lines, not rings: makes a sheet");
  CommandOption pipe = parser.add_flag("--no-caps", *no_caps, "Leave both ends open").exclude(sheet);
  const LengthOption cap = add_length(
      parser, "--cap", "Height of the bulge of both ends; default: half the mean radius of the end");
  parser.option("--cap").exclude(sheet).exclude(pipe);
  const LengthOption thickness = add_shell_thickness(parser);
  return {parser, [=]() -> Result<NewShape> {
            auto sections = read_sections(*file);
            if (!sections) return sections.error();
            LoftSections loft{std::move(sections).value(), !*open, *cap, !*no_caps};
            auto shape = loft_shape(std::move(loft));
            if (!shape) return shape.error().in(*file);
            return apply_thickness(std::move(shape).value(), thickness);
          }};
}

// Watches for Ctrl+C while a shape is made. The progress bar appears only after half a second, because most
// shapes take less time.
class ShapeJob {
 public:
  explicit ShapeJob(Console& console) : bar_(console, "Making", false) {}

  // Returns a Progress that refers to this object.
  Progress progress() {
    return Progress([this](double fraction) {
      constexpr std::chrono::milliseconds bar_delay{500};
      if (std::chrono::steady_clock::now() - start_ > bar_delay) bar_.show(fraction);
      stopped_ = stopped_ || interrupt_.requested();
      return !stopped_;
    });
  }
  bool stopped() const { return stopped_; }
  void answer() { interrupt_.answer(); }

 private:
  InterruptWatch interrupt_;
  ProgressBar bar_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool stopped_ = false;
};

// Returns an error if the surface intersects itself, as it may do for unsuitable centre lines and profiles.
Status check_self_intersection(const Surface& surface, bool closed, ShapeJob& job) {
  const auto grid = make_nested_grid(surface.u, surface.v, 0);
  if (!grid) return grid.error();
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = closed;
  query.progress = job.progress().part(fit_fraction, 1.0);
  const SelfResult result = collider.collide(surface, query);
  if (result.stopped || !result.touching) return {};
  if (collider.contacts().empty()) {
    return Error{ErrorCode::self_intersecting, "the shape passes through itself; make it thinner or wider"};
  }
  return Error{ErrorCode::self_intersecting,
               "the shape passes through itself near " + position_text(collider.contacts()[0].pair.first_m) +
                   "; make it thinner, or move the parts that meet there farther apart"};
}

void add_shape_facts(FactSheet& facts, const ExactShape& shape, const FittedShape& fitted,
                     double tolerance_m) {
  const int rows = fitted.surface.net.rows, columns = fitted.surface.net.columns;
  facts.add("Control points", std::to_string(rows) + " x " + std::to_string(columns), "control_points",
            {rows, columns});
  facts.add("Deviation", deviation_text(fitted.deviation_m), "deviation_m", fitted.deviation_m);
  facts.add("", "", "tolerance_m", tolerance_m);
  const EnclosedMass mass = compute_enclosed_mass(fitted.surface);
  const bool closed = shape.is_closed();
  facts.add("", "", "closed", closed);
  facts.add("Area", area_text(mass.area_m2), "area_m2", mass.area_m2);
  if (closed) facts.add("Volume", volume_text(mass.volume_m3), "volume_m3", mass.volume_m3);
}

// Adds the smallest radius of curvature of the surface and, for comparison, the radius `asked_m` that follows
// from the requested sizes. The fit's tolerance limits the deviation in position but not in curvature.
void add_radius_facts(FactSheet& facts, const Surface& surface, double asked_m) {
  const CurvatureRange range = find_curvature_range(surface);
  const double sharpest = range.exists ? std::max(std::abs(range.smallest.curvature_per_m),
                                                  std::abs(range.largest.curvature_per_m))
                                       : 0.0;
  constexpr double flat_per_m = 1e-3;
  if (!(sharpest > flat_per_m)) return;
  const bool is_asked = asked_m > 0.0 && std::isfinite(asked_m);
  facts.add(
      "Smallest radius",
      short_length_text(1.0 / sharpest) + (is_asked ? ", requested: " + short_length_text(asked_m) : ""),
      "smallest_radius_m", 1.0 / sharpest);
  if (is_asked) facts.add("", "", "asked_radius_m", asked_m);
}

Result<FittedShape> fit_new_shape(const NewOptions& options, const NewShape& made, ShapeFit fit,
                                  Console& console) {
  ShapeJob job(console);
  fit.progress = job.progress().part(0.0, fit_fraction);
  auto fitted = fit_shape(made.shape, fit);
  Status checked;
  const bool may_intersect = fitted && !(fitted->deviation_m < 0.5 * made.reach_m);
  if (may_intersect) checked = check_self_intersection(fitted->surface, made.shape.is_closed(), job);
  if (job.stopped()) {
    job.answer();
    return stopped_before_writing(options.out);
  }
  if (!checked) return checked.error();
  return fitted;
}

Status make_new(const NewOptions& options, const NewKind& kind, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  const auto material = shipped_material(options.material);
  if (!material) return material.error();
  auto made = kind.make();
  if (!made) return made.error();
  ShapeFit fit;
  const bool too_few =
      options.control && std::min(options.control->width, options.control->height) <= made->degree;
  fit.degree = too_few ? 3 : made->degree;
  fit.tolerance_m = options.tolerance_m.value_or(default_tolerance_m(made->shape));
  if (options.control) fit.control_counts = {{options.control->width, options.control->height}};
  auto fitted = fit_new_shape(options, made.value(), fit, console);
  if (!fitted) return fitted.error();
  const std::string name = options.name.empty() ? kind.parser.name() : options.name;
  Document document = starting_document(name, fitted->surface, material.value(), made->shell_thickness_m);
  document.scene.bodies.front().rim = made->shape.rim;
  if (!options.control) {
    if (Status suited = suit_net_to_tool(document.scene); !suited) return suited;
    fitted->surface = document.scene.bodies.front().surface;
  }
  if (Status written = write_document(document, options.out, options.how); !written) return written;

  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  facts.add("Kind", kind.parser.name(), "kind", kind.parser.name());
  add_size_fact(facts, extent_of(fitted->surface));
  add_shape_facts(facts, made->shape, fitted.value(), fit.tolerance_m);
  add_radius_facts(facts, fitted->surface, made->requested_radius_m);
  std::vector<std::string> notes;
  if (made->shape.is_closed() && made->shape.v.periodic) {
    notes.emplace_back("a ring is sculpted in a box of cells, because a lattice cannot follow its shape");
  }
  add_notes(facts, notes);
  facts.print(console.out, options.json);
  return {};
}

void add_shape_options(OptionSet parser, NewOptions& options) {
  add_parsed_option(
      parser, "--control", "UxV",
      [](const std::string& text) { return parse_extent(text, new_control_range, "24x24"); },
      [&options](const Extent& control) { options.control = control; },
      "Control points along u and v, each from " + std::to_string(new_control_range.low) + " to " +
          std::to_string(new_control_range.high) + "; default: as many as the tolerance and the tool need");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, new_tolerance_range_m); },
      [&options](double tolerance_m) { options.tolerance_m = tolerance_m; },
      "Largest distance from the exact shape; default: 0.01mm, less for shapes below 10mm, more for shapes "
      "above 1m in every direction; range: " +
          short_length_text(new_tolerance_range_m.low) + " to " +
          short_length_text(new_tolerance_range_m.high));
  parser.add_option("--material", options.material,
                    "Bundled material or a part of its name; default: modelling-clay");
  parser.add_option("--name", options.name, "Name of the body and the document; default: the kind of shape");
  add_force_option(parser, options.how);
  add_document_output(parser, options.out).require();
  add_json_option(parser, options.json);
}

}  // namespace

CommandEntry add_new(OptionSet root) {
  auto options = std::make_shared<NewOptions>();
  const OptionSet parser = root.add_command("new", "Make a shape to start from");
  parser.set_footer(
      "Each shape is one B-spline surface of real size, centred at the origin with y up, fitted to the "
      "exact\n"
      "shape. `spoonbill new KIND --help` lists the sizes of a kind; each has a unit: mm, cm, m or in.\n"
      "Example: spoonbill new box --size 60x40x20mm --rounding 3mm --out box.json");
  parser.require_command();
  std::vector<NewKind> kinds = {add_sphere(parser), add_box(parser),   add_cylinder(parser), add_cone(parser),
                                add_plate(parser),  add_torus(parser), add_bowl(parser),     add_tube(parser),
                                add_lathe(parser),  add_loft(parser)};
  for (const NewKind& kind : kinds) add_shape_options(kind.parser, *options);
  return {parser, [options, kinds = std::move(kinds)](Console& console) {
            const auto chosen = std::find_if(kinds.begin(), kinds.end(),
                                             [](const NewKind& kind) { return kind.parser.is_chosen(); });
            return make_new(*options, *chosen, console);
          }};
}

}  // namespace spoonbill
