// Patches that tests of merging join, and what they look for in the result.
#pragma once

#include <functional>

#include "engine/merging/merge.h"

namespace spoonbill {

MergeRequest request_of(int continuity, double tolerance_m = 5e-5);

// Rings of a cone's frustum, from one height to another; u starts at the share `seam` of a turn.
Surface ring_strip(double from, double to, int count, double seam);

// A sheet between two curves over x; u runs unevenly by `warp`.
Surface sheet_between(const std::function<double(double)>& low, const std::function<double(double)>& high,
                      double warp = 0.0);

// Over the domain [from, to] along v, of a plane sheet that is as long.
Surface level_sheet(double from, double to, int columns = 8);

// About z, closed around both ways: a tube of 8 mm about a circle of 20 mm, by its control points.
Surface ring_body();

// Whether normals turn by less than a right angle from each sample along v to the next.
bool is_without_folds(const Surface& surface);

}  // namespace spoonbill
