// The surfaces that the benchmarks evaluate and refit: wavy bicubic sheets, about 1 x 1 m.
#pragma once

#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Clamped, uniform, side x side control points.
Surface wavy_sheet(int side);

// samples x samples parameters, evenly spaced, both ends included.
Grid sheet_grid(const Surface& sheet, int samples);

// A blending matrix as a dense table, sample by control point, row by row.
std::vector<float> dense_table(const BlendingMatrix& matrix);

// Control points in single precision.
std::vector<float> in_single(const std::vector<double>& values);

}  // namespace spoonbill
