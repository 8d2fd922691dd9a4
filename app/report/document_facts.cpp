#include "app/report/document_facts.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "app/report/closing_text.h"
#include "app/report/quantity_text.h"
#include "app/report/region_text.h"
#include "app/report/surface_extent.h"
#include "engine/base/text.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {
namespace {

Json direction_facts(const KnotVector& knots) {
  return {{"degree", knots.degree()},
          {"control_points", knots.control_point_count()},
          {"periodic", knots.is_periodic()},
          {"knots", knots.knots().size()},
          {"spans", knots.breakpoints().size() - 1},
          {"domain", {knots.domain_start(), knots.domain_end()}}};
}

// Short enough to read; the JSON has every digit.
std::string place_on(double parameter) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", parameter + 0.0);
  return text.data();
}

std::string direction_text(const KnotVector& knots) {
  return "degree " + std::to_string(knots.degree()) + ", " + std::to_string(knots.control_point_count()) +
         " control points, " + std::to_string(knots.breakpoints().size() - 1) + " spans, " +
         (knots.is_periodic() ? "periodic" : "open") + ", from " + place_on(knots.domain_start()) + " to " +
         place_on(knots.domain_end());
}

Json surface_facts(const Surface& surface) {
  return {{"u", direction_facts(surface.u)}, {"v", direction_facts(surface.v)}};
}

std::string kind_text(const Body& body) {
  return body.shell_thickness_m ? ", a shell of " + length_text(*body.shell_thickness_m) : "";
}

Json millimetres_of(const Vector3& size_m) {
  return {1e3 * size_m.x(), 1e3 * size_m.y(), 1e3 * size_m.z()};
}

std::string material_text(const Material& material) {
  return material.name + ": E " + modulus_text(material.youngs_modulus_pa) + ", Poisson " +
         number_text(material.poissons_ratio) + ", density " + density_text(material.density_kg_per_m3);
}

std::string decimals_text(double value, int decimals) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

void add_trim_facts(FactSheet& facts, const Body& body, Json& json) {
  const auto trim = make_trimmed_area(body);
  if (!trim || !trim.value()) return;
  const double away = 1.0 - remaining_area_fraction(body.surface, *trim.value());
  const std::string loops = body.trims.size() == 1 ? " loop" : " loops";
  facts.add("Trimmed",
            "by " + std::to_string(body.trims.size()) + loops + ", " + decimals_text(100.0 * away, 1) +
                " % of the area away",
            "", nullptr);
  json["trims"] = {{"loops", body.trims.size()}, {"area_share_away", away}};
}

void add_region_facts(FactSheet& facts, const Body& body, Json& json) {
  if (body.regions.empty()) return;
  add_material_regions(body.regions, json);
  for (std::size_t r = 0; r < body.regions.size(); ++r) {
    const MaterialRegion& region = body.regions[r];
    facts.add("Region " + std::to_string(r + 1), position_text(region.region) + ": " + made_of_text(region), "",
              nullptr);
  }
}

// Lines go to the sheet, the body's JSON is returned.
Json add_body_facts(FactSheet& facts, const std::string& label, const Body& body, const Vector3& size_m,
                    bool at_length) {
  const Closing closing = find_closing(body.surface);
  Json json = {{"name", body.name}, {"size_mm", millimetres_of(size_m)}};
  json["closedness"] = name_of(closing.closedness);
  json["material"] = material_to_json(body.material);
  if (body.shell_thickness_m) json["shell_thickness_m"] = *body.shell_thickness_m;
  std::string text = body.name + kind_text(body);
  if (label != "Body") text += ", " + size_text(size_m);
  if (!body.solid.empty()) {
    text += ", a face of \"" + body.solid + "\"";
    json["solid"] = body.solid;
  }
  facts.add(label, text, "", nullptr);
  if (!at_length) return json;
  facts.add("Along u", direction_text(body.surface.u), "", nullptr);
  facts.add("Along v", direction_text(body.surface.v), "", nullptr);
  facts.add("Surface", closing_text(closing), "", nullptr);
  add_trim_facts(facts, body, json);
  facts.add("Material", material_text(body.material), "", nullptr);
  add_region_facts(facts, body, json);
  return json;
}

// What is told of a body that is alone stands in the sheet itself too, where "name" is the document's.
void add_alone(FactSheet& facts, const Json& told) {
  for (const auto& [field, value] : told.items()) facts.add("", "", field == "name" ? "body" : field, value);
}

// 1 is a box, 0 a cell about to fold over.
std::string quality_text(const CellQuality& quality) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "worst Jacobian %.2f, volumes vary by %.0f %%",
                quality.worst_jacobian, 100.0 * quality.volume_spread);
  return text.data();
}

Json quality_facts(const CellQuality& quality) {
  return {{"worst_jacobian", quality.worst_jacobian}, {"volume_spread", quality.volume_spread}};
}

std::string three_text(const double (&values)[3], double scale, int decimals) {
  return decimals_text(scale * values[0], decimals) + " / " + decimals_text(scale * values[1], decimals) +
         " / " + decimals_text(scale * values[2], decimals);
}

