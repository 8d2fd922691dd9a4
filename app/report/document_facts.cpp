#include "app/report/document_facts.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "app/report/closing_text.h"
#include "app/report/quantity_text.h"
#include "app/report/region_text.h"
#include "app/report/surface_extent.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_grid.h"
#include "engine/exchange/region_json.h"
#include "engine/number_text.h"

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

// Those after the first, which alone is told of at length.
void add_other_bodies(FactSheet& facts, const std::vector<Body>& bodies) {
  Json names = Json::array();
  for (const Body& body : bodies) names.push_back(body.name);
  facts.add("", "", "bodies", names);
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const Box extent = extent_of(bodies[b].surface);
    const KnotVector &u = bodies[b].surface.u, &v = bodies[b].surface.v;
    facts.add("Body " + std::to_string(b + 1),
              bodies[b].name + kind_text(bodies[b]) + ": " + size_text(extent.high - extent.low) +
                  ", degrees " + std::to_string(u.degree()) + " and " + std::to_string(v.degree()) + ", " +
                  std::to_string(u.control_point_count()) + " x " + std::to_string(v.control_point_count()) +
                  " control points",
              "", nullptr);
  }
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

std::string decimals_text(double value, int decimals) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string three_text(const double (&values)[3], double scale, int decimals) {
  return decimals_text(scale * values[0], decimals) + " / " + decimals_text(scale * values[1], decimals) +
         " / " + decimals_text(scale * values[2], decimals);
}

}  // namespace

void add_document_facts(FactSheet& facts, const Document& document) {
  const Body& body = document.scene.bodies[0];
  facts.add("Name", document.name, "name", document.name);
  facts.add("Unit", "mm (of the file's lengths)", "unit", "mm");
  add_size_fact(facts, body.surface);
  facts.add("Body", body.name + kind_text(body), "body", body.name);
  if (body.shell_thickness_m) facts.add("", "", "shell_thickness_m", *body.shell_thickness_m);
  facts.add("Along u", direction_text(body.surface.u), "", nullptr);
  facts.add("Along v", direction_text(body.surface.v), "", nullptr);
  Json surfaces = Json::array();
  for (const Body& one : document.scene.bodies) surfaces.push_back(surface_facts(one.surface));
  facts.add("", "", "surfaces", surfaces);
  const Closing closing = closing_of(body.surface);
  facts.add("Surface", closing_text(closing), "closedness", name_of(closing.closedness));
  add_trim_facts(facts, body);
  add_material_facts(facts, body.material);
  add_region_facts(facts, body);
  add_other_bodies(facts, document.scene.bodies);
  facts.add("Fixing planes", std::to_string(document.scene.planes.size()), "fixing_planes",
            document.scene.planes.size());
}

void add_trim_facts(FactSheet& facts, const Body& body) {
  const auto trim = trim_of(body);
  if (!trim || !trim.value()) return;
  const double away = 1.0 - kept_area_share(body.surface, *trim.value());
  const std::string loops = body.trims.size() == 1 ? " loop" : " loops";
  facts.add("Trimmed",
            "by " + std::to_string(body.trims.size()) + loops + ", " + decimals_text(100.0 * away, 1) +
                " % of the area away",
            "trims", {{"loops", body.trims.size()}, {"area_share_away", away}});
}

void add_size_fact(FactSheet& facts, const Surface& surface) {
  const Box extent = extent_of(surface);
  const Vector3 size = extent.high - extent.low;
  facts.add("Size", size_text(size), "size_mm", {1e3 * size.x(), 1e3 * size.y(), 1e3 * size.z()});
}

void add_material_facts(FactSheet& facts, const Material& material) {
  facts.add("Material",
            material.name + ": E " + modulus_text(material.youngs_modulus_pa) + ", Poisson " +
                number_text(material.poissons_ratio) + ", density " +
                density_text(material.density_kg_per_m3),
            "material", material_to_json(material));
}

void add_cell_facts(FactSheet& facts, const LatticeMesh& mesh, const std::optional<FeatureMapReport>& map) {
  const CellQuality quality = quality_of(mesh);
  Json json = quality_facts(quality);
  if (map) {
    json["before_feature_map"] = quality_facts(map->before);
    json["feature_map_share"] = map->share;
    facts.add("Cells before", quality_text(map->before), "", nullptr);
  }
  facts.add(map ? "Cells mapped" : "Cells", quality_text(quality), "cells", json);
}

void add_region_facts(FactSheet& facts, const Body& body) {
  if (body.regions.empty()) return;
  Json json;
  add_material_regions(body.regions, json);
  for (std::size_t r = 0; r < body.regions.size(); ++r) {
    const MaterialRegion& region = body.regions[r];
    facts.add("Region " + std::to_string(r + 1), place_text(region.region) + ": " + made_of_text(region), "",
              nullptr);
  }
  facts.add("", "", "regions", json["regions"]);
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

void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot) {
  const LatticeSnapshot& lattice = snapshot.bodies[0].lattice;
  const auto fixed = std::count(lattice.fixed.begin(), lattice.fixed.end(), std::uint8_t{1});
  const Json counts = {lattice.count[0], lattice.count[1], lattice.count[2]};
  facts.add("Lattice",
            std::to_string(lattice.count[0]) + " x " + std::to_string(lattice.count[1]) + " x " +
                std::to_string(lattice.count[2]) + " nodes, " + std::to_string(fixed) + " of them fixed",
            "lattice", {{"nodes", counts}, {"node_count", lattice.x.size()}, {"fixed_node_count", fixed}});
  facts.add("Mass", grams_text(snapshot.bodies[0].material.mass_kg) + " (the lattice's)", "mass_kg",
            snapshot.bodies[0].material.mass_kg);
  facts.add("Felt E", modulus_text(snapshot.bodies[0].material.felt_youngs_modulus_pa),
            "felt_youngs_modulus_pa", snapshot.bodies[0].material.felt_youngs_modulus_pa);
  const int implicit = snapshot.bodies[0].material.implicit_nodes;
  facts.add(
      "Solver",
      implicit > 0 ? "implicit, " + std::to_string(implicit) + " nodes of hexahedra" : "explicit springs",
      "solver", {{"kind", implicit > 0 ? "implicit" : "explicit"}, {"implicit_nodes", implicit}});
}

}  // namespace spoonbill
