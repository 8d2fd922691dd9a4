// Choice of the samples of a skin that bear contacts with other bodies.
#pragma once

#include <array>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Contacts act on the samples of a soft body's skin. Between samples farther apart than half a cell of its
// lattice, the skin sinks into what bears it. Samples nearer to each other than a third of a cell act on the
// same nodes and only take time.
inline constexpr double longest_sample_spacing_cells = 0.5, least_sample_spacing_cells = 0.35;

// Returns the largest distance of neighbouring samples, m.
double find_largest_spacing_m(const Surface& surface, const Grid& grid);

// Skips samples nearer than `least_m`, which is positive, to others, but none that is in both an even row and
// an even column. Compares only samples up to three rows and columns apart.
SkippedSamples find_crowded_samples(const Surface& surface, const Grid& grid, double least_m);

// Skips the samples of a rigid body where it is so blunt that the samples of a soft body, which are at most
// `spacing_m` apart, bear it alone: where no normal of the samples around deviates outward by more than 0.02
// rad along this way. Between its samples, the soft body then lies at most 0.0025 of this way deeper in the
// rigid one (a chord of length s lies s^2 / 8r below a circle of radius r). Edges and creases are not blunt,
// and a shell is only where both of its faces are. Rows and columns at an open end are skipped nowhere.
SkippedSamples find_blunt_samples(const Surface& surface, const Grid& grid, double spacing_m, bool is_shell);

// Returns the indices before and after `index` among `count` parameters; at the end of an open direction,
// `index` itself. In a closed direction, the last parameter coincides with the first.
std::array<int, 2> find_neighbours(int index, int count, bool is_closed);

}  // namespace spoonbill
