#include "app/files/documents.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <system_error>
#include <utility>

#include "app/assets_folder.h"
#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"
#include "engine/bspline/halve_elements.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/file_format.h"
#include "engine/fitting/fit_scan.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {
namespace {

// Radius of the tool divided by the median of the body's extents along x, y and z. Such a tool is like a
// thumb on a piece of clay of the body's size.
constexpr double tool_fraction = 0.15;
// Force that the hand should feel when it presses the ball tool in by half of the ball's radius r. With a
// force scale of 1 the force is about E r^2 / 2, where E is Young's modulus (Hertz 1881).
constexpr double target_force_n = 1.5;
// Fraction of the body's extent that is fixed by the plane of a new document.
constexpr double fixed_fraction = 0.1;
// A body whose height is below this fraction of the median of its extents is fixed at its end along x, not at
// its foot.
constexpr double flat_fraction = 0.25;

constexpr double stock_shape_tolerance_m = 1e-4;

constexpr double thickest_shell_m = 2e-3;
constexpr double shell_thickness_fraction = 0.01;
constexpr int thickness_halvings = 6;

std::filesystem::path materials_folder() {
  return std::filesystem::path(assets_folder) / "materials";
}

FixingPlane foot_plane(const Box& box, double median_size_m) {
  const Vector3 size = box.extent();
  const int axis = size.y() > flat_fraction * median_size_m ? 1 : 0;
  FixingPlane plane;
  plane.point_m = box.centre();
  plane.point_m[axis] = box.low[axis] + fixed_fraction * size[axis];
  plane.normal = Vector3::Unit(axis);
  return plane;
}

// Rounds down to two significant digits, as a person would write the number.
double round_down(double number) {
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::floor(number / unit) * unit;
}

const std::array<StockShapeKind, 7>& all_stock_shapes() {
  static const std::array<StockShapeKind, 7> all = {{
      {"Sphere", {{"Radius", 30.0}}},
      {"Box", {{"Along x", 60.0}, {"Along y", 40.0}, {"Along z", 20.0}, {"Rounding", 3.0}}},
      {"Cylinder", {{"Radius", 20.0}, {"Height", 60.0}, {"Rounding", 3.0}}},
      {"Cone", {{"Radius", 30.0}, {"Height", 60.0}, {"Rounding", 4.0}}},
      {"Plate", {{"Along x", 100.0}, {"Along z", 60.0}, {"Thickness", 5.0}, {"Corners", 8.0}}},
      {"Sheet", {{"Along x", 100.0}, {"Along z", 60.0}, {"Thickness", 2.0}}},
      {"Bowl", {{"Length", 60.0}, {"Width", 42.0}, {"Depth", 10.0}, {"Rim", 2.0}}},
  }};
  return all;
}

struct SizedStockShape {
  StockShapeSize size;
  std::optional<double> shell_thickness_m = {};
};

// Returns the stock shape with the sizes `m`, which are in metres and in the order of the kind's fields.
SizedStockShape size_stock_shape(std::size_t kind, const std::vector<double>& m) {
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
    case 5:
      return {SheetSize{m[0], m[1]}, m[2]};
    case 6:
      return {BowlSize{m[0], m[1], m[2], m[3]}};
    default:
      SPOONBILL_ASSERT(!"a row of all_stock_shapes() without a case");
      return {SphereSize{m[0]}};
  }
}

std::string lower_case(std::string text) {
  for (char& letter : text) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return text;
}

// Tries several shell thicknesses. Returns the largest one with which a lattice can be made for the body, or
// the smallest one if none works.
double find_shell_thickness(Body body, double size_m) {
  double thickness = shell_thickness_range_m.low;
  for (int halving = 0; halving <= thickness_halvings; ++halving) {
    thickness =
        std::max(shell_thickness_range_m.low, std::min(thickest_shell_m, shell_thickness_fraction * size_m) /
                                                  static_cast<double>(1 << halving));
    body.shell_thickness_m = thickness;
    if (make_body_lattice(body)) break;
  }
  return thickness;
}

bool has_lattice_along(const Body& body) {
  return body.shell_thickness_m ? make_body_lattice(body).ok()
                                : tube_lattice(body.surface, body.lattice).ok();
}

