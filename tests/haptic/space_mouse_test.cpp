// Tests the class SpaceMouse with a simulated daemon on a socket of its own, and the function steer() without
// a daemon.
#include "haptic/space_mouse.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <string>

#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

// Simulates the daemon spacenavd: each event is eight integers, the first of which is its kind.
class Daemon {
 public:
  Daemon() {
    const std::string path = (folder_.path() / "spnav.sock").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    listening_ = socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listening_, 1), 0);
    setenv("SPNAV_SOCKET", path.c_str(), 1);
  }
  ~Daemon() {
    leave();
    unsetenv("SPNAV_SOCKET");
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  void accept_client() { client_ = accept(listening_, nullptr, nullptr); }
  void move(const std::array<std::int32_t, 6>& counts) {
    send({0, counts[0], counts[1], counts[2], counts[3], counts[4], counts[5], 16});
  }
  void press(int button) { send({1, button, 0, 0, 0, 0, 0, 0}); }
  void release(int button) { send({2, button, 0, 0, 0, 0, 0, 0}); }
  void leave() {
    for (int* connection : {&client_, &listening_}) {
      if (*connection >= 0) close(*connection);
      *connection = -1;
    }
  }

 private:
  void send(const std::array<std::int32_t, 8>& event) {
    EXPECT_EQ(write(client_, event.data(), sizeof event), static_cast<ssize_t>(sizeof event));
  }

  TemporaryFolder folder_;
  int listening_ = -1, client_ = -1;
};

TEST(SpaceMouse, FollowsTheDaemonsEventsUntilItLeaves) {
  Daemon daemon;
  auto mouse = SpaceMouse::open();
  ASSERT_TRUE(mouse.ok()) << mouse.error().message;
  daemon.accept_client();
  EXPECT_EQ(mouse->poll()->translation, Vector3::Zero());
  EXPECT_EQ(SpaceMouse::open().error().code, ErrorCode::in_use);

  daemon.move({350, -175, 70, 0, 0, 35});
  daemon.press(1);
  auto motion = mouse->poll();
  ASSERT_TRUE(motion.has_value());
  EXPECT_TRUE(motion->translation.isApprox(Vector3(1.0, -0.5, -0.2), 1e-12));
  EXPECT_TRUE(motion->rotation.isApprox(Vector3(0.0, 0.0, -0.1), 1e-12));
  EXPECT_EQ(motion->buttons, 2u);
  // The daemon sends nothing while the cap is held still.
  EXPECT_EQ(mouse->poll()->translation, motion->translation);

  daemon.move({9, 9, 9, 9, 9, 9});
  daemon.press(0);
  daemon.release(1);
  daemon.press(77);
  daemon.move({0, 0, 0, 0, 0, 0});
  motion = mouse->poll();
  EXPECT_EQ(motion->translation, Vector3::Zero());
  EXPECT_EQ(motion->buttons, 1u);

  daemon.leave();
  EXPECT_FALSE(mouse->poll().has_value());
  EXPECT_FALSE(mouse->poll().has_value());
}

// A hand resting on the cap does not count as use of the SpaceMouse, nor do buttons other than the main
// button.
TEST(SpaceMouse, IsUsedWhileItsCapIsAwayFromRestOrItsMainButtonChanges) {
  Daemon daemon;
  auto mouse = SpaceMouse::open();
  ASSERT_TRUE(mouse.ok()) << mouse.error().message;
  daemon.accept_client();
  EXPECT_FALSE(mouse->is_used());
  daemon.move({20, -20, 20, 20, 20, -20});  // a hand rests on the cap
  EXPECT_FALSE(mouse->is_used());
  daemon.move({0, 0, 0, 0, 100, 0});
  EXPECT_TRUE(mouse->is_used());
  EXPECT_TRUE(mouse->is_used());
  daemon.move({0, 0, 0, 0, 0, 0});
  EXPECT_FALSE(mouse->is_used());
  daemon.press(1);
  EXPECT_FALSE(mouse->is_used());
  daemon.press(0);
  EXPECT_TRUE(mouse->is_used());
  EXPECT_FALSE(mouse->is_used());
  daemon.move({350, 0, 0, 0, 0, 0});
  EXPECT_TRUE(mouse->is_used());
  const HandTarget moved = mouse->next_target({}, 0.02);
  EXPECT_NEAR(moved.pose.position_m.x(), 0.02 * Steering().speed_m_per_s, 1e-12);
  EXPECT_EQ(moved.buttons, 1u);
  daemon.leave();
  EXPECT_FALSE(mouse->is_used());
  EXPECT_EQ(mouse->next_target(moved, 0.02).pose.position_m, moved.pose.position_m);
}

