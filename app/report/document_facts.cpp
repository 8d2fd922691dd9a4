#include "app/report/document_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/scene_json.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {

std::string kind_text(const Body& body) {
  return body_kind_names[static_cast<std::size_t>(body.kind)] +
         std::string(body.hand ? ", held by a hand" : "");
}

namespace {

// Numbers of sample points per direction. A trimmed surface gets fewer, because cutting cells along trim
// loops is slow and the vertices of the loops are samples too.
constexpr int extent_samples = 201, trimmed_extent_samples = 61;

Box extent_within(const Surface& surface, const Grid& grid, const TrimmedArea& area) {
  const TrimmedGrid trimmed = trim_grid(grid.u, grid.v, area);
  const auto columns = static_cast<std::size_t>(grid.columns());
  const std::size_t count = grid.u.parameters.size() * columns;
  std::vector<bool> kept(count, false);
  for (const auto& triangle : trimmed.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (vertex < count) kept[vertex] = true;
    }
  }
  Box box;
  for (std::size_t s = 0; s < count; ++s) {
    if (!kept[s]) continue;
    box.include(position(surface, grid.u.parameters[s / columns], grid.v.parameters[s % columns]));
  }
  for (const CutVertex& cut : trimmed.vertices) box.include(position(surface, cut.u, cut.v));
  return box;
}

std::string net_text(const Surface& surface) {
  return "degrees " + std::to_string(surface.u.degree()) + " and " + std::to_string(surface.v.degree()) +
         ", " + std::to_string(surface.net.rows) + "x" + std::to_string(surface.net.columns) +
         " control points";
}

Json short_direction_json(const KnotVector& knots) {
  return {{"degree", knots.degree()},
          {"control_points", knots.control_point_count()},
          {"periodic", knots.is_periodic()}};
}

Json direction_json(const KnotVector& knots) {
  return {{"degree", knots.degree()},
          {"control_points", knots.control_point_count()},
          {"periodic", knots.is_periodic()},
          {"knots", knots.knots().size()},
          {"spans", knots.breakpoints().size() - 1},
          {"domain", {knots.domain_start(), knots.domain_end()}}};
}

// Returns the parameter with six digits, which are enough for people; the JSON has all of them.
std::string parameter_text(double parameter) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", parameter + 0.0);
  return text.data();
}

std::string direction_text(const KnotVector& knots) {
  return "degree " + std::to_string(knots.degree()) + ", " + std::to_string(knots.control_point_count()) +
         " control points, " + std::to_string(knots.breakpoints().size() - 1) + " spans, " +
         (knots.is_periodic() ? "periodic" : "open") + ", from " + parameter_text(knots.domain_start()) +
         " to " + parameter_text(knots.domain_end());
}

Json surface_json(const Surface& surface) {
  return {{"u", direction_json(surface.u)}, {"v", direction_json(surface.v)}};
}

std::string shell_text(const Body& body) {
  return body.shell_thickness_m ? ", a shell of " + length_text(*body.shell_thickness_m) : "";
}

std::string material_text(const Material& material) {
  return material.name + ": E " + modulus_text(material.youngs_modulus_pa) + ", Poisson " +
         number_text(material.poissons_ratio) + ", density " + density_text(material.density_kg_per_m3);
}

void add_trim_facts(FactSheet& facts, const Body& body, Json& json) {
  const auto trim = make_trimmed_area(body);
  if (!trim || !trim.value()) return;
  const double removed = 1.0 - remaining_area_fraction(body.surface, *trim.value());
  const std::string loops = body.trims.size() == 1 ? " loop" : " loops";
  facts.add("Trimmed",
            "by " + std::to_string(body.trims.size()) + loops + ", " + decimals_text(100.0 * removed, 1) +
                " % of the area removed",
            "", nullptr);
  json["trims"] = {{"loops", body.trims.size()}, {"area_share_away", removed}};
}

void add_region_facts(FactSheet& facts, const Body& body, Json& json) {
  if (body.regions.empty()) return;
  add_material_regions(body.regions, json);
  for (std::size_t r = 0; r < body.regions.size(); ++r) {
    const MaterialRegion& region = body.regions[r];
    facts.add("Region " + std::to_string(r + 1),
              region_extent_text(region.region) + ": " + region_material_text(region), "", nullptr);
  }
}

