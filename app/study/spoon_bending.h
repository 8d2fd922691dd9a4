// How a spoon bends in the hand, under its own weight and with the food.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "app/study/study_plan.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

// A lever that a hand holds: the part of the body behind a plane across it is fixed.
struct HeldLever {
  Body body;                           // deformable
  FixingPlane hand;                    // its normal points along the lever
  Vector2 loaded = Vector2::Zero();    // parameters of the point that bears the load
  Vector2 measured = Vector2::Zero();  // parameters of the point whose drop is measured
};

struct LeverBending {
  double drop_m = 0.0;          // of the measured point, along gravity
  double largest_strain = 0.0;  // magnitude of the largest principal strain
  // Distance from the hand's plane back to the foremost node behind it, up to a cell: the lever is free from
  // there on.
  double behind_plane_m = 0.0;
};

// Bends a level lever under its weight and a load, with standard gravity along -y and a lattice of at most
// bending_node_budget nodes. Fails where compute_rest_shape() does.
Result<LeverBending> bend_lever(const HeldLever& lever, double load_kg);
inline constexpr int bending_node_budget = 4000;

struct SpoonBending {
  double hand_m = 0.0;  // length that the hand holds, from the end of the handle
  LeverBending own_weight, with_food;
};

// Bends a spoon of one material, held in the rear third of its handle. The drop is that of the front of the
// rim. Fails if the spoon has no handle of at least twice the length that is held.
Result<SpoonBending> bend_spoon(const StudySpoon& spoon, const Material& material, double food_kg);

// Bending of spoons, by the names of spoon and material.
using Bendings = std::map<std::pair<std::string, std::string>, SpoonBending>;
// Bends all spoons of all materials with the first food, on `workers` threads. Leaves out those that cannot
// be bent, such as bowls without a handle.
Bendings bend_all(const StudyPlan& plan, int workers);
// Returns null if the spoon of this material was left out.
const SpoonBending* find_bending(const Bendings& bendings, const std::string& spoon,
                                 const std::string& material);

}  // namespace spoonbill
