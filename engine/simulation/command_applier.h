// Carries out commands on the state of a simulation.
#pragma once

#include "engine/base/result.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

// Each makes everything new first, and changes the state only when all of it succeeded. Outside the tick: may
// allocate.
struct CommandApplier {
  Simulation::State& state;

  Status operator()(const PlacePlane& command);
  Status operator()(const RemovePlanes& command);
  Status operator()(const SetTool& command);
  Status operator()(const SetSymmetry& command);
  Status operator()(const ResetProxy& command);
  Status operator()(const LiftTool& command);
  Status operator()(const SetSculpting& command);
  Status operator()(const SetMaterial& command);
  Status operator()(const KeepShape& command);
  Status operator()(const RefineKnots& command);

 private:
  void release();
  Status check_body(int body) const;
  Status check_changes(const Tool& tool) const;
  void take_model(ToolModel model);
  void make_contacts();
  Status set_planes(std::vector<FixingPlane> planes);
  void set_mappings(std::vector<BodyMapping> mappings);
};

}  // namespace spoonbill
