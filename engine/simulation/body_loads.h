// The loads of one body on the nodes of its lattice.
#pragma once

#include <functional>
#include <vector>

#include "engine/material/implicit/implicit_core.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/material/statics/static_body.h"
#include "engine/scene/loads.h"

namespace spoonbill {

// One owner, the body; built outside the tick, apply() allocates nothing.
class BodyLoads {
 public:
  BodyLoads() = default;
  // `point_at` embeds a point (u, v) of the body's surface. Refused, with the load's place in the list: one
  // whose region holds no face or node of the lattice.
  static Result<BodyLoads> make(const std::vector<Load>& loads, const LatticeMesh& mesh,
                                const std::function<EmbeddedPoint(double u, double v)>& point_at);

  bool empty() const { return nodes_.empty(); }
  const std::vector<NodeForce>& forces() const { return forces_; }
  const std::vector<PressedFace>& pressures() const { return pressures_; }
  const PressedSkin& pressed_skin() const { return pressed_skin_; }  // of a body in a box of cells

  // Sets the node forces of the lattice, and of what moves it where something does, to this share of the
  // loads as the body is bent now.
  void apply(double share, SpringLattice& lattice, ImplicitCore* core);

 private:
  struct Making;

  std::vector<NodeForce> forces_;
  std::vector<PressedFace> pressures_;
  PressedSkin pressed_skin_;
  std::vector<int> nodes_;        // all that are loaded
  std::vector<Vector3> force_n_;  // by node of the lattice: working memory
};

}  // namespace spoonbill
