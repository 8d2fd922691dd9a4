#include "engine/exchange/scene_json.h"

#include "engine/exchange/length.h"

namespace spoonbill {

Json position_to_json(const Vector3& position_m) {
  return Json::array(
      {length_to_json(position_m.x()), length_to_json(position_m.y()), length_to_json(position_m.z())});
}

Json vector_to_json(const Vector3& vector) {
  return Json::array({number_to_json(vector.x()), number_to_json(vector.y()), number_to_json(vector.z())});
}

FixingPlane read_fixing_plane(FieldReader& reader) {
  FixingPlane plane;
  plane.point_m = reader.position_m("point_mm", position_range_m);
  plane.normal = reader.direction("normal");
  return plane;
}

void add_fixing_plane(const FixingPlane& plane, Json& json) {
  json["point_mm"] = position_to_json(plane.point_m);
  json["normal"] = vector_to_json(plane.normal);
}

Symmetry read_symmetry(FieldReader& reader) {
  Symmetry symmetry;
  symmetry.on = reader.boolean("on");
  symmetry.point_m = reader.position_m("point_mm", position_range_m);
  symmetry.normal = reader.direction("normal");
  return symmetry;
}

void add_symmetry(const Symmetry& symmetry, Json& json) {
  json["on"] = symmetry.on;
  json["point_mm"] = position_to_json(symmetry.point_m);
  json["normal"] = vector_to_json(symmetry.normal);
}

namespace {

FeatureMapSettings read_feature_map(FieldReader reader) {
  FeatureMapSettings settings;
  settings.draws_per_node = reader.integer("draws_per_node", draws_per_node_range);
  settings.first_rate = reader.number("first_rate", map_rate_range);
  settings.last_rate = reader.number("last_rate", map_rate_range);
  settings.first_neighbourhood = reader.number("first_neighbourhood", map_neighbourhood_range);
  settings.last_neighbourhood = reader.number("last_neighbourhood", map_neighbourhood_range);
  settings.seed = static_cast<std::uint32_t>(reader.integer("seed", map_seed_range));
  reader.finish();
  return settings;
}

Json feature_map_to_json(const FeatureMapSettings& settings) {
  return {{"draws_per_node", settings.draws_per_node},
          {"first_rate", number_to_json(settings.first_rate)},
          {"last_rate", number_to_json(settings.last_rate)},
          {"first_neighbourhood", number_to_json(settings.first_neighbourhood)},
          {"last_neighbourhood", number_to_json(settings.last_neighbourhood)},
          {"seed", settings.seed}};
}

void read_counts(FieldReader& reader, LatticeRequest& lattice) {
  const Range<double> range{static_cast<double>(node_count_range.low),
                            static_cast<double>(node_count_range.high)};
  const Vector3 nodes = reader.vector("nodes", range);
  lattice.counts = {static_cast<int>(nodes.x()), static_cast<int>(nodes.y()), static_cast<int>(nodes.z())};
  if (nodes != Vector3((*lattice.counts)[0], (*lattice.counts)[1], (*lattice.counts)[2])) {
    reader.refuse("nodes", "must be whole numbers");
  }
  if (nodes.prod() > node_budget_range.high) {
    reader.refuse("nodes", "must make at most " + std::to_string(node_budget_range.high) + " nodes together");
  }
}

}  // namespace

LatticeRequest read_lattice_request(FieldReader& reader) {
  LatticeRequest lattice;
  if (reader.has("nodes") == reader.has("node_budget")) {
    reader.refuse("must have either nodes or node_budget");
    return lattice;
  }
  if (reader.has("feature_map")) lattice.feature_map = read_feature_map(reader.inner("feature_map"));
  if (reader.has("node_budget")) {
    lattice.node_budget = reader.integer("node_budget", node_budget_range);
  } else {
    read_counts(reader, lattice);
  }
  return lattice;
}

void add_lattice_request(const LatticeRequest& lattice, Json& json) {
  if (lattice.counts) {
    json["nodes"] = *lattice.counts;
  } else {
    json["node_budget"] = lattice.node_budget;
  }
  if (lattice.feature_map) json["feature_map"] = feature_map_to_json(*lattice.feature_map);
}

// Of a Voigt element a mode's loss factor is twice its damping ratio.
double read_damping_ratio(FieldReader& reader) {
  if (!reader.has("loss_factor")) return reader.number("damping_ratio", damping_ratio_range);
  if (reader.has("damping_ratio")) {
    reader.refuse("loss_factor", "says what damping_ratio says; leave one of them out");
    reader.ignore("damping_ratio");
  }
  return 0.5 * reader.number("loss_factor", {2.0 * damping_ratio_range.low, 2.0 * damping_ratio_range.high});
}

Material read_material_fields(FieldReader& reader) {
  Material material;
  material.name = reader.text("name");
  material.source = reader.text("source");
  material.youngs_modulus_pa = reader.number("youngs_modulus_pa", youngs_modulus_range_pa);
  material.poissons_ratio = reader.number("poissons_ratio", poissons_ratio_range);
  material.density_kg_per_m3 = reader.number("density_kg_per_m3", density_range_kg_per_m3);
  material.damping_ratio = read_damping_ratio(reader);
  material.plastic = reader.boolean("plastic");
  material.yield_strain = reader.number("yield_strain", yield_strain_range_of(material.plastic));
  material.flow_rate_per_s = reader.number("flow_rate_per_s", flow_rate_range_per_s);
  if (reader.has("hardening")) material.hardening = reader.number("hardening", hardening_range);
  if (reader.has("stiffening")) material.stiffening = reader.number("stiffening", stiffening_range);
  if (reader.has("friction")) material.friction = reader.number("friction", friction_range);
  if (reader.has("relaxing_share")) {
    material.relaxing_share = reader.number("relaxing_share", relaxing_share_range);
    material.relaxation_time_s = reader.number("relaxation_time_s", relaxation_time_range_s);
  }
  return material;
}

void add_material_fields(const Material& material, Json& json) {
  json["name"] = material.name;
  json["source"] = material.source;
  json["youngs_modulus_pa"] = number_to_json(material.youngs_modulus_pa);
  json["poissons_ratio"] = number_to_json(material.poissons_ratio);
  json["density_kg_per_m3"] = number_to_json(material.density_kg_per_m3);
  json["damping_ratio"] = number_to_json(material.damping_ratio);
  json["plastic"] = material.plastic;
  json["yield_strain"] = number_to_json(material.yield_strain);
  json["flow_rate_per_s"] = number_to_json(material.flow_rate_per_s);
  if (material.hardening != 0.0) json["hardening"] = number_to_json(material.hardening);
  if (material.stiffening != 0.0) json["stiffening"] = number_to_json(material.stiffening);
  if (material.friction != 0.0) json["friction"] = number_to_json(material.friction);
  if (material.relaxing_share == 0.0) return;
  json["relaxing_share"] = number_to_json(material.relaxing_share);
  json["relaxation_time_s"] = number_to_json(material.relaxation_time_s);
}

Sculpting read_sculpting(FieldReader& reader) {
  Sculpting sculpting;
  sculpting.damping_per_s = reader.number("damping_per_s", sculpting_damping_range_per_s);
  sculpting.gravity_m_per_s2 =
      reader.vector("gravity_m_per_s2", {-gravity_limit_m_per_s2, gravity_limit_m_per_s2});
  sculpting.force_scale = reader.number("force_scale", force_scale_range);
  if (reader.has("settles")) sculpting.settles = reader.boolean("settles");
  if (sculpting.gravity_m_per_s2.norm() > gravity_limit_m_per_s2) {
    reader.refuse("gravity_m_per_s2",
                  "must be no longer than " + std::to_string(static_cast<int>(gravity_limit_m_per_s2)));
  }
  return sculpting;
}

void add_sculpting(const Sculpting& sculpting, Json& json) {
  json["damping_per_s"] = number_to_json(sculpting.damping_per_s);
  json["gravity_m_per_s2"] = vector_to_json(sculpting.gravity_m_per_s2);
  json["force_scale"] = number_to_json(sculpting.force_scale);
  if (sculpting.settles) json["settles"] = true;
}

}  // namespace spoonbill
