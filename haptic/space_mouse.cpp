#include "haptic/space_mouse.h"

#include <spnav.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

namespace spoonbill {

namespace {

// Number that a SpaceMouse sends for the full displacement of its cap.
constexpr double full_counts = 350.0;

constexpr int button_count = 32;

constexpr double maximum_step_s = 0.1;

double displacement(int counts) {
  return std::clamp(static_cast<double>(counts) / full_counts, -1.0, 1.0);
}

void update_button(const spnav_event_button& event, std::uint32_t& buttons) {
  if (event.bnum < 0 || event.bnum >= button_count) return;
  const std::uint32_t bit = 1u << event.bnum;
  buttons = event.press != 0 ? buttons | bit : buttons & ~bit;
}

// Returns true if the daemon has closed the connection. In this case, too, libspnav reports "no event", and
// the cap would seem to stay displaced.
bool daemon_has_gone() {
  char byte = 0;
  const ssize_t count = recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

// Returns 0 within the dead zone. Beyond it, the result has the sign of the displacement, and its magnitude
// grows with the square of the distance from the dead zone, up to 1.
double shaped(double displacement, double dead_zone) {
  const double beyond = (std::abs(displacement) - dead_zone) / (1.0 - dead_zone);
  return beyond > 0.0 ? std::copysign(std::min(beyond * beyond, 1.0), displacement) : 0.0;
}

Vector3 shaped(const Vector3& displacement, double dead_zone) {
  return {shaped(displacement.x(), dead_zone), shaped(displacement.y(), dead_zone),
          shaped(displacement.z(), dead_zone)};
}

}  // namespace

SpaceMouseMotion motion_from_counts(const int (&counts)[6], std::uint32_t buttons) {
  SpaceMouseMotion motion;
  motion.translation = {displacement(counts[0]), displacement(counts[1]), -displacement(counts[2])};
  motion.rotation = {displacement(counts[3]), displacement(counts[4]), -displacement(counts[5])};
  motion.buttons = buttons;
  return motion;
}

Result<SpaceMouse> SpaceMouse::open() {
  if (spnav_fd() != -1) return Error{ErrorCode::in_use, "the SpaceMouse is open already"};
  if (spnav_open() != 0) {
    return Error{ErrorCode::unavailable,
                 "no SpaceMouse: its daemon does not answer; install the package spacenavd and start it "
                 "(systemctl start spacenavd)"};
  }
  return SpaceMouse();
}

SpaceMouse::SpaceMouse(SpaceMouse&& other) noexcept
    : is_open_(std::exchange(other.is_open_, false)), motion_(std::move(other.motion_)) {}

SpaceMouse& SpaceMouse::operator=(SpaceMouse&& other) noexcept {
  if (this == &other) return *this;
  close();
  is_open_ = std::exchange(other.is_open_, false);
  motion_ = other.motion_;
  return *this;
}

SpaceMouse::~SpaceMouse() {
  close();
}

void SpaceMouse::close() {
  if (std::exchange(is_open_, false)) spnav_close();
}

std::optional<SpaceMouseMotion> SpaceMouse::poll() {
  if (!is_open_) return {};
  spnav_event event;
  while (spnav_poll_event(&event) != 0) {
    if (event.type == SPNAV_EVENT_MOTION) {
      const spnav_event_motion& m = event.motion;
      motion_ = motion_from_counts({m.x, m.y, m.z, m.rx, m.ry, m.rz}, motion_.buttons);
    } else if (event.type == SPNAV_EVENT_BUTTON) {
      update_button(event.button, motion_.buttons);
    }
  }
  if (daemon_has_gone()) {
    close();
    return {};
  }
  return motion_;
}

bool SpaceMouse::is_used() {
  const std::uint32_t before = main_button();
  if (!poll()) {
    motion_ = {};
    return false;
  }
  const double dead_zone = Steering().dead_zone;
  const double largest =
      std::max(motion_.translation.cwiseAbs().maxCoeff(), motion_.rotation.cwiseAbs().maxCoeff());
  return largest > dead_zone || main_button() != before;
}

HandTarget SpaceMouse::next_target(const HandTarget& current, double elapsed_s) {
  SpaceMouseMotion motion = motion_;
  motion.buttons = main_button();
  return steer(current, motion, elapsed_s);
}

HandTarget steer(const HandTarget& target, const SpaceMouseMotion& motion, double elapsed_s,
                 const Steering& steering) {
  const double step_s = std::isfinite(elapsed_s) ? std::clamp(elapsed_s, 0.0, maximum_step_s) : 0.0;
  HandTarget moved = target;
  moved.buttons = motion.buttons;
  moved.pose.position_m += shaped(motion.translation, steering.dead_zone) * (steering.speed_m_per_s * step_s);
  const Vector3 turn = shaped(motion.rotation, steering.dead_zone) * (steering.turn_rate_rad_per_s * step_s);
  const double angle = turn.norm();
  if (angle > 0.0) {
    const Quaternion by(Eigen::AngleAxisd(angle, turn / angle));
    moved.pose.orientation = (by * moved.pose.orientation).normalized();
  }
  return moved;
}

}  // namespace spoonbill
