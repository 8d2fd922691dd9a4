// What merge tells of joints, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/merging/merge.h"

namespace spoonbill {

// A line for each and the field "joints", a list of them.
void add_joints(FactSheet& facts, const std::vector<MergedJoint>& joints);

// The same of bodies that cross: each but the first, with what those before it became. Where the corner of
// the last lies is told; those before it no longer lie along a line of constant v.
void add_corners(FactSheet& facts, const std::vector<Joint>& corners);

// Of a blend that was asked for: where it was of no use.
void add_unused_blends(const std::vector<MergedJoint>& joints, std::vector<std::string>& remarks);

// Of a fillet that came out tighter than asked; `which` tells it from others, like " with patch 3".
void add_tight_fillet(const Surface& merged, const Joint& corner, const std::string& which, double fillet_m,
                      int continuity, std::vector<std::string>& remarks);

void add_left_open(const std::vector<OpenEdges>& edges, std::vector<std::string>& remarks);

}  // namespace spoonbill
