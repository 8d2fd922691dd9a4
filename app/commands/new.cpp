#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/new_kinds.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "app/interrupt.h"
#include "app/report/document_facts.h"
#include "app/report/progress_bar.h"
#include "app/report/quantity_text.h"
#include "app/report/surface_extent.h"
#include "app/start/shipped_materials.h"
#include "app/start/starting_document.h"
#include "engine/base/text.h"
#include "engine/base/progress.h"
#include "engine/collision/surfaces/surface_self_collider.h"
#include "engine/inspection/mass_properties.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"

namespace spoonbill {
namespace {

constexpr Range<int> control_range{4, control_point_count_range.high};
constexpr Range<double> tolerance_range_m{1e-8, 1e-2};

struct NewOptions {
  std::optional<Extent> control;
  std::optional<double> tolerance_m;
  std::string material = "modelling-clay", name;
  std::filesystem::path out;
  bool json = false;
};

// Shapes are mostly made at once: a bar for those that keep a person waiting, and Ctrl+C is asked for.
class Making {
 public:
  explicit Making(Console& console) : bar_(console, "Making", false) {}

  // Refers to this.
  Progress progress() {
    return Progress([this](double fraction) {
      constexpr std::chrono::milliseconds patience{500};
      if (std::chrono::steady_clock::now() - start_ > patience) bar_.show(fraction);
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

// Of the work, where a shape is to be fitted and then looked at for where it meets itself.
constexpr double fit_share = 0.8;

// Lines and profiles may lead a shape through itself.
Status check_apart(const Surface& surface, bool closed, Making& making) {
  const auto grid = make_nested_grid(surface.u, surface.v, 0);
  if (!grid) return grid.error();
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = closed;
  query.progress = making.progress().part(fit_share, 1.0);
  const SelfResult result = collider.collide(surface, query);
  if (result.stopped || !result.touching) return {};
  if (collider.contacts().empty()) return Error{"the shape passes through itself; make it thinner or wider"};
  return Error{"the shape passes through itself near " + position_text(collider.contacts()[0].pair.first_m) +
               "; make it thinner or its line wider there"};
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

Result<FittedShape> fit_with_progress(const NewOptions& options, const NewShape& made, ShapeFit fit,
                                      Console& console) {
  Making making(console);
  fit.progress = making.progress().part(0.0, fit_share);
  auto fitted = fit_shape(made.shape, fit);
  Status apart;
  const bool may_meet = fitted && !(fitted->deviation_m < 0.5 * made.reach_m);
  if (may_meet) apart = check_apart(fitted->surface, made.shape.is_closed(), making);
  if (making.stopped()) {
    making.answer();
    return Error{"stopped; " + options.out.string() + " was not written"};
  }
  if (!apart) return apart.error();
  return fitted;
}

Status make_new(const NewOptions& options, const NewKind& kind, Console& console) {
  const auto material = shipped_material(options.material);
  if (!material) return material.error();
  auto made = kind.make();
  if (!made) return made.error();
  ShapeFit fit;
  fit.tolerance_m = options.tolerance_m.value_or(default_tolerance_m(made->shape));
  if (options.control) fit.control_counts = {{options.control->width, options.control->height}};
  auto fitted = fit_with_progress(options, made.value(), fit, console);
  if (!fitted) return fitted.error();
  const std::string name = options.name.empty() ? kind.parser.name() : options.name;
  const Document document =
      starting_document(name, fitted->surface, material.value(), made->shell_thickness_m);
  if (Status written = write_document(document, options.out); !written) return written;

  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  facts.add("Kind", kind.parser.name(), "kind", kind.parser.name());
  add_size_fact(facts, extent_of(fitted->surface));
  add_shape_facts(facts, made->shape, fitted.value(), fit.tolerance_m);
  std::vector<std::string> remarks;
  if (made->shape.is_closed() && made->shape.v.periodic) {
    remarks.emplace_back("a ring is sculpted in a box of cells: no lattice can be bent along it");
  }
  add_remarks(facts, remarks);
  facts.print(console.out, options.json);
  return {};
}

void add_fit_options(OptionSet parser, NewOptions& options) {
  add_parsed_option(
      parser, "--control", "UxV",
      [](const std::string& text) { return parse_extent(text, control_range, "24x24"); },
      [&options](const Extent& control) { options.control = control; },
      "So many control points along u and v; as many as the tolerance needs unless told");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, tolerance_range_m); },
      [&options](double tolerance_m) { options.tolerance_m = tolerance_m; },
      "How far the surface may be from the exact shape; 0.01mm unless told, less below 10mm, more of "
      "what is larger than 1m every way");
}

}  // namespace

CommandEntry add_new(OptionSet root) {
  auto options = std::make_shared<NewOptions>();
  const OptionSet parser = root.add_command("new", "Make a shape to start from");
  parser.set_footer(
      "Each shape is one B-spline surface of real size, about the origin, y up, fitted to the exact shape.\n"
      "`spoonbill new KIND --help` tells the sizes of a kind; each has a unit: mm, cm, m or in.\n"
      "Example: spoonbill new box --size 60x40x20mm --rounding 3mm --out box.json");
  parser.require_command();
  std::vector<NewKind> kinds = add_lump_kinds(parser);
  for (NewKind& kind : add_swept_kinds(parser)) kinds.push_back(std::move(kind));
  for (const NewKind& kind : kinds) {
    add_fit_options(kind.parser, *options);
    kind.parser.add_option("--material", options->material,
                           "One that comes with the program, or a part of its name; modelling-clay unless "
                           "told");
    kind.parser.add_option("--name", options->name, "Of the body and the document; its kind unless told");
    add_document_output(kind.parser, options->out).require();
    add_json_option(kind.parser, options->json);
  }
  return {parser, [options, kinds = std::move(kinds)](Console& console) {
            const auto chosen = std::find_if(kinds.begin(), kinds.end(),
                                             [](const NewKind& kind) { return kind.parser.is_chosen(); });
            return make_new(*options, *chosen, console);
          }};
}

}  // namespace spoonbill
