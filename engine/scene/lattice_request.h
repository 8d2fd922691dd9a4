// How a body's lattice is made: how many nodes it gets and how those inside are spread. Plain data.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Points of the body are drawn at random; the node nearest to one, and its neighbours in the grid less and
// less, move towards it: w += rate * exp(-d^2 / 2 s^2) (x - w), d in steps of the grid. Rate and s shrink
// geometrically from their first to their last value (Kohonen 1990). Below about one step, neighbours no
// longer follow, and the map can get stuck folded (Erwin et al. 1992).
struct FeatureMapSettings {
  int draws_per_node = 500;  // of the nodes inside
  double first_rate = 0.1, last_rate = 0.01;
  double first_neighbourhood = 2.0, last_neighbourhood = 1.0;  // s, in steps of the grid
  std::uint32_t seed = 1;
  friend bool operator==(const FeatureMapSettings&, const FeatureMapSettings&) = default;
};

inline constexpr Range<int> draws_per_node_range{1, 10000};
inline constexpr Range<int> map_seed_range{0, 1000000000};
inline constexpr Range<double> map_rate_range{1e-6, 1.0};
inline constexpr Range<double> map_neighbourhood_range{0.5, 64.0};

template <>
inline constexpr auto fields_of<FeatureMapSettings> = std::to_array<Field<FeatureMapSettings>>({
    whole_number_field("draws_per_node", &FeatureMapSettings::draws_per_node, draws_per_node_range),
    number_field("first_rate", &FeatureMapSettings::first_rate, map_rate_range),
    number_field("last_rate", &FeatureMapSettings::last_rate, map_rate_range),
    number_field("first_neighbourhood", &FeatureMapSettings::first_neighbourhood, map_neighbourhood_range),
    number_field("last_neighbourhood", &FeatureMapSettings::last_neighbourhood, map_neighbourhood_range),
    whole_number_field("seed", &FeatureMapSettings::seed, map_seed_range),
});

// How many nodes a body gets across (first, second) and along (third) itself, or along x, y and z where it
// is made of triangles or lies in a box of cells (solid_lattice.h), or along u, through and along v of a
// shell (around, through and along of one that closes, the first node around counted again as the last):
// given, or counted out so that cells are near-cubic and at most `node_budget` nodes are spent.
struct LatticeRequest {
  int node_budget = 2000;
  std::optional<std::array<int, 3>> counts;  // each at least 2
  // Of bodies that are tubes: how the nodes inside are spread once the transfinite ones are there; not at all
  // without it.
  std::optional<FeatureMapSettings> feature_map = {};
};

inline constexpr Range<int> node_budget_range{50, 40000};
inline constexpr Range<int> node_count_range{2, 64};  // in each direction

// Each names the field, the value and the range of the first thing that is not within it.
Status check_feature_map(const FeatureMapSettings& settings);
Status check_lattice_request(const LatticeRequest& lattice);

}  // namespace spoonbill