void add_mesh_facts(FactSheet& facts, const CleanMesh& mesh, Json& json) {
  const std::size_t triangles = mesh.mesh.triangles.size(), vertices = mesh.mesh.vertices_m.size();
  facts.add(
      "Mesh",
      count_text(triangles, "triangle", "triangles") + ", " + count_text(vertices, "vertex", "vertices"), "",
      nullptr);
  json["mesh"] = {{"triangles", triangles}, {"vertices", vertices}};
}

void add_shape_facts(FactSheet& facts, const Body& body, bool detailed, Json& json) {
  const Closing closing = find_closing(body.surface);
  json["closedness"] = name_of(closing.closedness);
  if (!detailed) return;
  facts.add("Along u", direction_text(body.surface.u), "", nullptr);
  facts.add("Along v", direction_text(body.surface.v), "", nullptr);
  facts.add("Surface", closing_text(closing), "", nullptr);
  add_trim_facts(facts, body, json);
}

// Adds the lines of a body and returns its JSON.
Json add_body_facts(FactSheet& facts, const std::string& label, const Body& body, const Vector3& size_m,
                    bool detailed) {
  Json json = {{"name", body.name}, {"size_mm", millimetres_json(size_m)}};
  json["material"] = material_to_json(body.material);
  if (body.shell_thickness_m) json["shell_thickness_m"] = *body.shell_thickness_m;
  std::string text = body.name + shell_text(body);
  if (label != "Body") text += ", " + size_text(size_m);
  if (!body.solid.empty()) {
    text += ", a face of \"" + body.solid + "\"";
    json["solid"] = body.solid;
  }
  facts.add(label, text, "", nullptr);
  if (body.mesh) {
    add_mesh_facts(facts, *body.mesh, json);
  } else {
    add_shape_facts(facts, body, detailed, json);
  }
  if (!detailed) return json;
  facts.add("Material", material_text(body.material), "", nullptr);
  add_region_facts(facts, body, json);
  if (!body.rim.empty())
    facts.add("Rim", "known, " + std::to_string(body.rim.size()) + " corners", "", nullptr);
  json["rim_corners"] = body.rim.size();
  return json;
}

// Adds the members of a single body to the top level of the JSON. The member "name" becomes "body" there,
// because "name" is the name of the document.
void add_single_body(FactSheet& facts, const Json& body) {
  for (const auto& [field, value] : body.items()) facts.add("", "", field == "name" ? "body" : field, value);
}

// Returns a text for the quality of the cells. The worst Jacobian is 1 for boxes and 0 for a cell that is
// about to fold over.
std::string quality_text(const CellQuality& quality) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "worst Jacobian %.2f, volumes vary by %.0f %%",
                quality.worst_jacobian, 100.0 * quality.volume_spread);
  return text.data();
}

Json quality_json(const CellQuality& quality) {
  return {{"worst_jacobian", quality.worst_jacobian}, {"volume_spread", quality.volume_spread}};
}

std::string three_text(const double (&values)[3], double scale, int decimals) {
  return decimals_text(scale * values[0], decimals) + " / " + decimals_text(scale * values[1], decimals) +
         " / " + decimals_text(scale * values[2], decimals);
}

// Adds a body without a lattice.
Json add_rigid_body(FactSheet& facts, const std::string& suffix, const Body& body,
                    const std::optional<BodyMass>& mass) {
  facts.add("Kind" + suffix, kind_text(body) + ": without a lattice", "", nullptr);
  if (mass) facts.add("Mass" + suffix, grams_text(mass->mass_kg()), "", nullptr);
  Json json = {{"kind", body_kind_names[static_cast<std::size_t>(body.kind)]}};
  if (mass) json["mass_kg"] = mass->mass_kg();
  return json;
}

