// GLSL for what makes the skin of a material uneven: grain, pores, brush marks. Depends only on the position
// in the body, so that patterns move with it.
#pragma once

#include <Eigen/Core>
#include <string>

#include "engine/simulation/snapshot.h"
#include "render/colour.h"

namespace spoonbill {

// Returns the matrix from the world to the body, in metres: x along the body's longer direction. It follows
// the body's control points or vertices, turns with them and changes only slightly when they deform.
Eigen::Matrix4f find_pattern_frame(const BodySnapshot& body);

// Returns the struct Skin (base, normal, visible) and a function patterned(Skin, position) that changes it at
// a point. Noise is computed from integers, so that all machines draw the same. Uniform: world_to_pattern,
// unless the pattern is `none`.
std::string pattern_glsl(SurfacePattern pattern);

}  // namespace spoonbill
