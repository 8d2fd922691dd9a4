#include "app/training/hand_filter.h"

#include <algorithm>

#include "app/training/exact_angles.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

HandFilter::HandFilter(const HandModel& model, const Vector3& elbow_m, const Pose& start, std::uint32_t seed)
    : wrist_(model.wrist), speed_(model.speed), elbow_m_(elbow_m), reached_(start) {
  if (model.tremor) tremor_.emplace(*model.tremor, seed);
}

Pose HandFilter::step(const Pose& asked) {
  limit_speed(asked);
  Pose pose = limit_wrist();
  if (!tremor_) return pose;
  const Sway sway = tremor_->step();
  pose.position_m += sway.shift_m;
  pose.orientation = turn_by(sway.turn_rad) * pose.orientation;
  return pose;
}

void HandFilter::limit_speed(const Pose& asked) {
  if (!speed_) {
    reached_ = asked;
    return;
  }
  const Vector3 way_m = asked.position_m - reached_.position_m;
  const double distance_m = way_m.norm(), reach_m = speed_->speed_m_per_s * tick_s;
  reached_.position_m =
      distance_m > reach_m ? Vector3(reached_.position_m + reach_m / distance_m * way_m) : asked.position_m;
  const Vector3 turn = rotation_vector(asked.orientation * reached_.orientation.conjugate());
  const double angle = turn.norm(), reach = speed_->turn_rad_per_s * tick_s;
  reached_.orientation =
      angle > reach ? (turn_by(reach / angle * turn) * reached_.orientation).normalized() : asked.orientation;
}

Pose HandFilter::limit_wrist() {
  const Eigen::Matrix3d forearm = find_forearm(elbow_m_, reached_.position_m);
  const Eigen::Matrix3d hand = reached_.orientation.toRotationMatrix();
  angles_ = find_wrist_angles(forearm, hand);
  if (!wrist_) return reached_;
  bool is_stopped = false;
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const double stopped = stopped_angle(angles_[k], wrist_->range_rad[k], wrist_->stop_rad);
    is_stopped |= stopped != angles_[k];
    angles_[k] = stopped;
  }
  if (!is_stopped) return reached_;
  Pose pose = reached_;
  pose.orientation = Quaternion(find_hand(forearm, angles_));
  return pose;
}

}  // namespace spoonbill
