#include "haptic/script.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/old_documents.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

namespace {

// Returns the value of the minimum-jerk curve at time t. Time and value go from 0 to 1. The curve starts and
// ends at rest, without a jump in acceleration.
double ease(double t) {
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

// Blends two orientations linearly along the shorter path and normalises the result. Uses no sine, so that
// all machines get the same bits.
Quaternion blend(const Quaternion& from, const Quaternion& to, double fraction) {
  const double sign = from.dot(to) < 0.0 ? -1.0 : 1.0;
  Quaternion sum;
  sum.coeffs() = (1.0 - fraction) * from.coeffs() + (sign * fraction) * to.coeffs();
  return sum.normalized();
}

constexpr std::size_t script_bytes_limit = std::size_t{16} << 20;
constexpr int step_limit = 10'000;
constexpr Range<double> time_range_s{0.0, static_cast<double>(script_tick_limit) * tick_s};
constexpr Range<double> reach_range_m{-10.0, 10.0};
constexpr double pi = 3.14159265358979323846;

// Reads a time as a number of ticks. A time that is not a whole number of milliseconds is an error, because
// rounding would change it silently.
std::uint64_t read_ticks(FieldReader& reader, const char* field, Range<double> range_s) {
  const double seconds = reader.number(field, range_s);
  const double ticks = std::round(seconds / tick_s);
  if (std::abs(seconds / tick_s - ticks) > 1e-6) {
    reader.refuse(field, "is " + number_text(seconds) + ", must be whole milliseconds");
  }
  return static_cast<std::uint64_t>(ticks);
}

Quaternion read_turn(FieldReader reader) {
  const Vector3 axis = reader.direction("axis");
  const double half = reader.number("degrees", {-360.0, 360.0}) * pi / 360.0;
  reader.finish();
  const Vector3 imaginary = std::sin(half) * axis;
  return Quaternion(std::cos(half), imaginary.x(), imaginary.y(), imaginary.z()).normalized();
}

// Converts the steps, one by one, into motions and commands with times.
class StepCompiler {
 public:
  StepCompiler(Script& script, std::string source) : script_(script), source_(std::move(source)) {}

  void add_step(const Json& json, FieldReader reader, std::size_t index) {
    if (reader.has("note")) reader.text("note");
    if (reader.has("at_s")) wait_until(reader);
    if (reader.has("command")) {
      add_command(json, index);
      return;
    }
    if (reader.has("start_mm")) {
      add_start(reader);
    } else if (reader.has("move_to_mm") || reader.has("turn_to")) {
      add_move(reader);
    } else if (reader.has("hold_s")) {
      extend(reader, read_ticks(reader, "hold_s", time_range_s), current_);
    } else if (reader.has("grip")) {
      current_.buttons =
          reader.boolean("grip") ? current_.buttons | button_main : current_.buttons & ~button_main;
    } else if (!reader.has("at_s")) {
      reader.refuse("has no action; known: start_mm, move_to_mm, turn_to, hold_s, grip, at_s, command");
    }
    reader.finish();
  }

  bool has_started() const { return started_; }
  const Status& failure() const { return failure_; }

 private:
  void wait_until(FieldReader& reader) {
    const std::uint64_t tick = read_ticks(reader, "at_s", time_range_s);
    if (tick < script_.tick_count()) {
      reader.refuse("at_s", "is earlier than the end of the previous step, which is at " +
                                number_text(static_cast<double>(script_.tick_count()) / 1000.0) + " s");
    } else if (tick > script_.tick_count()) {
      extend(reader, tick - script_.tick_count(), current_);
    }
  }

  void add_start(FieldReader& reader) {
    if (started_) reader.refuse("start_mm", "must come once, before the other motions");
    current_.pose.position_m = reader.position_m("start_mm", reach_range_m);
    if (reader.has("turn")) current_.pose.orientation = read_turn(reader.inner("turn"));
    script_.start = current_;
    started_ = true;
  }

  void add_move(FieldReader& reader) {
    HandTarget to = current_;
    if (reader.has("move_to_mm")) to.pose.position_m = reader.position_m("move_to_mm", reach_range_m);
    if (reader.has("turn_to")) to.pose.orientation = read_turn(reader.inner("turn_to"));
    extend(reader, read_ticks(reader, "over_s", {tick_s, time_range_s.high}), to);
  }

  void extend(FieldReader& reader, std::uint64_t ticks, const HandTarget& to) {
    if (!started_) reader.refuse("needs a start; put a step with start_mm before it");
    const std::uint64_t begin = script_.tick_count();
    if (begin + ticks > script_tick_limit)
      reader.refuse("makes the script longer than 10 minutes; shorten it");
    if (ticks > 0) script_.motions.push_back({begin, begin + ticks, current_, to});
    current_ = to;
  }

  void add_command(const Json& json, std::size_t index) {
    TimedCommand command{script_.tick_count(), json, source_ + ": steps[" + std::to_string(index) + "]"};
    command.command.erase("note");
    command.command.erase("at_s");
    failure_ = old_commands_.convert(command.command, command.origin);
    if (!failure_.ok()) return;
    FieldReader reader(command.command, command.origin);
    reader.text("command");
    failure_ = reader.status();
    if (failure_.ok() && is_simulation_command(command.command)) {
      const auto parsed = command_from_json(command.command, command.origin);
      if (!parsed.ok()) failure_ = parsed.error();
    }
    script_.commands.push_back(std::move(command));
  }

  Script& script_;
  std::string source_;
  HandTarget current_;
  bool started_ = false;
  OldCommands old_commands_;
  Status failure_;  // first error of a command
};

Hand read_hand(FieldReader reader) {
  Hand hand;
  hand.mass_kg = reader.number("mass_kg", hand_mass_range_kg);
  hand.stiffness_n_per_m = reader.number("stiffness_n_per_m", hand_stiffness_range_n_per_m);
  hand.damping_n_s_per_m = reader.number("damping_n_s_per_m", hand_damping_range_n_s_per_m);
  reader.finish();
  return hand;
}

}  // namespace

HandTarget Script::target_at(std::uint64_t tick) const {
  if (motions.empty()) return start;
  if (tick >= motions.back().end) return motions.back().to;
  const auto motion =
      std::upper_bound(motions.begin(), motions.end(), tick,
                       [](std::uint64_t value, const ScriptMotion& m) { return value < m.end; });
  const double fraction =
      ease(static_cast<double>(tick + 1 - motion->begin) / static_cast<double>(motion->end - motion->begin));
  HandTarget target = motion->from;
  const Vector3& from_m = motion->from.pose.position_m;
  target.pose.position_m = from_m + fraction * (motion->to.pose.position_m - from_m);
  target.pose.orientation = blend(motion->from.pose.orientation, motion->to.pose.orientation, fraction);
  return target;
}

Result<Script> script_from_json(const Json& json, const std::string& source,
                                const std::filesystem::path& folder) {
  FieldReader reader(json, source);
  Script script;
  reader.version("spoonbill_script", script_version);
  if (reader.has("note")) reader.text("note");
  reader.ignore("note");
  script.model_file = folder / reader.text("model");
  if (reader.has("hand")) script.hand = read_hand(reader.inner("hand"));
  reader.ignore("hand");

  StepCompiler compiler(script, source);
  const Json& steps = reader.list("steps", {1, step_limit});
  for (std::size_t i = 0; i < steps.size() && reader.status().ok() && compiler.failure().ok(); ++i) {
    compiler.add_step(steps[i], reader.element(steps[i], "steps", i), i);
  }
  reader.finish();
  if (!compiler.failure().ok()) return compiler.failure().error();
  if (!compiler.has_started()) reader.refuse("steps", "have no start; begin with a step with start_mm");
  if (!reader.status().ok()) return reader.status().error();
  return script;
}

Result<Script> read_script(const std::filesystem::path& file) {
  auto text = read_file(file, script_bytes_limit);
  if (!text.ok()) return text.error();
  auto json = parse_json(text.value(), file.string());
  if (!json.ok()) return json.error();
  auto script = script_from_json(json.value(), file.string(), file.parent_path());
  if (!script.ok()) return script.error();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(script->model_file, ignored)) {
    return Error{ErrorCode::unreadable,
                 file.string() + ": model: " + script->model_file.string() +
                     " is not a file; give its path relative to the folder of the script",
                 "model"};
  }
  return script;
}

Result<ScriptedDevice> ScriptedDevice::make(const Script& script) {
  auto handle = VirtualDevice::make(script.hand, script.start);
  if (!handle) return handle.error();
  return ScriptedDevice(script, std::move(handle).value());
}

std::optional<DeviceReading> ScriptedDevice::read() {
  handle_.set_target(script_->target_at(tick_++));
  return handle_.read();
}

}  // namespace spoonbill
