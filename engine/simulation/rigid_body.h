// Pose and motion of a rigid body of a simulation. Owned by the body's state; allocates nothing.
#pragma once

#include <optional>
#include <variant>

#include "engine/base/geometry.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/rigid/rigid_dynamics.h"
#include "engine/scene/body_motion.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Returns the pose at a fraction of the straight way from one pose to another. Meant for small turns, which
// are then even without trigonometric functions.
Pose find_pose_between(const Pose& from, const Pose& to, double fraction);

// A fixed body, which only a TurnBody or MoveBody command moves, or a body that moves with its dynamics:
// freely, or held by a hand, which these commands move. Its pose maps the rest shape to the present one.
class RigidBody {
 public:
  RigidBody() = default;  // a fixed body
  RigidBody(const RigidDynamics& dynamics, const std::optional<HandSpring>& hand)
      : dynamics_(dynamics), hand_(hand) {}

  const Pose& pose() const { return dynamics_ ? dynamics_->pose() : motion_.end; }
  // Motion in the present step of a fixed body, or of the hand that holds the body.
  const RigidMotion& motion() const { return motion_; }
  // Null for a fixed body.
  RigidDynamics* dynamics() { return dynamics_ ? &*dynamics_ : nullptr; }
  const RigidDynamics* dynamics() const { return dynamics_ ? &*dynamics_ : nullptr; }
  const HandSpring* hand() const { return hand_ ? &*hand_ : nullptr; }
  bool is_free() const { return dynamics_ && !hand_; }
  // Returns whether the body may move in the present step.
  bool moves() const { return dynamics_ || motion_.moves; }
  // Returns whether a command is moving the body, or its hand.
  bool is_driven() const { return is_driven_; }

  // turn() and move() start a motion from the present pose, or from that of the hand. They replace a motion
  // that has not ended. move() allocates.
  void turn(const TurnBody& turn);
  void move(const BodyMotion& motion);
  // Moves the hand straight from its present pose to `to` within the next `time_s`. Allocates nothing.
  void carry(const Pose& to, double time_s);
  // Ends a motion, and puts the body at rest at `pose`.
  void place(const Pose& pose);
  // Ends a motion, and makes the present pose the rest shape, at rest. `frame` is the body's frame there.
  void keep_shape(const LatticeMesh& frame);
  // Puts the hand that holds the body at a pose, and ends a motion.
  void place_hand(const Pose& pose);
  // is_finite() returns whether the pose and the velocities are finite. return_to_start() puts a body with
  // dynamics at rest where it was at the start of the step, shifted by `shift_m`.
  bool is_finite() const;
  void return_to_start(const Vector3& shift_m) {
    dynamics_->place({step_start_.position_m + shift_m, step_start_.orientation});
  }
  // Finds the motion() of the next step, which lasts `time_s`: a tick or a part of it.
  void begin_step(double time_s);
  // Shortens a step that has begun but in which nothing has moved yet.
  void shorten_step(double from_s, double to_s);

  // Calls visit(const double*, count) with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    const auto visit_pose = [&](const Pose& pose) {
      visit(pose.position_m.data(), 3);
      visit(pose.orientation.coeffs().data(), 4);
    };
    visit_pose(motion_.end);
    if (dynamics_) dynamics_->visit_state(visit);
    if (!is_driven()) return;
    visit_pose(start_);
    if (is_carried_) {
      visit_pose(carried_to_);
      const double values[] = {carried_s_, elapsed_s_};
      return visit(values, 2);
    }
    if (const auto* const turn = std::get_if<TurnBody>(&drive_)) {
      visit(turn->point_m.data(), 3);
      visit(turn->axis.data(), 3);
      const double values[] = {turn->angle_deg, turn->speed_deg_per_s};
      visit(values, 2);
    } else {
      std::get<MotionPath>(drive_).visit_state(visit);
    }
    visit(&elapsed_s_, 1);
  }

 private:
  void start(std::variant<TurnBody, MotionPath> drive);
  void find_step_end();

  std::optional<RigidDynamics> dynamics_;
  std::optional<HandSpring> hand_;
  Pose step_start_;  // pose at the start of the step
  RigidMotion motion_;
  std::variant<TurnBody, MotionPath> drive_;  // the present drive of the body or of its hand, or the last one
  Pose start_;                                // pose at the start of the drive
  double elapsed_s_ = 0.0;
  bool is_driven_ = false;
  bool is_carried_ = false;  // true if the present drive is to carried_to_ in carried_s_, instead of drive_
  Pose carried_to_;
  double carried_s_ = 0.0;
};

}  // namespace spoonbill
