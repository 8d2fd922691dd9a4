#include "engine/simulation/refiner.h"

#include <optional>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/simulation/refinement.h"
#include "engine/simulation/simulation_build.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

struct Refiner::Parts {
  std::vector<BodyState> bodies;  // without their solvers; displacements are out of date
  ContactScene contacts;
  std::vector<FixingPlane> planes;
  ToolModel model;

  std::optional<PreparedRefinement> prepared = {};
  std::shared_ptr<SimulationBuild> replaced = {};  // build that the prepared refinement replaces
  std::optional<BodyMapping> next = {};            // mapping of the body after the prepared refinement
  bool is_adopted = false;                         // whether the simulation has taken what was prepared
};

Refiner::Refiner(const Simulation& simulation) {
  const Simulation::State& state = *simulation.state_;
  parts_ = std::make_unique<Parts>(
      Parts{state.bodies, find_contact_scene(state.scene), state.scene.planes, state.model});
  for (BodyState& body : parts_->bodies) body.implicit_solver.reset();
}
Refiner::Refiner(Refiner&&) noexcept = default;
Refiner& Refiner::operator=(Refiner&&) noexcept = default;
Refiner::~Refiner() = default;

bool Refiner::is_prepared() const {
  return parts_->prepared.has_value() && !parts_->is_adopted;
}

Status Refiner::prepare(const RefineKnots& command) {
  SPOONBILL_ASSERT((command.u || command.v) && command.body >= 0 &&
                   static_cast<std::size_t>(command.body) < parts_->contacts.body_count);
  const DenormalsFlushed flushed;
  Parts& parts = *parts_;
  if (parts.is_adopted) {
    parts.bodies[static_cast<std::size_t>(parts.prepared->body)].skin = *std::move(parts.next);
  }
  parts.is_adopted = false;
  parts.prepared.reset();
  parts.next.reset();
  Result<PreparedRefinement> prepared =
      prepare_refinement(command, parts.bodies, {parts.contacts, parts.planes, parts.model});
  if (!prepared.ok()) return prepared.error();
  parts.replaced = copy_mappings({parts.bodies.data(), parts.contacts.body_count});
  parts.next = prepared->finer;
  parts.prepared = std::move(prepared).value();
  return {};
}

std::shared_ptr<SimulationBuild>& Simulation::adopt(Refiner& refiner) {
  SPOONBILL_ASSERT(refiner.is_prepared());
  const DenormalsFlushed flushed;
  Refiner::Parts& parts = *refiner.parts_;
  adopt_refinement(*state_, *parts.prepared);
  parts.is_adopted = true;
  return parts.replaced;
}

}  // namespace spoonbill
