// What a simulation consists of. Private to Simulation and its commands.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_pair_contact.h"
#include "engine/simulation/body_self_contact.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/on_ground.h"
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
  // Where the hand was when a soft tool last began to touch.
  Vector3 touch_m = Vector3::Zero();
  bool touched = false;

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
  std::vector<BodyState> bodies;  // as in the scene; then a soft tool
  ToolModel model;                // of the last solid
  HeldTool tool;
  HeldTool mirrored;
  BodyContacts between;
  std::vector<BodyPairContact> pairs;  // 0 and 1, 0 and 2, 1 and 2, ...: see make_pairs()
  std::vector<BodySelfContact> self;   // of each body
  OnGround on_ground;                  // the bodies of the scene, where it has a ground
  bool pairs_overflow = false;
  double tool_gap_m = 0.0;  // of a soft tool to the bodies; infinite where it is not near
  // Of tools that were replaced: snapshots share them, and no tick must free the last of one.
  std::vector<std::shared_ptr<const ToolBody>> kept;
  std::vector<std::shared_ptr<const std::vector<TriangleCorners>>> kept_triangles;
  std::uint64_t tick = 0;
  RelaxReport relaxed{};
  Reaction reaction{};

  bool tool_is_soft() const {
    return scene.tool.kind == ToolKind::solid && bodies.size() > scene.bodies.size();
  }
  // Those of the scene, and those that are stepped: a soft tool rests while the hand holds another.
  std::span<BodyState> scene_bodies() { return {bodies.data(), scene.bodies.size()}; }
  std::size_t stepped() const { return scene.bodies.size() + (tool_is_soft() ? 1 : 0); }
  const Material& material(std::size_t body) const {
    return body < scene.bodies.size() ? scene.bodies[body].material : scene.tool.body->soft->material;
  }
};

std::vector<BodyPairContact> make_pairs(const std::vector<BodyState>& bodies);
std::vector<BodySelfContact> make_self(const std::vector<BodyState>& bodies);
// The memory of all their constraints.
BodyContacts make_between();

}  // namespace spoonbill
