// Loads and supports of one body, applied to the nodes of its lattice.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/material/statics/static_body.h"
#include "engine/scene/loads.h"

namespace spoonbill {

// Loads of a body, which owns them. They are built outside the tick; apply() allocates nothing.
class BodyLoads {
 public:
  BodyLoads() = default;
  // Builds the loads. `point_at` embeds a point (u, v) of the body's surface in the lattice. Refuses a load
  // whose region contains no face or node of the lattice; the error names the load's index.
  static Result<BodyLoads> make(const std::vector<Load>& loads, const LatticeMesh& mesh,
                                const std::function<EmbeddedPoint(double u, double v)>& point_at);

  bool empty() const { return nodes_.empty(); }
  const std::vector<NodeForce>& forces() const { return forces_; }
  const std::vector<PressedFace>& pressures() const { return pressures_; }
  // Returns the pressures on the skin of a body that is embedded in a box of cells; empty for any other body.
  const PressedSkin& pressed_skin() const { return pressed_skin_; }

  // Computes the loads on the current shape and sets them as node forces of the lattice, and of the implicit
  // solver if it is not null.
  void apply(SpringLattice& lattice, ImplicitSolver* solver);

 private:
  struct Builder;

  std::vector<NodeForce> forces_;
  std::vector<PressedFace> pressures_;
  PressedSkin pressed_skin_;
  std::vector<int> nodes_;        // all loaded nodes, sorted
  std::vector<Vector3> force_n_;  // working memory: force on each node of the lattice
};

// Supports of a body, which owns them. The displacement of a support is the displacement of its nodes minus
// SupportedNodes::base_m. begin_tick() allocates nothing.
class BodySupports {
 public:
  BodySupports() = default;
  // Builds the supports at rest. Refuses a support whose region contains no node of the lattice; the error
  // names the support's index.
  static Result<BodySupports> make(const std::vector<Support>& supports, const LatticeMesh& mesh);

  // Assigns to each support the nodes of its region that are not fixed yet, and marks them in `fixed`, one
  // byte per node. If regions overlap, the later support gets the nodes.
  void claim_nodes(const SpringLattice& lattice, std::vector<std::uint8_t>& fixed);
  // Keeps the supports' displacements when the rest shape of the lattice changes from that of `before` to
  // that of `after`.
  void rebase(const SpringLattice& before, const SpringLattice& after);

  // Sets the impulses of the supports to zero.
  void clear_impulses();
  // Updates the motions of the supports for a step of `time_s` that ends at `end_s`. Returns all supports.
  std::span<SupportedNodes> begin_step(const SpringLattice& lattice, double end_s, double time_s);

  std::span<const SupportedNodes> supports() const { return supported_; }

 private:
  std::vector<Support> definitions_;
  std::vector<std::vector<int>> region_nodes_;  // nodes in the region of each support
  std::vector<SupportedNodes> supported_;
};

}  // namespace spoonbill
