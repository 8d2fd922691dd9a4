// How finely a surface is cut for the screen: pieces for each polynomial span, in steps of a half or a third,
// so that the grid changes seldom. Every span's ends are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/simulation/snapshot.h"

namespace spoonbill {

struct SamplingLevel {
  // Pieces of each span between the breakpoints of a direction; empty before the first choice.
  std::vector<int> u_pieces;
  std::vector<int> v_pieces;

  friend bool operator==(const SamplingLevel&, const SamplingLevel&) = default;
};

// The same number of pieces in every span.
SamplingLevel uniform_sampling_level(const SurfaceSnapshot& surface, int pieces);

struct SamplingTarget {
  double longest_edge_px = 48.0;
  double largest_sagitta_px = 0.3;  // between a chord and its arc: near what four samples can show
};

// Of one surface: near by, all of a large one would be cut finely, the part behind the camera too.
inline constexpr std::int64_t sampling_cell_limit = 1'000'000;

// The level at which no edge is longer and no chord farther from the surface than the target allows, judged
// by the control points of the derivatives. `previous` is kept, span by span, while it is neither too coarse
// nor more than about twice too fine, so that a slowly changing shape does not flicker between levels.
// Coarser where more cells than the limit would be asked for. The net must fit the knots.
SamplingLevel choose_sampling_level(const SurfaceSnapshot& surface, double pixels_per_metre,
                                    const SamplingLevel& previous, const SamplingTarget& target = {});

// The parameters of a direction, aligned with the knots; a periodic direction's seam appears once. `pieces`
// has one entry a span.
std::vector<double> drawing_parameters(const KnotVector& knots, const std::vector<int>& pieces);

}  // namespace spoonbill
