#include "engine/exchange/scene_json.h"

#include "engine/exchange/field_json.h"
#include "engine/exchange/length.h"

namespace spoonbill {

Json position_to_json(const Vector3& position_m) {
  return Json::array(
      {length_to_json(position_m.x()), length_to_json(position_m.y()), length_to_json(position_m.z())});
}

namespace {

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
  if (reader.has("feature_map")) {
    FieldReader map = reader.inner("feature_map");
    lattice.feature_map = read_fields<FeatureMapSettings>(map);
    map.finish();
  }
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
  if (lattice.feature_map) add_fields(*lattice.feature_map, json["feature_map"]);
}

}  // namespace spoonbill
