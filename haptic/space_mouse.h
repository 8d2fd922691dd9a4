// A 3Dconnexion SpaceMouse: a cap that a hand pushes and turns in six degrees of freedom, without force
// feedback. Its motion is read with libspnav from the daemon spacenavd.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "haptic/virtual_device.h"

namespace spoonbill {

// Displacement of the cap from rest, -1 to 1 on each axis: x right, y up, z toward the person. Rotations are
// right-handed about these axes.
struct SpaceMouseMotion {
  Vector3 translation = Vector3::Zero();
  Vector3 rotation = Vector3::Zero();
  std::uint32_t buttons = 0;  // bit n: button n is down
};

// Converts the six numbers of a libspnav event: displacements x right, y up, z away from the person, and
// rotations about these axes.
SpaceMouseMotion motion_from_counts(const int (&counts)[6], std::uint32_t buttons);

// The connection to the daemon. libspnav has one connection for the process. One owner: the drawing thread,
// never the haptic thread, because polling allocates and makes system calls.
class SpaceMouse : public InputSource {
 public:
  // Opens the connection to the daemon. Errors: no daemon, or a SpaceMouse that is already open. Waits up to
  // 0.3 s for the answer of an old daemon.
  static Result<SpaceMouse> open();

  SpaceMouse(SpaceMouse&& other) noexcept;
  SpaceMouse& operator=(SpaceMouse&& other) noexcept;
  ~SpaceMouse() override;

  // Returns the current displacement of the cap. Always returns nullopt once the daemon has gone.
  std::optional<SpaceMouseMotion> poll();

  // Polls the device. Returns true if the cap is displaced beyond the dead zone of Steering, or if the main
  // button was pressed or released.
  bool is_used() override;

  // Moves the target by the motion that is_used() polled. Of the buttons, only the main button is used.
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

 private:
  SpaceMouse() = default;
  void close();
  std::uint32_t main_button() const { return motion_.buttons & button_main; }

  bool is_open_ = true;
  SpaceMouseMotion motion_;
};

// Settings of rate control: the displacement of the cap sets the speed of the target.
struct Steering {
  double speed_m_per_s = 0.1;        // at full displacement
  double turn_rate_rad_per_s = 1.5;  // at full displacement
  double dead_zone = 0.08;           // displacements below this count as zero, because hands rest on the cap
};

// Returns the target as it is after `elapsed_s`. Beyond the dead zone the speed grows with the square of the
// displacement, for fine work near rest. Rotations are about the world axes. The buttons of the motion
// replace those of the target. The time is clamped to the range from 0 to 0.1 s, because the program may have
// paused.
HandTarget steer(const HandTarget& target, const SpaceMouseMotion& motion, double elapsed_s,
                 const Steering& steering = {});

}  // namespace spoonbill
