#include "engine/scene/lattice_request.h"

#include <string>

namespace spoonbill {

Status check_feature_map(const FeatureMapSettings& settings) {
  return check_fields("feature_map: ", settings);
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