Json add_simulated_body(FactSheet& facts, const std::string& of, const BodySnapshot& body) {
  const LatticeSnapshot& lattice = body.lattice;
  const auto fixed = std::count(lattice.fixed.begin(), lattice.fixed.end(), std::uint8_t{1});
  facts.add("Lattice" + of,
            std::to_string(lattice.count[0]) + " x " + std::to_string(lattice.count[1]) + " x " +
                std::to_string(lattice.count[2]) + " nodes, " + std::to_string(fixed) + " of them fixed",
            "", nullptr);
  facts.add("Mass" + of, grams_text(body.material.mass_kg) + " (the lattice's)", "", nullptr);
  facts.add("Felt E" + of, modulus_text(body.material.effective_youngs_modulus_pa), "", nullptr);
  const int implicit = body.material.implicit_nodes;
  facts.add(
      "Solver" + of,
      implicit > 0 ? "implicit, " + std::to_string(implicit) + " nodes of hexahedra" : "explicit springs", "",
      nullptr);
  const Json counts = {lattice.count[0], lattice.count[1], lattice.count[2]};
  return {{"lattice", {{"nodes", counts}, {"node_count", lattice.x.size()}, {"fixed_node_count", fixed}}},
          {"mass_kg", body.material.mass_kg},
          {"felt_youngs_modulus_pa", body.material.effective_youngs_modulus_pa},
          {"solver", {{"kind", implicit > 0 ? "implicit" : "explicit"}, {"implicit_nodes", implicit}}}};
}

Json add_cells_of(FactSheet& facts, const std::string& of, const LatticeMesh& mesh,
                  const FeatureMapReport* map) {
  const CellQuality quality = measure_cell_quality(mesh);
  Json json = quality_facts(quality);
  if (map) {
    json["before_feature_map"] = quality_facts(map->before);
    json["feature_map_share"] = map->applied_fraction;
    facts.add("Cells before" + of, quality_text(map->before), "", nullptr);
  }
  facts.add((map ? "Cells mapped" : "Cells") + of, quality_text(quality), "", nullptr);
  return json;
}

}  // namespace

void add_document_facts(FactSheet& facts, const Document& document) {
  const std::vector<Body>& bodies = document.scene.bodies;
  facts.add("Name", document.name, "name", document.name);
  facts.add("Unit", "mm (of the file's lengths)", "unit", "mm");
  std::vector<Box> extents;
  extents.reserve(bodies.size());
  for (const Body& body : bodies) extents.push_back(extent_of(body.surface, body.trims));
  Box all = extents.front();
  for (const Box& extent : extents) all = joined(all, extent);
  add_size_fact(facts, all);
  const bool alone = bodies.size() == 1;
  const bool at_length = bodies.size() <= static_cast<std::size_t>(sculpted_body_count_range.high);
  Json told = Json::array(), surfaces = Json::array();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string label = alone ? "Body" : "Body " + std::to_string(b + 1);
    told.push_back(add_body_facts(facts, label, bodies[b], extents[b].high - extents[b].low, at_length));
    surfaces.push_back(surface_facts(bodies[b].surface));
  }
  if (alone) add_alone(facts, told.front());
  facts.add("", "", "bodies", told);
  facts.add("", "", "surfaces", surfaces);
  facts.add("Fixing planes", std::to_string(document.scene.planes.size()), "fixing_planes",
            document.scene.planes.size());
}

void add_size_fact(FactSheet& facts, const Box& extent) {
  const Vector3 size_m = extent.high - extent.low;
  facts.add("Size", size_text(size_m), "size_mm", millimetres_of(size_m));
}

void add_material_facts(FactSheet& facts, const Material& material) {
  facts.add("Material", material_text(material), "material", material_to_json(material));
}

void add_cell_facts(FactSheet& facts, const Simulation& simulation,
                    const std::vector<FeatureMapReport>& maps) {
  const std::vector<Body>& bodies = simulation.scene().bodies;
  Json told = Json::array();
  std::size_t mapped = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool has_map = bodies[b].lattice.feature_map && mapped < maps.size();
    const FeatureMapReport* map = has_map ? &maps[mapped++] : nullptr;
    const std::string of = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    told.push_back(add_cells_of(facts, of, simulation.lattice(static_cast<int>(b)).mesh(), map));
  }
  facts.add("", "", "cells", bodies.size() == 1 ? told.front() : told);
}

void add_elasticity_facts(FactSheet& facts, const Simulation& simulation) {
  Json all = Json::array();
  const std::vector<Body>& bodies = simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const LatticeReport& report = simulation.report(static_cast<int>(b));
    const std::string of = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    facts.add("Achieved E" + of, three_text(report.youngs_modulus_ratio, 100.0, 1) + " % along x, y, z", "",
              nullptr);
    facts.add(
        "Achieved Poisson" + of,
        three_text(report.poissons_ratio, 1.0, 3) + " of " + decimals_text(report.wanted_poissons_ratio, 3),
        "", nullptr);
    all.push_back({{"body", bodies[b].name},
                   {"youngs_modulus_ratio", report.youngs_modulus_ratio},
                   {"poissons_ratio", report.poissons_ratio},
                   {"wanted_poissons_ratio", report.wanted_poissons_ratio}});
  }
  facts.add("", "", "achieved", all);
}

void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot, const std::vector<Body>& bodies) {
  Json told = Json::array();
  double mass_kg = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string of = bodies.size() == 1 ? "" : " of " + bodies[b].name;
    told.push_back(add_simulated_body(facts, of, snapshot.bodies[b]));
    mass_kg += snapshot.bodies[b].material.mass_kg;
  }
  if (bodies.size() == 1) add_alone(facts, told.front());
  for (std::size_t b = 0; b < bodies.size(); ++b) told[b]["body"] = bodies[b].name;
  facts.add("", "", "simulated", told);
  facts.add(bodies.size() == 1 ? "" : "Mass", grams_text(mass_kg) + " together", "mass_kg", mass_kg);
}

}  // namespace spoonbill
