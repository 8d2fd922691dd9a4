// Provides patches for the tests of merging, and checks of the results.
#pragma once

#include <functional>

#include "engine/merging/merge.h"

namespace spoonbill {

MergeRequest request_of(int continuity, double tolerance_m = 5e-5);

// Returns the side of a conical frustum between two heights. u goes around and starts at the fraction `seam`
// of a turn.
Surface ring_strip(double from, double to, int count, double seam);

// Returns a sheet between two curves over x. With `warp` other than 0, x does not grow evenly with u.
Surface sheet_between(const std::function<double(double)>& low, const std::function<double(double)>& high,
                      double warp = 0.0);

// Returns a plane sheet that extends from `from` to `to` along v, both as parameters and in metres.
Surface level_sheet(double from, double to, int columns = 8);

// Returns a torus about z, periodic in both directions: the control points form a tube of 8 mm about a circle
// of 20 mm.
Surface ring_body();

// Returns true if the normals turn by less than 90 degrees between samples along v.
bool is_without_folds(const Surface& surface);

}  // namespace spoonbill
