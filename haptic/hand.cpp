#include "haptic/hand.h"

namespace spoonbill {

Status check_hand(const Hand& hand) {
  if (Status status = check_range("mass_kg", hand.mass_kg, hand_mass_range_kg); !status.ok()) return status;
  if (Status status = check_range("stiffness_n_per_m", hand.stiffness_n_per_m, hand_stiffness_range_n_per_m);
      !status.ok()) {
    return status;
  }
  return check_range("damping_n_s_per_m", hand.damping_n_s_per_m, hand_damping_range_n_s_per_m);
}

bool is_finite(const HandTarget& target) {
  return target.pose.position_m.allFinite() && target.pose.orientation.coeffs().allFinite();
}

}  // namespace spoonbill
