// Patches for the tests of merging, and checks of the results.
#pragma once

#include <functional>

#include "engine/merging/merge.h"

namespace spoonbill {

MergeRequest request_of(int continuity, double tolerance_m = 5e-5);

// Rings of a conical frustum between two heights; u starts at the fraction `seam` of a turn.
Surface ring_strip(double from, double to, int count, double seam);

// A sheet between two curves over x, with u uneven by `warp`.
Surface sheet_between(const std::function<double(double)>& low, const std::function<double(double)>& high,
                      double warp = 0.0);

// A plane sheet with the domain [from, to] along v and the same length.
Surface level_sheet(double from, double to, int columns = 8);

// A torus about z, periodic in both directions: a tube of 8 mm about a circle of 20 mm, by its control
// points.
Surface ring_body();

// Returns true if the normals turn by less than 90 degrees between samples along v.
bool is_without_folds(const Surface& surface);

}  // namespace spoonbill
