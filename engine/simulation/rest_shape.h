// Static shape of a body under gravity and its loads, at the true stiffness of its materials.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/material/statics/static_solver.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct RestShape {
  LatticeMesh mesh;  // undeformed lattice
  StaticResult result;
  Surface surface;  // deformed surface
  int fixed_nodes = 0;
  Vector3 load_n = Vector3::Zero();      // sum of gravity and loads on the deformed body
  Vector3 reaction_n = Vector3::Zero();  // sum of the reactions at all fixed nodes
  int furthest_node = 0;                 // index of the node with the largest displacement
  // Principal Green-Lagrange strain of the largest magnitude at the centres of the cells' faces.
  double largest_strain = 0.0;
  // Position of the largest strain in the undeformed body.
  Vector3 largest_strain_position_m = Vector3::Zero();
};

// Computes the rest shape with hexahedra. Planes and supports fix their nodes. A moving support is at the end
// of its ramp or at the centre of its oscillation. Ground and other bodies are ignored, and plastic or
// creeping materials are treated as elastic. Refuses what make_body_state() refuses, a body that nothing
// fixes, and loads without an equilibrium.
Result<RestShape> compute_rest_shape(const Scene& scene, int body, const Progress& progress = {});

}  // namespace spoonbill