Json add_simulated_body(FactSheet& facts, const std::string& suffix, const BodySnapshot& body,
                        const std::optional<BodyMass>& mass) {
  const LatticeSnapshot& lattice = body.lattice;
  const auto fixed = std::count(lattice.fixed.begin(), lattice.fixed.end(), std::uint8_t{1});
  facts.add("Lattice" + suffix,
            std::to_string(lattice.count[0]) + " x " + std::to_string(lattice.count[1]) + " x " +
                std::to_string(lattice.count[2]) + " nodes, " + std::to_string(fixed) + " of them fixed",
            "", nullptr);
  if (mass) facts.add("Mass" + suffix, grams_text(mass->mass_kg()), "", nullptr);
  facts.add("Lattice mass" + suffix, grams_text(body.material.lattice_mass_kg), "", nullptr);
  const double inertia_scale = body.material.inertia_scale;
  facts.add("Responds" + suffix, slowness_text(inertia_scale), "", nullptr);
  const int implicit = body.material.implicit_nodes;
  facts.add(
      "Solver" + suffix,
      implicit > 0 ? "implicit, " + std::to_string(implicit) + " nodes of hexahedra" : "explicit springs", "",
      nullptr);
  const Json counts = {lattice.count[0], lattice.count[1], lattice.count[2]};
  Json json = {
      {"lattice", {{"nodes", counts}, {"node_count", lattice.x.size()}, {"fixed_node_count", fixed}}},
      {"lattice_mass_kg", body.material.lattice_mass_kg},
      {"inertia_scale", inertia_scale},
      {"responds_times_slower", std::sqrt(inertia_scale)},
      {"solver", {{"kind", implicit > 0 ? "implicit" : "explicit"}, {"implicit_nodes", implicit}}}};
  if (mass) json["mass_kg"] = mass->mass_kg();
  return json;
}

Json add_body_cells(FactSheet& facts, const std::string& suffix, const LatticeMesh& mesh,
                    const FeatureMapReport* map) {
  const CellQuality quality = measure_cell_quality(mesh);
  Json json = quality_json(quality);
  if (map) {
    json["before_feature_map"] = quality_json(map->before);
    json["feature_map_share"] = map->applied_fraction;
    facts.add("Cells before" + suffix, quality_text(map->before), "", nullptr);
  }
  facts.add((map ? "Cells mapped" : "Cells") + suffix, quality_text(quality), "", nullptr);
  return json;
}

struct FarthestPoint {
  double reach_m = -std::numeric_limits<double>::infinity();
  double u = 0.0, v = 0.0;

  // Takes over a farther point. Returns whether it is farther.
  bool offer(double at_m, double at_u, double at_v) {
    if (!(at_m > reach_m)) return false;
    *this = {at_m, at_u, at_v};
    return true;
  }
};

// Goes from a sample to the farthest point near it in a direction, by steps that halve.
void climb(const Surface& surface, const Vector3& direction, FarthestPoint& farthest) {
  constexpr int halvings = 24, most_steps = 400;
  double step_u = surface.u.domain_length() / extent_samples,
         step_v = surface.v.domain_length() / extent_samples;
  for (int k = 0, steps = 0; k < halvings && steps < most_steps; ++steps) {
    const FarthestPoint from = farthest;
    bool is_farther = false;
    for (const double to_u : {from.u - step_u, from.u, from.u + step_u}) {
      for (const double to_v : {from.v - step_v, from.v, from.v + step_v}) {
        const double u = surface.u.into_domain(to_u), v = surface.v.into_domain(to_v);
        is_farther |= farthest.offer(direction.dot(position(surface, u, v)), u, v);
      }
    }
    if (is_farther) continue;
    step_u *= 0.5;
    step_v *= 0.5;
    ++k;
  }
}

}  // namespace

Box extent_of(const Surface& surface, const std::vector<TrimLoop>& trims) {
  if (!trims.empty()) {
    const auto area = TrimmedArea::make(surface.u, surface.v, trims);
    const auto grid = make_grid(surface.u, surface.v, uniform_parameters(surface.u, trimmed_extent_samples),
                                uniform_parameters(surface.v, trimmed_extent_samples));
    if (area && grid) return extent_within(surface, grid.value(), area.value());
  }
  std::array<FarthestPoint, 3> low, high;
  const auto v_parameters = uniform_parameters(surface.v, extent_samples);
  for (const double u : uniform_parameters(surface.u, extent_samples)) {
    for (const double v : v_parameters) {
      const Vector3 point_m = position(surface, u, v);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at_m = point_m[static_cast<Eigen::Index>(axis)];
        low[axis].offer(-at_m, u, v);
        high[axis].offer(at_m, u, v);
      }
    }
  }
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    climb(surface, -Vector3::Unit(at), low[axis]);
    climb(surface, Vector3::Unit(at), high[axis]);
    box.low[at] = -low[axis].reach_m;
    box.high[at] = high[axis].reach_m;
  }
  return box;
}

