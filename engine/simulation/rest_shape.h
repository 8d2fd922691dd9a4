// The shape in which a body of a scene rests under the scene's gravity and its own loads, with the stiffness
// that its material has.
#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/material/statics/static_solver.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct RestShape {
  LatticeMesh mesh;  // as made
  StaticResult result;
  Surface surface;  // as bent
  int held_nodes = 0;
  Vector3 load_n = Vector3::Zero();      // gravity and loads together, as the body is bent
  Vector3 reaction_n = Vector3::Zero();  // of all that holds it
  int furthest_node = 0;                 // the one that is displaced most
  // The largest principal strain, by size, in the middle of a cell's faces (Green and Lagrange's).
  double largest_strain = 0.0;
  Vector3 strained_m = Vector3::Zero();  // where, at rest
};

// By the static solver, on hexahedra. Planes and supports hold, at the end of a ramp and in the middle of an
// oscillation; the ground and the other bodies do nothing. What flows or creeps counts as elastic. Refused:
// what make_body_state() refuses, a body that nothing holds, loads under which it finds no rest.
Result<RestShape> rest_shape(const Scene& scene, int body, const Progress& progress = {});

}  // namespace spoonbill
