#include "engine/scene/lattice_request.h"

#include <string>

namespace spoonbill {

Status check_feature_map(const FeatureMapSettings& settings) {
  if (Status status =
          check_range("feature_map: draws_per_node", settings.draws_per_node, draws_per_node_range);
      !status.ok()) {
    return status;
  }
  const struct {
    const char* field;
    double value;
    Range<double> range;
  } checks[] = {{"feature_map: first_rate", settings.first_rate, map_rate_range},
                {"feature_map: last_rate", settings.last_rate, map_rate_range},
                {"feature_map: first_neighbourhood", settings.first_neighbourhood, map_neighbourhood_range},
                {"feature_map: last_neighbourhood", settings.last_neighbourhood, map_neighbourhood_range}};
  for (const auto& check : checks) {
    if (Status status = check_range(check.field, check.value, check.range); !status.ok()) return status;
  }
  return {};
}

Status check_lattice_request(const LatticeRequest& lattice) {
  if (lattice.feature_map) {
    if (Status status = check_feature_map(*lattice.feature_map); !status.ok()) {
      return Error{"lattice: " + status.error().message};
    }
  }
  if (!lattice.counts) return check_range("lattice: node_budget", lattice.node_budget, node_budget_range);
  int product = 1;
  for (std::size_t direction = 0; direction < 3; ++direction) {
    const int count = (*lattice.counts)[direction];
    const std::string name = "lattice: nodes[" + std::to_string(direction) + "]";
    if (Status status = check_range(name, count, node_count_range); !status.ok()) return status;
    product *= count;
  }
  if (product <= node_budget_range.high) return {};
  return Error{"lattice: nodes make " + std::to_string(product) + " nodes, must be at most " +
               std::to_string(node_budget_range.high)};
}

}  // namespace spoonbill
