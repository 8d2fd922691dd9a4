// The errors of a fit as a cloud of coloured points.
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {

// A binary PLY file in metres, each point (of a mesh, points all over it) with its distance_mm and a colour
// from dark blue (0) over green to yellow (`full_m` and beyond), which reads without red and green.
Status write_error_cloud(const ScanFit& fit, double full_m, const std::filesystem::path& file);

}  // namespace spoonbill
