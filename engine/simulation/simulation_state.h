// What a simulation consists of. Private to Simulation and its commands.
#pragma once

#include <vector>

#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_pair_contact.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/tool_contact.h"

namespace spoonbill {

// A tool in a hand: the person's own, or its mirror image. The contact keeps the addresses of the mappings'
// grids, which the mappings hold by pointer: all of them move freely.
struct HeldTool {
  ToolContact contact;
  Pose hand{};  // of the last tick
  ToolState state{};
  bool placed = false;

  void place(const Pose& pose) {
    hand = pose;
    state.position_m = pose.position_m;
    state.velocity_m_per_s.setZero();
    placed = true;
  }
};

struct Simulation::State {
  Scene scene;
  InstructionSet set;
  std::vector<BodyState> bodies;  // as in the scene
  HeldTool tool;
  HeldTool mirrored;
  BodyContacts between;
  std::vector<BodyPairContact> pairs;  // 0 and 1, 0 and 2, 1 and 2, ...: see make_pairs()
  bool pairs_overflow = false;
  std::uint64_t tick = 0;
  RelaxReport relaxed{};
  Reaction reaction{};
};

std::vector<BodyPairContact> make_pairs(const std::vector<BodyState>& bodies);

}  // namespace spoonbill