void add_document_facts(FactSheet& facts, const Document& document) {
  const std::vector<Body>& bodies = document.scene.bodies;
  facts.add("Name", document.name, "name", document.name);
  facts.add("Unit", "mm (of the file's lengths)", "unit", "mm");
  std::vector<Box> extents;
  extents.reserve(bodies.size());
  for (const Body& body : bodies) {
    extents.push_back(body.mesh ? find_bounds(body) : extent_of(body.surface, body.trims));
  }
  Box all = extents.front();
  for (const Box& extent : extents) all = joined(all, extent);
  add_size_fact(facts, all);
  const bool alone = bodies.size() == 1;
  const bool detailed = bodies.size() <= static_cast<std::size_t>(sculpted_body_count_range.high);
  Json list = Json::array(), surfaces = Json::array();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string label = alone ? "Body" : "Body " + std::to_string(b + 1);
    list.push_back(add_body_facts(facts, label, bodies[b], extents[b].high - extents[b].low, detailed));
    surfaces.push_back(bodies[b].mesh ? Json() : surface_json(bodies[b].surface));
  }
  if (alone) add_single_body(facts, list.front());
  facts.add("", "", "bodies", list);
  facts.add("", "", "surfaces", surfaces);
  facts.add("Fixing planes", std::to_string(document.scene.planes.size()), "fixing_planes",
            document.scene.planes.size());
}

void add_size_fact(FactSheet& facts, const Box& extent) {
  const Vector3 size_m = extent.high - extent.low;
  facts.add("Size", size_text(size_m), "size_mm", millimetres_json(size_m));
}

void add_material_facts(FactSheet& facts, const Material& material) {
  facts.add("Material", material_text(material), "material", material_to_json(material));
}

// The distance between a trim loop and the edge in the CAD file is shown only from this limit on. Smaller
// distances are rounding errors of the file.
constexpr double shown_trim_deviation_m = 1e-9;

void add_surface_facts(FactSheet& facts, const std::vector<CadSurface>& surfaces) {
  if (surfaces.empty()) return;
  Json bodies = Json::array();
  Box all = extent_of(surfaces.front().surface, surfaces.front().trims);
  double deviation_m = 0.0, trim_deviation_m = 0.0;
  for (const CadSurface& part : surfaces) {
    const Box extent = extent_of(part.surface, part.trims);
    const Vector3 size = extent.high - extent.low;
    all = joined(all, extent);
    std::string text = size_text(size) + ", " + net_text(part.surface);
    if (!part.trims.empty()) text += ", trimmed by " + std::to_string(part.trims.size());
    if (part.trim_deviation_m >= shown_trim_deviation_m)
      text += ", ends within " + millimetres_with_digits(part.trim_deviation_m, 2) + " of its edges";
    if (part.deviation_m > 0.0)
      text += ", approximated within " + millimetres_with_digits(part.deviation_m, 2);
    const std::string number = surfaces.size() > 1 ? " " + std::to_string(bodies.size() + 1) : "";
    facts.add("Body" + number, part.name + ": " + text, "", nullptr);
    bodies.push_back({{"name", part.name},
                      {"size_mm", millimetres_json(size)},
                      {"u", short_direction_json(part.surface.u)},
                      {"v", short_direction_json(part.surface.v)},
                      {"deviation_m", part.deviation_m},
                      {"trim_deviation_m", part.trim_deviation_m},
                      {"trims", part.trims.size()},
                      {"trim_problem", part.trim_problem}});
    deviation_m = std::max(deviation_m, part.deviation_m);
    trim_deviation_m = std::max(trim_deviation_m, part.trim_deviation_m);
  }
  const Vector3 size = all.high - all.low;
  facts.add("Size", size_text(size), "size_mm", millimetres_json(size));
  facts.add("", "", "bodies", std::move(bodies));
  facts.add("", "", "deviation_m", deviation_m);
  if (trim_deviation_m >= shown_trim_deviation_m) {
    facts.add("Edges", "within " + millimetres_with_digits(trim_deviation_m, 2) + " of those in the file", "",
              nullptr);
  }
  facts.add("", "", "trim_deviation_m", trim_deviation_m);
}