// Sets the node budget, the largest number of nodes of the body's lattice. Tries the default, its half and so
// on, until a lattice can follow the shape of the body: cells of the default size may fold in the details of
// a scan. If no budget works, the default stays. The body then gets a box of cells, which a smaller budget
// would only make coarser.
void choose_node_budget(Body& body) {
  const int usual = body.lattice.node_budget;
  const int most = body.shell_thickness_m ? 16 : 4;
  for (int divisor = 1; divisor <= most; divisor *= 2) {
    body.lattice.node_budget = std::max(node_budget_range.low, usual / divisor);
    if (has_lattice_along(body)) return;
  }
  body.lattice.node_budget = usual;
}

std::optional<std::string> lattice_note(const Body& body) {
  const auto lattice = make_body_lattice(body);
  const std::string name = "body \"" + body.name + "\" ";
  if (!lattice) return name + "cannot be simulated: " + lattice.error().message;
  if (lattice->along.empty()) return std::nullopt;
  return name + "is sculpted in a box of cells, because a lattice that follows its shape would fold";
}

}  // namespace

Status check_native_name(const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  if (is_cad(format)) {
    return Error{ErrorCode::unsupported,
                 file.string() + ": is a CAD file; make a document of it with `spoonbill convert`"};
  }
  if (is_mesh(format) || is_cloud(format)) {
    return Error{ErrorCode::unsupported,
                 file.string() + ": is a mesh or a scan; fit a surface to it with `spoonbill fit`"};
  }
  return {};
}

Result<Document> read_document_file(const std::filesystem::path& file) {
  if (Status native = check_native_name(file); !native) return native.error();
  return read_document(file);
}

Status check_surfaces(const std::vector<Body>& bodies, const std::filesystem::path& file) {
  for (const Body& body : bodies) {
    if (!body.mesh) continue;
    return Error{
        ErrorCode::unsupported,
        file.string() + ": body \"" + body.name +
            "\": has a mesh, and this command works on surfaces; leave the body out, or fit a surface "
            "to its mesh with `spoonbill fit`",
        "mesh"};
  }
  return {};
}

Result<Document> make_mesh_document(const std::string& name, CleanMesh mesh, const Material& material) {
  if (Status checked = check_mesh(mesh); !checked) return checked.error();
  Document document;
  document.name = name;
  Body body;
  body.name = name;
  body.kind = BodyKind::fixed;
  body.material = material;
  body.mesh = std::make_shared<const CleanMesh>(std::move(mesh));
  document.scene.bodies.push_back(std::move(body));
  return document;
}

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
  std::vector<std::string> matches;
  std::string all;
  for (const std::string& known : names) {
    all += (all.empty() ? "" : ", ") + known;
    if (known == name) {
      matches = {known};
      break;
    }
    if (!name.empty() && known.find(name) != std::string::npos) matches.push_back(known);
  }
  if (matches.size() == 1) return read_material(materials_folder() / (matches[0] + ".json"));
  const std::string quoted = "'" + excerpt(name) + "' ";
  if (matches.empty()) {
    return Error{ErrorCode::unknown,
                 quoted + "is not a material that comes with the program; choose from " + all};
  }
  return Error{ErrorCode::unknown, quoted + "matches several materials; name one completely: " + all};
}

Document starting_document(const std::string& name, Surface surface, const Material& material,
                           std::optional<double> shell_thickness_m) {
  const Box box = bounding_box(surface.net);
  const Vector3 size = box.extent();
  // The median of the three extents is neither the length of a rod nor the thickness of a plate.
  const double median_m = size.sum() - size.maxCoeff() - size.minCoeff();
  Document document;
  document.name = name;
  Body body;
  body.name = name;
  body.surface = std::move(surface);
  body.material = material;
  body.shell_thickness_m = shell_thickness_m;
  Scene& scene = document.scene;
  scene.bodies.push_back(std::move(body));
  scene.planes.push_back(foot_plane(box, median_m));
  scene.tool.radius_m =
      std::clamp(round_down(tool_fraction * std::max(median_m, 1e-4)), 1e-5, tool_radius_range_m.high);
  scene.tool.reach = ToolReach::local;
  const double pressed_n = 0.5 * material.youngs_modulus_pa * scene.tool.radius_m * scene.tool.radius_m;
  scene.sculpting.force_scale =
      std::clamp(round_down(target_force_n / pressed_n), 1e-6, force_scale_range.high);
  return document;
}

