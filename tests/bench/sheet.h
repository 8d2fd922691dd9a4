// The surfaces that the benchmarks evaluate and refit: wavy bicubic sheets, about 1 x 1 m.
#pragma once

#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Returns a clamped, uniform sheet with side x side control points.
Surface wavy_sheet(int side);

// Returns a grid of samples x samples evenly spaced parameters, including both ends of each domain.
Grid sheet_grid(const Surface& sheet, int samples);

// Returns a blending matrix as a dense row-major table: a row per sample, a column per control point.
std::vector<float> dense_table(const BlendingMatrix& matrix);

// Converts the coordinates to single precision.
std::vector<float> in_single(const std::vector<double>& values);

}  // namespace spoonbill
