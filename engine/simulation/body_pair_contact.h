// Two bodies of a simulation on each other: where their skins come near, as constraints between their
// lattices.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "engine/collision/proximity/mesh_proximity.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/surface_contact.h"
#include "engine/material/contact/body_contacts.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// How deep surfaces of bodies that are pressed together come to be in each other at most, in lattice cells of
// the coarser one, up to a speed of 60 mm/s: their control nets follow a dent a cell wide only in part. What
// is left is taken back as soon as they rest.
inline constexpr double body_depth_limit_cells = 0.03;

// How near a point must be to become a constraint, in lattice cells of the coarser body: about what a tick
// can move it.
inline constexpr double contact_margin_cells = 0.25;

// Where the body stands among the simulation's, and its state.
struct NumberedBody {
  int number;
  const BodyState* state;
};

// The embedding of a point of a body's surface.
EmbeddedPoint embedding_of(const BodyMapping& mapping, const NearPoint& near);

// A constraint for each point of one body that is near the other, or near another part of the same. False
// where a capacity was met.
bool add_near_points(const NumberedBody& from, const NumberedBody& to, const std::vector<NearPoint>& points,
                     BodyContacts& contacts);

// One owner, the simulation; rebuilt with the mapping of a body. find() and add_contacts()
// allocate nothing.
class BodyPairContact {
 public:
  // The first must have a surface; the second, a surface or a mesh.
  BodyPairContact(const BodyState& first, const BodyState& second);

  // Finds each point of either surface that is near the other. False where a capacity was met.
  bool find(const NumberedBody& first, const NumberedBody& second);
  // Of the last find(), below zero where they are in each other; infinite where they are not near.
  double least_gap_m() const {
    return std::visit([](const auto& of) { return of->least_gap_m(); }, proximity_);
  }
  // Of the last find(), the place on a body's surface that is deepest in the other, or nearest to it. None
  // where nothing is near, or on a mesh.
  std::optional<SurfaceSpot> deepest_on_first(const BodyState& first) const;
  std::optional<SurfaceSpot> deepest_on_second() const;
  // Adds a constraint for each of them. False where a capacity was met.
  bool add_contacts(const NumberedBody& first, const NumberedBody& second, BodyContacts& contacts) const;

 private:
  // By pointer: they do not move.
  std::variant<std::unique_ptr<SurfaceProximity>, std::unique_ptr<MeshProximity>> proximity_;
};

}  // namespace spoonbill
