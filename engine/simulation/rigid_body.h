// Pose and turns of a rigid body of a simulation. Owned by the body's state; allocates nothing.
#pragma once

#include "engine/base/geometry.h"
#include "engine/material/lattice_solver.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// A fixed body, which only a TurnBody command moves. Its pose maps the rest shape to the present one.
class RigidBody {
 public:
  const Pose& pose() const { return motion_.end; }
  const RigidMotion& motion() const { return motion_; }
  bool is_turning() const { return turns_; }

  // Starts a turn from the present pose.
  void turn(const TurnBody& turn);
  // Ends a turn, and puts the body at rest at `pose`.
  void place(const Pose& pose);
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
    if (!turns_) return;
    visit_pose(start_);
    visit(turn_.point_m.data(), 3);
    visit(turn_.axis.data(), 3);
    const double turn[] = {turn_.angle_deg, turn_.speed_deg_per_s, elapsed_s_};
    visit(turn, 3);
  }

 private:
  RigidMotion motion_;
  TurnBody turn_;  // the present turn, or the last one
  Pose start_;     // pose at the start of the turn
  double elapsed_s_ = 0.0;
  bool turns_ = false;
};

}  // namespace spoonbill