void add_unit_facts(FactSheet& facts, const std::string& unit, bool declared) {
  facts.add("Unit read", declared ? unit : unit + " (not declared)", "unit_in", unit);
  facts.add("", "", "unit_declared", declared);
}

void add_cell_facts(FactSheet& facts, const Simulation& simulation,
                    const std::vector<FeatureMapReport>& maps) {
  const std::vector<Body>& bodies = simulation.scene().bodies;
  Json list = Json::array();
  std::size_t mapped = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].kind != BodyKind::deformable) continue;
    const bool has_map = bodies[b].lattice.feature_map && mapped < maps.size();
    const FeatureMapReport* map = has_map ? &maps[mapped++] : nullptr;
    const std::string suffix = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    list.push_back(add_body_cells(facts, suffix, simulation.lattice(static_cast<int>(b)).mesh(), map));
  }
  facts.add("", "", "cells", bodies.size() == 1 && !list.empty() ? list.front() : list);
}

void add_elasticity_facts(FactSheet& facts, const Simulation& simulation) {
  Json all = Json::array();
  const std::vector<Body>& bodies = simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].kind != BodyKind::deformable) continue;
    const LatticeReport& report = simulation.report(static_cast<int>(b));
    const std::string suffix = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    facts.add("Achieved E" + suffix, three_text(report.youngs_modulus_ratio, 100.0, 1) + " % along x, y, z",
              "", nullptr);
    facts.add(
        "Achieved Poisson" + suffix,
        three_text(report.poissons_ratio, 1.0, 3) + " of " + decimals_text(report.wanted_poissons_ratio, 3),
        "", nullptr);
    const double radius_m = simulation.smallest_contact_radius_m(static_cast<int>(b));
    facts.add("Contacts" + suffix, "resolved from a radius of " + short_length_text(radius_m), "", nullptr);
    all.push_back({{"body", bodies[b].name},
                   {"smallest_contact_radius_m", radius_m},
                   {"youngs_modulus_ratio", report.youngs_modulus_ratio},
                   {"poissons_ratio", report.poissons_ratio},
                   {"wanted_poissons_ratio", report.wanted_poissons_ratio}});
  }
  facts.add("", "", "achieved", all);
}

void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot, const std::vector<Body>& bodies) {
  Json list = Json::array();
  double mass_kg = 0.0, lattice_mass_kg = 0.0;
  bool is_whole = true;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string suffix = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    const std::optional<BodyMass> mass = compute_body_mass(bodies[b]);
    list.push_back(bodies[b].kind != BodyKind::deformable
                       ? add_rigid_body(facts, suffix, bodies[b], mass)
                       : add_simulated_body(facts, suffix, snapshot.bodies[b], mass));
    is_whole = is_whole && mass;
    mass_kg += mass ? mass->mass_kg() : 0.0;
    lattice_mass_kg += snapshot.bodies[b].material.lattice_mass_kg;
  }
  if (bodies.size() == 1) add_single_body(facts, list.front());
  for (std::size_t b = 0; b < bodies.size(); ++b) list[b]["body"] = bodies[b].name;
  facts.add("", "", "simulated", list);
  const char* const label = bodies.size() == 1 ? "" : "Mass";
  if (is_whole) facts.add(label, grams_text(mass_kg) + " together", "mass_kg", mass_kg);
  facts.add("", "", "lattice_mass_kg", lattice_mass_kg);
  facts.add(
      "Real time",
      count_text(static_cast<std::size_t>(snapshot.real_time_substeps), "substep", "substeps") + " a tick",
      "real_time_substeps", snapshot.real_time_substeps);
}

MapProgress::MapProgress(Console& console, bool is_forced)
    : bar_(console, "Distributing lattice nodes", is_forced) {}

FeatureMapWatch MapProgress::watch() {
  return {Progress([this](double fraction) {
            bar_.show(fraction);
            return true;
          }),
          [this](const FeatureMapReport& report) { reports_.push_back(report); }};
}

}  // namespace spoonbill