Status suit_net_to_tool(Scene& scene) {
  Surface& surface = scene.bodies.front().surface;
  Result<Surface> suited = halve_long_elements(surface, scene.tool.radius_m, refined_control_point_limit,
                                               sculpted_control_point_count_range.high);
  if (!suited) return suited.error();
  surface = std::move(suited).value();
  return {};
}

std::span<const StockShapeKind> stock_shape_kinds() {
  return all_stock_shapes();
}

StockShapeChoice default_stock_shape(std::size_t kind) {
  StockShapeChoice choice{kind, {}};
  for (const StockShapeField& field : all_stock_shapes()[kind].fields) {
    choice.sizes_mm.push_back(field.default_mm);
  }
  return choice;
}

Result<Document> make_stock_shape_document(const StockShapeChoice& choice, const Material& material) {
  std::vector<double> sizes_m;
  for (const double size_mm : choice.sizes_mm) sizes_m.push_back(1e-3 * size_mm);
  const SizedStockShape sized = size_stock_shape(choice.kind, sizes_m);
  if (sized.shell_thickness_m) {
    Status status = check_length("thickness", *sized.shell_thickness_m, shell_thickness_range_m);
    if (!status) return status.error();
  }
  const auto shape = stock_shape(sized.size);
  if (!shape) return shape.error();
  ShapeFit fit;
  fit.degree = stock_shape_degree(sized.size);
  // A fifth of the reach keeps the two sides of a thin wall apart.
  fit.tolerance_m = std::min(
      {stock_shape_tolerance_m, 10.0 * default_tolerance_m(shape.value()), 0.2 * reach_m(sized.size)});
  auto fitted = fit_shape(shape.value(), fit);
  if (!fitted) return fitted.error();
  Document document = starting_document(lower_case(all_stock_shapes()[choice.kind].name),
                                        std::move(fitted->surface), material, sized.shell_thickness_m);
  document.scene.bodies.front().rim = shape->rim;
  if (Status suited = suit_net_to_tool(document.scene); !suited) return suited.error();
  return document;
}

Result<Document> make_cad_document(const CadModel& model, const std::string& name) {
  const auto most = static_cast<std::size_t>(body_count_range.high);
  if (model.surfaces.size() > most) {
    return Error{ErrorCode::too_many,
                 "has " + std::to_string(model.surfaces.size()) + " faces, and a document holds at most " +
                     std::to_string(most) + " bodies; choose some with --bodies 1,3-5",
                 "--bodies"};
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

Result<FittedDocument> make_fitted_document(const ScanFit& fit, const std::string& name,
                                            const Material& clay) {
  const auto most = static_cast<std::size_t>(body_count_range.high);
  if (fit.bodies.size() > most) {
    return Error{ErrorCode::too_many,
                 "has " + std::to_string(fit.bodies.size()) + " islands, and a document holds at most " +
                     std::to_string(most) + " bodies; use --islands largest",
                 "--islands"};
  }
  FittedDocument result;
  result.document = starting_document(name, fit.bodies.front().surface, clay);
  result.document.scene.bodies.clear();
  for (std::size_t b = 0; b < fit.bodies.size(); ++b) {
    const FittedBody& fitted = fit.bodies[b];
    Body body;
    body.name = fit.bodies.size() == 1 ? name : name + " " + std::to_string(b + 1);
    body.surface = fitted.surface;
    body.material = clay;
    if (fitted.kind != ShapeKind::closed) {
      body.shell_thickness_m = find_shell_thickness(body, fitted.size_m.norm());
    }
    choose_node_budget(body);
    if (auto note = lattice_note(body)) result.notes.push_back(std::move(*note));
    result.document.scene.bodies.push_back(std::move(body));
  }
  if (Status few = check_body_count(result.document.scene); !few) {
    result.notes.push_back(few.error().message);
  }
  return result;
}

}  // namespace spoonbill