TEST(SpaceMouse, MovesAndOpensAgain) {
  for (int round = 0; round < 2; ++round) {
    Daemon daemon;
    auto opened = SpaceMouse::open();
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    daemon.accept_client();
    SpaceMouse mouse = std::move(opened).value();
    daemon.press(0);
    EXPECT_EQ(mouse.poll()->buttons, 1u);
  }
}

TEST(SpaceMouse, SaysWhatToDoWithoutADaemon) {
  if (access("/var/run/spnav.sock", F_OK) == 0) GTEST_SKIP() << "this machine has the daemon";
  const auto mouse = SpaceMouse::open();
  ASSERT_FALSE(mouse.ok());
  EXPECT_EQ(mouse.error().code, ErrorCode::unavailable);
  EXPECT_NE(mouse.error().message.find("spacenavd"), std::string::npos);
}

TEST(SpaceMouse, CountsAreHeldWithinFullDisplacement) {
  const SpaceMouseMotion motion = motion_from_counts({5000, -5000, 5000, 700, -700, 700}, 3);
  EXPECT_EQ(motion.translation, Vector3(1.0, -1.0, -1.0));
  EXPECT_EQ(motion.rotation, Vector3(1.0, -1.0, -1.0));
  EXPECT_EQ(motion.buttons, 3u);
}

SpaceMouseMotion pushed(const Vector3& translation, const Vector3& rotation) {
  return {translation, rotation, 0};
}

TEST(Steer, FullDisplacementIsFullSpeed) {
  const Steering steering;
  HandTarget target;
  for (int frame = 0; frame < 50; ++frame) {
    target = steer(target, pushed(Vector3(-1, 0, 0), Vector3::Zero()), 0.02, steering);
  }
  EXPECT_TRUE(target.pose.position_m.isApprox(Vector3(-steering.speed_m_per_s, 0, 0), 1e-12));
  EXPECT_EQ(target.pose.orientation.coeffs(), Quaternion::Identity().coeffs());
}

TEST(Steer, NothingMovesWithinTheDeadZoneAndSpeedStartsAtItsEdge) {
  const Steering steering;
  HandTarget target;
  target.pose.position_m = Vector3(1, 2, 3);
  const Vector3 resting = Vector3::Constant(0.99 * steering.dead_zone);
  const HandTarget still = steer(target, pushed(resting, -resting), 0.02);
  EXPECT_EQ(still.pose.position_m, target.pose.position_m);
  EXPECT_EQ(still.pose.orientation.coeffs(), target.pose.orientation.coeffs());
  const Vector3 beyond(0, 0, steering.dead_zone + 1e-3);
  const double moved = steer(target, pushed(beyond, Vector3::Zero()), 0.02).pose.position_m.z() - 3.0;
  EXPECT_GT(moved, 0.0);
  EXPECT_LT(moved, 1e-5 * steering.speed_m_per_s);
  // Halfway between the dead zone and the end of the range, the speed is a quarter of the largest speed.
  const Vector3 half(0, 0.5 * (1.0 + steering.dead_zone), 0);
  EXPECT_NEAR(steer(target, pushed(half, Vector3::Zero()), 0.02).pose.position_m.y() - 2.0,
              0.25 * 0.02 * steering.speed_m_per_s, 1e-12);
}

TEST(Steer, TurnsAboutTheWorldsAxes) {
  const Steering steering;
  HandTarget target;
  target.pose.orientation = Quaternion(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitX()));
  const Quaternion start = target.pose.orientation;
  const int frames = 100;
  for (int frame = 0; frame < frames; ++frame) {
    target = steer(target, pushed(Vector3::Zero(), Vector3(0, 1, 0)), 0.01);
  }
  const double angle = steering.turn_rate_rad_per_s * 0.01 * frames;
  const Quaternion expected = Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitY())) * start;
  EXPECT_LT(expected.angularDistance(target.pose.orientation), 1e-9);
  EXPECT_NEAR(target.pose.orientation.norm(), 1.0, 1e-12);
}

TEST(Steer, APauseIsNoLeapAndButtonsPassOn) {
  const Steering steering;
  SpaceMouseMotion motion = pushed(Vector3(1, 0, 0), Vector3::Zero());
  motion.buttons = button_main;
  HandTarget target;
  const HandTarget moved = steer(target, motion, 60.0);
  EXPECT_NEAR(moved.pose.position_m.x(), 0.1 * steering.speed_m_per_s, 1e-12);
  EXPECT_EQ(moved.buttons, button_main);
  EXPECT_EQ(steer(target, motion, -1.0).pose.position_m, Vector3::Zero());
  EXPECT_EQ(steer(target, motion, std::nan("")).pose.position_m, Vector3::Zero());
}

}  // namespace
}  // namespace spoonbill
