// Pose and motion of a rigid body of a simulation. Owned by the body's state; allocates nothing.
#pragma once

#include <optional>

#include "engine/base/geometry.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/rigid/rigid_dynamics.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// A fixed body, which only a TurnBody command moves, or a body that moves with its dynamics: freely, or held
// by a hand, which TurnBody moves. Its pose maps the rest shape to the present one.
class RigidBody {
 public:
  RigidBody() = default;  // a fixed body
  RigidBody(const RigidDynamics& dynamics, const std::optional<HandSpring>& hand)
      : dynamics_(dynamics), hand_(hand) {}

  const Pose& pose() const { return dynamics_ ? dynamics_->pose() : motion_.end; }
  // Motion in the present tick of a fixed body, or of the hand that holds the body.
  const RigidMotion& motion() const { return motion_; }
  // Null for a fixed body.
  RigidDynamics* dynamics() { return dynamics_ ? &*dynamics_ : nullptr; }
  const RigidDynamics* dynamics() const { return dynamics_ ? &*dynamics_ : nullptr; }
  const HandSpring* hand() const { return hand_ ? &*hand_ : nullptr; }
  bool is_free() const { return dynamics_ && !hand_; }
  // Returns whether the body may move in the present tick.
  bool moves() const { return dynamics_ || motion_.moves; }
  bool is_turning() const { return turns_; }

  // Starts a turn from the present pose, or from that of the hand.
  void turn(const TurnBody& turn);
  // Ends a turn, and puts the body at rest at `pose`.
  void place(const Pose& pose);
  // Ends a turn, and makes the present pose the rest shape, at rest. `frame` is the body's frame there.
  void keep_shape(const LatticeMesh& frame);
  // Puts the hand that holds the body at a pose, and ends a turn.
  void place_hand(const Pose& pose);
  // is_finite() returns whether the pose and the velocities are finite. return_to_start() puts a body with
  // dynamics at rest where it was at the start of the tick.
  bool is_finite() const;
  void return_to_start() { dynamics_->place(tick_start_); }
  // Finds the motion() of the next tick, which lasts `tick_s`.
  void begin_tick(double tick_s);

  // Calls visit(const double*, count) with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    const auto visit_pose = [&](const Pose& pose) {
      visit(pose.position_m.data(), 3);
      visit(pose.orientation.coeffs().data(), 4);
    };
    visit_pose(motion_.end);
    if (dynamics_) dynamics_->visit_state(visit);
    if (!turns_) return;
    visit_pose(start_);
    visit(turn_.point_m.data(), 3);
    visit(turn_.axis.data(), 3);
    const double turn[] = {turn_.angle_deg, turn_.speed_deg_per_s, elapsed_s_};
    visit(turn, 3);
  }

 private:
  std::optional<RigidDynamics> dynamics_;
  std::optional<HandSpring> hand_;
  Pose tick_start_;  // pose at the start of the tick
  RigidMotion motion_;
  TurnBody turn_;  // the present turn, or the last one
  Pose start_;     // pose at the start of the turn
  double elapsed_s_ = 0.0;
  bool turns_ = false;
};

}  // namespace spoonbill
