// One body of a simulation: its lattice, its surface and what holds it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/material/implicit/implicit_core.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_loads.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/body_supports.h"
#include "engine/simulation/mesh_mapping.h"
#include "engine/simulation/smoothing.h"

namespace spoonbill {

// Plain data, one owner: the simulation.
struct BodyState {
  SpringLattice lattice;
  std::variant<BodyMapping, MeshMapping> skin;
  Smoothing smoothing;
  std::vector<std::uint8_t> held, touched;  // one byte a node
  std::optional<ImplicitCore> core = {};    // where the material is too stiff for the lattice's springs
  bool core_rests = false;
  BodyLoads loads = {};
  BodySupports supports = {};
  double shell_thickness_m = 0.0;                // 0: a solid
  std::shared_ptr<const TrimmedArea> trim = {};  // what is there of its surface; none: all

  // Lets the supports hold what the planes do not.
  void hold_behind(const std::vector<FixingPlane>& planes);
  // One byte a node.
  void hold(std::vector<std::uint8_t> nodes) {
    SPOONBILL_ASSERT(nodes.size() == static_cast<std::size_t>(lattice.mesh().node_count()));
    held = std::move(nodes);
    lattice.hold(held);
    if (core) core->hold(held);
  }
  void set_core(std::optional<ImplicitCore> made) {
    core = std::move(made);
    if (core) core->hold(held);
    rest_core(core_rests);
  }
  // While a tool grips, the springs step the body: grips hold both ways, and those of a tool much heavier
  // than a stiff body would shake it.
  void rest_core(bool rests) {
    core_rests = rests;
    lattice.set_contact_inverse_mass(mover() ? core->contact_inverse_mass() : 0.0);
    lattice.hold(held);
    if (mover()) core->take_shape(lattice);
  }
  ImplicitCore* mover() { return core && !core_rests ? &*core : nullptr; }
  const ImplicitCore* mover() const { return core && !core_rests ? &*core : nullptr; }
  // The Young's modulus that is stepped.
  double felt_youngs_modulus_pa() const {
    return mover() ? lattice.material().youngs_modulus_pa : lattice.youngs_modulus_pa();
  }

  const LatticeReport& report() const { return mover() ? mover()->report() : lattice.report(); }

  // What every body has but a tessellated tool that gives way.
  BodyMapping& mapping() {
    SPOONBILL_ASSERT(mesh() == nullptr);
    return *std::get_if<BodyMapping>(&skin);
  }
  const BodyMapping& mapping() const {
    SPOONBILL_ASSERT(mesh() == nullptr);
    return *std::get_if<BodyMapping>(&skin);
  }
  // Of such a tool; null of any other body.
  const MeshMapping* mesh() const { return std::get_if<MeshMapping>(&skin); }

  // The skin follows the lattice.
  void update_skin() {
    std::visit([this](auto& of) { of.update(lattice); }, skin);
  }
};

// Refused with the field named where the body cannot be simulated.
Result<BodyState> make_body_state(const Body& body, const std::vector<FixingPlane>& planes,
                                  InstructionSet set, const FeatureMapWatch& watch = {});

// The lattice of a body at the stiffness that sculpting can hold: all its materials softened alike.
Result<SpringLattice> sculpting_lattice(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                        InstructionSet set);

// Elastic bodies are stepped with their true stiffness from here on: the few newtons of a hand dent them by
// less than a third of a millimetre, and what they do is bend. Softer ones are dented, which takes the finer
// lattice and its springs.
inline constexpr double stiff_youngs_modulus_pa = 1e6;

// What moves a lattice instead of its springs: of one whose materials are all plainly elastic, and whose
// stiffest is as stiff as that; and of an elastic shell, which bends where springs in one layer would be
// twice too stiff. Unstrained at `rest_m`. None where the springs do.
Result<std::optional<ImplicitCore>> core_of(const SpringLattice& lattice, const std::vector<Vector3>& rest_m,
                                            InstructionSet set);

// What is wrong with a body that can be simulated all the same, in a line with its remedy; empty: nothing.
// Cells too slender for springs are stiffer along them than the material, by a share that this is the limit
// of: such a lattice may be drawn and felt, but not as the material named.
inline constexpr double slender_stiffness_limit = 0.25;
std::string remark_on(const BodyState& body);

// One byte a node, 1 where a plane holds it.
std::vector<std::uint8_t> nodes_behind(const SpringLattice& lattice, const std::vector<FixingPlane>& planes);

}  // namespace spoonbill
