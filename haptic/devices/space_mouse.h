// A 3Dconnexion SpaceMouse: a cap that a hand pushes and turns in six directions, without force. Read through
// libspnav from the daemon spacenavd.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "haptic/devices/hand_inputs.h"
#include "haptic/hand.h"

namespace spoonbill {

// How far the cap is from its rest, -1 to 1 on each axis; x right, y up, z toward the person. Rotations are
// about these axes, right-handed.
struct SpaceMouseMotion {
  Vector3 translation = Vector3::Zero();
  Vector3 rotation = Vector3::Zero();
  std::uint32_t buttons = 0;  // bit n: button n is down
};

// The six numbers of an event of libspnav: x right, y up, z away from the person, and rotations about them.
SpaceMouseMotion motion_from_counts(const int (&counts)[6], std::uint32_t buttons);

// The connection to the daemon, of which libspnav keeps one for the process. One owner: the thread that
// draws, never the haptic one, as it allocates and asks the system.
class SpaceMouse : public InputSource {
 public:
  // Refused: no daemon, or a SpaceMouse that is open already. Waits up to 0.3 s for an old daemon's answer.
  static Result<SpaceMouse> open();

  SpaceMouse(SpaceMouse&& other) noexcept;
  SpaceMouse& operator=(SpaceMouse&& other) noexcept;
  ~SpaceMouse() override;

  // Where the cap is now; nothing, for good, once the daemon has gone.
  std::optional<SpaceMouseMotion> poll();

  // Polls. Used is a cap that is pushed or turned beyond the dead zone of Steering, or a main button that is
  // pressed or let go.
  bool is_used() override;

  // Steers by what is_used() polled, with the main button alone.
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

 private:
  SpaceMouse() = default;
  void close();
  std::uint32_t main_button() const { return motion_.buttons & button_main; }

  bool is_open_ = true;
  SpaceMouseMotion motion_;
};

// How a cap that springs back moves a target: its displacement is a speed.
struct Steering {
  double speed_m_per_s = 0.1;        // at full displacement
  double turn_rate_rad_per_s = 1.5;  // likewise
  double dead_zone = 0.08;           // a displacement of an axis below this is none: hands rest on the cap
};

// The target `elapsed_s` later. Beyond the dead zone speed grows with the square of the displacement, for
// fine work near rest; turns are about the world's axes. Buttons replace the target's. Times outside 0 to
// 0.1 s, as after a pause, count as the nearer end.
HandTarget steer(const HandTarget& target, const SpaceMouseMotion& motion, double elapsed_s,
                 const Steering& steering = {});

}  // namespace spoonbill
