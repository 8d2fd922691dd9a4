// Tests the models of hands: angles, tremor, wrist, speed and their files.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <vector>

#include "app/training/exact_angles.h"
#include "app/training/hand_filter.h"
#include "app/training/hand_model.h"
#include "app/training/tremor.h"
#include "app/training/wrist.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {
namespace {

const std::filesystem::path hand_folder = std::filesystem::path(SPOONBILL_ASSETS) / "hands";
const Vector3 elbow_m(-0.33, 0.06, 0.0);
const Pose start{Vector3(-0.1, 0.0, 0.0), Quaternion::Identity()};

TEST(ExactAngles, AreThoseOfTheMathematicsLibrary) {
  constexpr double roundings = 4e-16;
  for (int k = -200; k <= 200; ++k) {
    const double angle = std::numbers::pi * k / 200.0;
    const SineCosine exact = sine_cosine(angle);
    EXPECT_NEAR(exact.sine, std::sin(angle), roundings) << angle;
    EXPECT_NEAR(exact.cosine, std::cos(angle), roundings) << angle;
    const double y = 3.0 * std::sin(angle), x = 3.0 * std::cos(angle);
    EXPECT_NEAR(angle_of(y, x), std::atan2(y, x), 2.0 * roundings) << angle;
  }
}

TEST(ExactAngles, TurnsAreTheirRotationVectors) {
  for (const double angle : {0.0, 1e-9, 0.01, 1.0, 3.0}) {
    const Vector3 rotation = angle * Vector3(1.0, -2.0, 2.0) / 3.0;
    EXPECT_LT((rotation_vector(turn_by(rotation)) - rotation).norm(), 1e-15 + 1e-14 * angle);
  }
}

// Amplitude of a signal at a frequency, by its Fourier integral.
double amplitude_at(const std::vector<double>& signal, double frequency_hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    sum +=
        signal[k] * std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * tick_s * static_cast<double>(k));
  }
  return 2.0 * std::abs(sum) / static_cast<double>(signal.size());
}

double root_mean_square(const std::vector<double>& signal) {
  double squares = 0.0;
  for (const double value : signal) squares += value * value;
  return std::sqrt(squares / static_cast<double>(signal.size()));
}

// The shift of a trembling hand along an axis, in 62.5 s, and its turn about the same axis. All lines of the
// tremor in the test have whole periods in this time.
struct Trembled {
  std::vector<double> shift_m, turn_rad;
};
Trembled tremble(const HandModel& hand, std::uint32_t seed, int axis) {
  HandFilter filter(hand, elbow_m, start, seed);
  Trembled trembled;
  for (int k = 0; k < 62'500; ++k) {
    const Pose pose = filter.step(start);
    trembled.shift_m.push_back(pose.position_m[axis] - start.position_m[axis]);
    trembled.turn_rad.push_back(rotation_vector(pose.orientation)[axis]);
  }
  return trembled;
}

TEST(Tremor, HasTheAmplitudeAndTheBandOfItsModel) {
  HandModel hand;
  hand.tremor = TremorModel{{4.0, 8.0}, 2e-3, 0.02};
  for (int axis = 0; axis < 3; ++axis) {
    const Trembled trembled = tremble(hand, 7, axis);
    EXPECT_NEAR(root_mean_square(trembled.shift_m), 2e-3, 0.05 * 2e-3);
    EXPECT_NEAR(root_mean_square(trembled.turn_rad), 0.02, 0.05 * 0.02);
    // The mean square is the sum of half the squares of the amplitudes. The lines are 0.16 Hz apart.
    double within = 0.0, outside = 0.0;
    for (double frequency_hz = 0.08; frequency_hz < 20.0; frequency_hz += 0.16) {
      const double part = 0.5 * std::pow(amplitude_at(trembled.shift_m, frequency_hz), 2);
      (frequency_hz > 4.0 && frequency_hz < 8.0 ? within : outside) += part;
    }
    EXPECT_NEAR(std::sqrt(within), 2e-3, 0.05 * 2e-3);
    EXPECT_LT(outside, 0.01 * within);
  }
}

