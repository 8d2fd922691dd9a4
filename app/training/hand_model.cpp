#include "app/training/hand_model.h"

#include <array>

#include "app/training/exact_angles.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr int hand_version = 1;
constexpr std::size_t hand_file_limit_bytes = std::size_t{1} << 16;

// An unimpaired hand. Ranges of the wrist: usual clinical norms of active motion (American Academy of
// Orthopaedic Surgeons 1965): bend to either side 70 and 80 degrees, ulnar 30 and radial deviation 20,
// rotation 80 to either side. Grip: 231 N on a cylinder of 38.1 mm (PMC3855544).
constexpr std::array<Range<double>, wrist_turn_count> unimpaired_range_deg{
    {{-80.0, 70.0}, {-30.0, 20.0}, {-80.0, 80.0}}};
constexpr HandSpeed unimpaired_speed{};
constexpr double unimpaired_grip_n = 231.0;

double between(double unimpaired, double impaired, double severity) {
  return unimpaired + severity * (impaired - unimpaired);
}

Range<double> read_range(FieldReader& reader, const std::string& field, Range<double> limits) {
  const Json& list = reader.list(field, {2, 2});
  if (!list.is_array() || list.size() != 2) return limits;
  if (!list[0].is_number() || !list[1].is_number()) {
    reader.refuse(field, "must be two numbers", ErrorCode::wrong_type);
    return limits;
  }
  const Range<double> range{list[0].get<double>(), list[1].get<double>()};
  if (limits.contains(range.low) && limits.contains(range.high) && range.low < range.high) return range;
  reader.refuse(field, "must be two ascending numbers from " + number_text(limits.low) + " to " +
                           number_text(limits.high));
  return limits;
}

WristModel read_wrist(FieldReader reader, double severity) {
  WristModel wrist;
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const std::string field = std::string(wrist_turn_names[k]) + "_deg";
    const Range<double>& usual = unimpaired_range_deg[k];
    const Range<double> impaired = reader.has(field) ? read_range(reader, field, wrist_range_deg) : usual;
    wrist.range_rad[k] = {degree_rad * between(usual.low, impaired.low, severity),
                          degree_rad * between(usual.high, impaired.high, severity)};
  }
  wrist.stop_rad = degree_rad * reader.number("stop_deg", wrist_stop_range_deg);
  reader.text("source");
  reader.finish();
  return wrist;
}

HandSpeed read_speed(FieldReader reader, double severity) {
  HandSpeed speed;
  speed.speed_m_per_s = between(unimpaired_speed.speed_m_per_s,
                                reader.length_m("speed_mm_per_s", hand_speed_range_m_per_s), severity);
  speed.turn_rad_per_s =
      between(unimpaired_speed.turn_rad_per_s,
              degree_rad * reader.number("turn_deg_per_s", hand_turn_speed_range_deg_per_s), severity);
  reader.text("source");
  reader.finish();
  return speed;
}

TremorModel read_tremor(FieldReader reader, double severity) {
  TremorModel tremor;
  tremor.band_hz = read_range(reader, "band_hz", tremor_frequency_range_hz);
  tremor.amplitude_m = severity * reader.length_m("amplitude_mm", tremor_amplitude_range_m);
  tremor.turn_rad = severity * degree_rad * reader.number("turn_deg", tremor_turn_range_deg);
  reader.text("source");
  reader.finish();
  return tremor;
}

GripModel read_grip(FieldReader reader, double severity) {
  GripModel grip;
  grip.kind = static_cast<GripKind>(reader.choose("grip", grip_kind_names));
  grip.force_n = between(unimpaired_grip_n, reader.number("force_n", grip_force_range_n), severity);
  grip.friction = reader.number("friction", grip_friction_range);
  if (grip.kind == GripKind::fist) {
    grip.breadth_m = reader.length_m("breadth_mm", grip_breadth_range_m);
  } else {
    grip.pad_radius_m = reader.length_m("pad_radius_mm", pad_radius_range_m);
  }
  reader.text("source");
  reader.finish();
  return grip;
}

}  // namespace

Result<HandModel> hand_from_json(const Json& json, const std::string& source,
                                 std::optional<double> severity) {
  FieldReader reader(json, source);
  reader.version("spoonbill_hand", hand_version);
  HandModel hand;
  hand.name = reader.text("name");
  hand.severity = reader.has("severity") ? reader.number("severity", severity_range) : 1.0;
  if (severity) hand.severity = *severity;
  if (reader.has("wrist")) hand.wrist = read_wrist(reader.inner("wrist"), hand.severity);
  if (reader.has("speed")) hand.speed = read_speed(reader.inner("speed"), hand.severity);
  if (reader.has("tremor")) hand.tremor = read_tremor(reader.inner("tremor"), hand.severity);
  if (reader.has("grip")) hand.grip = read_grip(reader.inner("grip"), hand.severity);
  reader.finish();
  if (Status status = reader.status(); !status) return status.error();
  return hand;
}

Result<HandModel> read_hand(const std::filesystem::path& file, std::optional<double> severity) {
  const auto text = read_file(file, hand_file_limit_bytes);
  if (!text) return text.error();
  const auto json = parse_json(text.value(), file.string());
  if (!json) return json.error();
  return hand_from_json(json.value(), file.string(), severity);
}

std::string name_of_hand(const std::string& hand) {
  return hand.empty() ? "not modelled" : hand;
}

double held_across_nm(const GripModel& grip) {
  const double friction_n = grip.friction * grip.force_n;
  return grip.kind == GripKind::fist ? friction_n * grip.breadth_m / 3.0
                                     : 4.0 / 3.0 * friction_n * grip.pad_radius_m;
}

double held_about_nm(const GripModel& grip, double width_m) {
  return grip.friction * grip.force_n * width_m;
}

}  // namespace spoonbill
