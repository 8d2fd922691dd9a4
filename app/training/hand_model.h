// A model of a person's hand, between the device and the spoon: what it cannot do, and how it trembles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/training/tremor.h"
#include "app/training/wrist.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// How fast a hand moves and turns at most.
struct HandSpeed {
  double speed_m_per_s = 2.0;
  double turn_rad_per_s = 12.0;
};

enum class GripKind { fist, pinch };
inline constexpr const char* grip_kind_names[] = {"fist", "pinch"};

// The grip of a hand on a handle. The torque that it holds is
//   about the handle   T = mu G D         (Pheasant and O'Neill 1975; D: width of the handle)
//   across it, fist    T = mu G b / 3     (pressure that falls linearly from the fist's centre, on both
//   sides) across it, pinch   T = (4/3) mu G a   (two round pads of even pressure)
// with the compressive force G, the friction mu, the fist's breadth b and the pads' radius a.
struct GripModel {
  GripKind kind = GripKind::fist;
  double force_n = 231.0;
  double friction = 0.53;
  double breadth_m = 0.08;      // of a fist
  double pad_radius_m = 0.008;  // of a pinch
};

// Plain data. A part that is empty does not hinder the hand.
struct HandModel {
  std::string name;
  double severity = 0.0;  // for reports; the other members are those of this severity
  std::optional<WristModel> wrist;
  std::optional<HandSpeed> speed;
  std::optional<TremorModel> tremor;
  std::optional<GripModel> grip;
};

inline constexpr Range<double> severity_range{0.0, 1.0};
inline constexpr Range<double> hand_speed_range_m_per_s{0.01, 2.0};
inline constexpr Range<double> hand_turn_speed_range_deg_per_s{1.0, 720.0};
inline constexpr Range<double> grip_force_range_n{0.1, 1000.0};
inline constexpr Range<double> grip_friction_range{0.01, 2.0};
inline constexpr Range<double> grip_breadth_range_m{0.01, 0.15};
inline constexpr Range<double> pad_radius_range_m{0.001, 0.02};

// Reads a hand:
//
//   {"spoonbill_hand": 1, "name": "limited wrist and tremor", "severity": 1,
//    "wrist": {"bend_deg": [-10, 10], "deviation_deg": [-5, 5], "rotation_deg": [-20, 20], "stop_deg": 2,
//              "source": "..."},
//    "speed": {"speed_mm_per_s": 100, "turn_deg_per_s": 40, "source": "..."},
//    "tremor": {"band_hz": [4, 12], "amplitude_mm": 2, "turn_deg": 1, "source": "..."},
//    "grip": {"grip": "fist", "force_n": 40, "friction": 0.53, "breadth_mm": 80, "source": "..."}}
//
// Every part is optional and names where its values are from. They are those of severity 1. At a lower
// severity s, they are u + s (v - u), with the value v of the file and u of an unimpaired hand. `severity`
// replaces that of the file.
Result<HandModel> read_hand(const std::filesystem::path& file, std::optional<double> severity = {});
Result<HandModel> hand_from_json(const Json& json, const std::string& source,
                                 std::optional<double> severity = {});

// Returns the name of a hand in reports: "not modelled" for an empty one.
std::string name_of_hand(const std::string& hand);

// Returns the largest torque that a grip holds across and about a handle of a width, N m.
double held_across_nm(const GripModel& grip);
double held_about_nm(const GripModel& grip, double width_m);

}  // namespace spoonbill