TEST(Tremor, IsTheSameForTheSameSeedOnly) {
  const TremorModel model{{4.0, 12.0}, 1e-3, 0.01};
  Tremor one(model, 1), same(model, 1), other(model, 2);
  bool differs = false;
  for (int k = 0; k < 1000; ++k) {
    const Sway first = one.step(), second = same.step(), third = other.step();
    ASSERT_EQ(first.shift_m, second.shift_m);
    ASSERT_EQ(first.turn_rad, second.turn_rad);
    differs |= first.shift_m != third.shift_m;
  }
  EXPECT_TRUE(differs);
}

TEST(Wrist, AnglesAreThoseByWhichTheHandIsTurned) {
  const Eigen::Matrix3d forearm = find_forearm(Vector3(0.1, -0.2, 0.3), Vector3(0.3, -0.1, 0.2));
  EXPECT_LT((forearm.transpose() * forearm - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(forearm.determinant(), 1.0, 1e-14);
  const WristAngles angles{0.3, -0.4, 1.1};
  const WristAngles found = find_wrist_angles(forearm, find_hand(forearm, angles));
  for (std::size_t k = 0; k < wrist_turn_count; ++k) EXPECT_NEAR(found[k], angles[k], 1e-14);
}

TEST(Wrist, PositiveDeviationLiftsTheFront) {
  const Eigen::Matrix3d hand = find_hand(Eigen::Matrix3d::Identity(), {0.0, 0.2, 0.0});
  EXPECT_GT((hand * Vector3::UnitX()).y(), 0.0);
  const Eigen::Matrix3d bent = find_hand(Eigen::Matrix3d::Identity(), {0.2, 0.0, 0.0});
  EXPECT_LT((bent * Vector3::UnitX()).z(), 0.0);  // to the left seen from above
  const Eigen::Matrix3d rotated = find_hand(Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.2});
  EXPECT_LT((rotated * Vector3::UnitZ()).y(), 0.0);  // the right side goes down
}

TEST(Wrist, StopGivesWayByNoMoreThanItsCompliance) {
  const Range<double> range{-0.1, 0.2};
  double before = -10.0;
  for (double asked = -2.0; asked <= 2.0; asked += 0.01) {
    const double angle = stopped_angle(asked, range, 0.05);
    EXPECT_GT(angle, before);
    EXPECT_GT(angle, range.low - 0.05);
    EXPECT_LT(angle, range.high + 0.05);
    if (range.contains(asked)) {
      EXPECT_EQ(angle, asked);
    }
    before = angle;
  }
  EXPECT_NEAR(stopped_angle(0.2001, range, 0.05), 0.2001, 1e-6);  // no jump where it begins
}

TEST(Wrist, HandStaysWithinTheRangeAndItsStop) {
  HandModel hand = read_hand(hand_folder / "limited-wrist.json").value();
  hand.speed.reset();
  HandFilter filter(hand, elbow_m, start, 1);
  const WristModel& wrist = *hand.wrist;
  for (int k = 0; k < 1000; ++k) {
    const double turn = 1.2 * std::sin(0.01 * k);
    const Pose asked{start.position_m + 1e-4 * k * Vector3(0.3, 1.0, 0.4),
                     turn_by(Vector3(turn, 0.5 * turn, -turn))};
    const Pose reached = filter.step(asked);
    const WristAngles angles =
        find_wrist_angles(find_forearm(elbow_m, reached.position_m), reached.orientation.toRotationMatrix());
    for (std::size_t a = 0; a < wrist_turn_count; ++a) {
      EXPECT_GT(angles[a], wrist.range_rad[a].low - wrist.stop_rad - 1e-9);
      EXPECT_LT(angles[a], wrist.range_rad[a].high + wrist.stop_rad + 1e-9);
    }
    EXPECT_EQ(reached.position_m, asked.position_m);
  }
}

// A hand on its elbow, or above it, has a forearm too, and turns of the wrist within half a turn.
TEST(Wrist, AnyPlaceOfTheHandHasAForearm) {
  for (const Vector3& hand_m :
       {elbow_m, Vector3(elbow_m + Vector3(0.0, 0.3, 0.0)), Vector3(elbow_m - Vector3(0.0, 0.3, 0.0))}) {
    const Eigen::Matrix3d forearm = find_forearm(elbow_m, hand_m);
    EXPECT_LT((forearm.transpose() * forearm - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    for (const double turn : {0.0, 0.5 * std::numbers::pi}) {
      const Quaternion hand = turn_about_axis(Vector3::UnitZ(), turn);
      for (const double angle : find_wrist_angles(forearm, hand.toRotationMatrix())) {
        EXPECT_LE(std::abs(angle), std::numbers::pi);
      }
    }
  }
}

TEST(SlowHand, IsNoFasterThanItsModelAndArrives) {
  HandModel hand;
  hand.speed = HandSpeed{0.1, 0.5};
  HandFilter filter(hand, elbow_m, start, 1);
  const Pose asked{start.position_m + Vector3(0.0, 0.05, 0.0), turn_by(Vector3(0.0, 0.0, 0.4))};
  Pose before = start;
  int ticks = 0;
  for (; ticks < 2000; ++ticks) {
    const Pose reached = filter.step(asked);
    EXPECT_LE((reached.position_m - before.position_m).norm(), 0.1e-3 * (1.0 + 1e-12));
    EXPECT_LE(rotation_vector(reached.orientation * before.orientation.conjugate()).norm(), 0.5e-3 + 1e-9);
    before = reached;
    if (reached.position_m == asked.position_m && reached.orientation.coeffs() == asked.orientation.coeffs())
      break;
  }
  EXPECT_NEAR(ticks, 800, 2);  // 0.4 rad at 0.5 rad/s; the way of 0.05 m takes 0.5 s
}

TEST(HandWithoutParts, IsWhereItIsAsked) {
  HandFilter filter(HandModel{}, elbow_m, start, 1);
  const Pose asked{Vector3(0.1, 0.2, 0.3), turn_by(Vector3(1.0, 1.0, 0.0))};
  const Pose reached = filter.step(asked);
  EXPECT_EQ(reached.position_m, asked.position_m);
  EXPECT_EQ(reached.orientation.coeffs(), asked.orientation.coeffs());
}

TEST(HandFiles, BundledHandsAreRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(hand_folder)) {
    const auto hand = read_hand(entry.path());
    EXPECT_TRUE(hand) << hand.error().message;
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST(HandFiles, SeverityIsBetweenTheHandAndAnUnimpairedOne) {
  const auto file = hand_folder / "limited-wrist.json";
  const HandModel whole = read_hand(file, 1.0).value(), half = read_hand(file, 0.5).value(),
                  none = read_hand(file, 0.0).value();
  const auto deviation = [](const HandModel& hand) { return hand.wrist->range_rad[1]; };
  EXPECT_NEAR(deviation(whole).low, -5.0 * degree_rad, 1e-12);
  EXPECT_NEAR(deviation(none).low, -30.0 * degree_rad, 1e-12);
  EXPECT_NEAR(deviation(half).low, -17.5 * degree_rad, 1e-12);
  const auto tremor = hand_folder / "essential-tremor.json";
  EXPECT_EQ(read_hand(tremor, 0.0)->tremor->amplitude_m, 0.0);
}

TEST(HandFiles, WrongFieldsAreNamed) {
  const auto code_of = [](const char* text) {
    const auto hand = hand_from_json(Json::parse(text), "hand.json");
    return hand ? std::string("read") : hand.error().field;
  };
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a"})"), "read");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 2, "name": "a"})"), "spoonbill_hand");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1})"), "name");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a", "severity": 2})"), "severity");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a", "hat": 1})"), "hat");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a",
                        "speed": {"speed_mm_per_s": 100, "turn_deg_per_s": 20}})"),
            "speed.source");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a",
                        "tremor": {"band_hz": [12, 4], "amplitude_mm": 1, "turn_deg": 1, "source": "s"}})"),
            "tremor.band_hz");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a",
                        "wrist": {"deviation_deg": [-5, "x"], "stop_deg": 1, "source": "s"}})"),
            "wrist.deviation_deg");
  EXPECT_EQ(code_of(R"({"spoonbill_hand": 1, "name": "a",
                        "grip": {"grip": "teeth", "force_n": 1, "friction": 1, "source": "s"}})"),
            "grip.grip");
}

}  // namespace
}  // namespace spoonbill
