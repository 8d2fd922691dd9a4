#include "haptic/recording_lines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/simulation/simulation.h"

namespace spoonbill {

namespace {

// Largest difference between coordinates of two valid positions. Differences between valid orientations are
// far smaller.
constexpr std::int64_t delta_limit = 2 * reading_limit_nm;

constexpr const char* position_fields[3] = {"dx_nm", "dy_nm", "dz_nm"};

using Coordinate = std::function<std::int64_t(const DeviceReading&)>;

Json deltas(const DeviceReading& before, std::span<const DeviceReading> readings,
            const Coordinate& coordinate) {
  Json list = Json::array();
  std::int64_t last = coordinate(before);
  for (const DeviceReading& reading : readings) {
    const std::int64_t current = coordinate(reading);
    list.push_back(current - last);
    last = current;
  }
  return list;
}

bool all_zero(const Json& list) {
  return std::all_of(list.begin(), list.end(), [](const Json& item) { return item == 0; });
}

// Returns the running sums of a list of differences, starting from `value`; an empty list after an error.
std::vector<std::int64_t> read_sums(FieldReader& reader, const std::string& field, const Json& list,
                                    std::int64_t value, std::int64_t limit) {
  std::vector<std::int64_t> sums;
  for (const Json& item : list) {
    const bool too_large =
        item.is_number_unsigned() && item.get<std::uint64_t>() > std::uint64_t{delta_limit};
    const bool whole = item.is_number_integer() && !too_large;
    const std::int64_t delta = whole ? item.get<std::int64_t>() : 0;
    const std::string name = field + "[" + std::to_string(sums.size()) + "]";
    if (!whole || delta > delta_limit || delta < -delta_limit) {
      reader.refuse(name, "is " + json_excerpt(item) + ", must be a whole number within " +
                              std::to_string(delta_limit) + " of zero");
      return {};
    }
    value += delta;
    if (value > limit || value < -limit) {
      reader.refuse(name, "leads to " + std::to_string(value) + ", must stay within " +
                              std::to_string(limit) + " of zero");
      return {};
    }
    sums.push_back(value);
  }
  return sums;
}

void read_positions(FieldReader& reader, const DeviceReading& before, std::span<DeviceReading> readings) {
  const int count = static_cast<int>(readings.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char* field = position_fields[axis];
    if (!reader.has(field)) {
      reader.ignore(field);
      for (DeviceReading& reading : readings) reading.position_nm[axis] = before.position_nm[axis];
      continue;
    }
    const auto sums = read_sums(reader, field, reader.list(field, {count, count}), before.position_nm[axis],
                                reading_limit_nm);
    for (std::size_t i = 0; i < sums.size(); ++i) readings[i].position_nm[axis] = sums[i];
  }
}

void check_orientations(FieldReader& reader, std::span<const DeviceReading> readings) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].has_unit_orientation()) continue;
    reader.refuse("dq_e9",
                  "leads to an orientation that is not a unit quaternion at reading " + std::to_string(i));
    return;
  }
}

void read_orientations(FieldReader& reader, const DeviceReading& before, std::span<DeviceReading> readings) {
  const char* field = "dq_e9";
  if (!reader.has(field)) {
    reader.ignore(field);
    for (DeviceReading& reading : readings) {
      std::copy(std::begin(before.orientation_e9), std::end(before.orientation_e9), reading.orientation_e9);
    }
    return;
  }
  const Json& lists = reader.list(field, {4, 4});
  for (std::size_t k = 0; k < lists.size(); ++k) {
    const std::string name = field + ("[" + std::to_string(k) + "]");
    if (!lists[k].is_array() || lists[k].size() != readings.size()) {
      reader.refuse(
          name, "is " + json_excerpt(lists[k]) + ", must be a list of " + std::to_string(readings.size()));
      return;
    }
    const auto sums = read_sums(reader, name, lists[k], before.orientation_e9[k], 1'000'000'000);
    for (std::size_t i = 0; i < sums.size(); ++i) readings[i].orientation_e9[k] = sums[i];
  }
  check_orientations(reader, readings);
}

// Reads one whole number for each reading; returns false if the field is missing.
bool read_counts(FieldReader& reader, const char* field, std::span<DeviceReading> readings,
                 std::uint32_t DeviceReading::*member) {
  const int count = static_cast<int>(readings.size());
  if (!reader.has(field)) {
    reader.ignore(field);
    return false;
  }
  const Json& list = reader.list(field, {count, count});
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number_unsigned() || list[i].get<std::uint64_t>() > 0xffffffffu) {
      reader.refuse(field, "contains " + json_excerpt(list[i]) + ", must contain 32-bit whole numbers");
      break;
    }
    readings[i].*member = list[i].get<std::uint32_t>();
  }
  return true;
}

void read_buttons(FieldReader& reader, const DeviceReading& before, std::span<DeviceReading> readings) {
  if (read_counts(reader, "buttons", readings, &DeviceReading::buttons)) return;
  for (DeviceReading& reading : readings) reading.buttons = before.buttons;
}

Json device_to_json(const DeviceSpecification& device) {
  Json json;
  json["name"] = device.name;
  json["maximum_force_n"] = number_to_json(device.maximum_force_n);
  json["maximum_stiffness_n_per_m"] = number_to_json(device.maximum_stiffness_n_per_m);
  json["maximum_damping_n_s_per_m"] = number_to_json(device.maximum_damping_n_s_per_m);
  json["workspace_radius_m"] = number_to_json(device.workspace_radius_m);
  json["position_resolution_m"] = number_to_json(device.position_resolution_m);
  json["senses_orientation"] = device.senses_orientation;
  json["actuates_torque"] = device.actuates_torque;
  json["quiet_force_n"] = number_to_json(device.quiet_force_n);
  json["ramp_time_s"] = number_to_json(device.ramp_time_s);
  json["maximum_force_rate_n_per_s"] = number_to_json(device.maximum_force_rate_n_per_s);
  json["maximum_speed_m_per_s"] = number_to_json(device.maximum_speed_m_per_s);
  json["dead_man_buttons"] = device.dead_man_buttons;
  return json;
}

void read_optional(FieldReader& reader, const char* field, Range<double> range, double& value) {
  if (reader.has(field)) value = reader.number(field, range);
  reader.ignore(field);
}

void read_safety(FieldReader& reader, DeviceSpecification& device) {
  read_optional(reader, "quiet_force_n", device_quiet_force_range_n, device.quiet_force_n);
  read_optional(reader, "ramp_time_s", device_ramp_time_range_s, device.ramp_time_s);
  read_optional(reader, "maximum_force_rate_n_per_s", device_force_rate_range_n_per_s,
                device.maximum_force_rate_n_per_s);
  read_optional(reader, "maximum_speed_m_per_s", device_speed_range_m_per_s, device.maximum_speed_m_per_s);
  if (reader.has("dead_man_buttons")) {
    device.dead_man_buttons =
        static_cast<std::uint32_t>(reader.unsigned_integer("dead_man_buttons", 0xffffffffu));
  }
  reader.ignore("dead_man_buttons");
}

DeviceSpecification read_device(FieldReader reader) {
  DeviceSpecification device;
  device.name = reader.text("name");
  device.maximum_force_n = reader.number("maximum_force_n", device_force_range_n);
  device.maximum_stiffness_n_per_m =
      reader.number("maximum_stiffness_n_per_m", device_stiffness_range_n_per_m);
  device.maximum_damping_n_s_per_m =
      reader.number("maximum_damping_n_s_per_m", device_damping_range_n_s_per_m);
  device.workspace_radius_m = reader.number("workspace_radius_m", device_workspace_range_m);
  device.position_resolution_m = reader.number("position_resolution_m", device_resolution_range_m);
  device.senses_orientation = reader.boolean("senses_orientation");
  device.actuates_torque = reader.boolean("actuates_torque");
  read_safety(reader, device);
  reader.finish();
  return device;
}

}  // namespace

Json header_to_json(const RecordingHeader& header) {
  Json json;
  json["spoonbill_recording"] = recording_version;
  json["tick_s"] = tick_s;
  json["device"] = device_to_json(header.device);
  json["document"] = document_to_json(header.document);
  if (header.training) json["training"] = *header.training;
  return json;
}

Result<RecordingHeader> header_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  reader.version("spoonbill_recording", recording_version);
  reader.number("tick_s", {tick_s, tick_s});
  DeviceSpecification device = read_device(reader.inner("device"));
  const Json& document_json = reader.object("document");
  std::optional<Json> training;
  if (reader.has("training")) training = reader.object("training");
  reader.finish();
  if (!reader.status().ok()) return reader.status().error();
  auto document = document_from_json(document_json, source + ": document");
  if (!document.ok()) return document.error();
  return RecordingHeader{std::move(device), std::move(document).value(), std::move(training)};
}

Json motion_to_json(std::uint64_t tick, const DeviceReading& before,
                    std::span<const DeviceReading> readings) {
  Json json;
  json["tick"] = tick;
  json["ticks"] = readings.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Json list = deltas(before, readings, [axis](const DeviceReading& r) { return r.position_nm[axis]; });
    if (!all_zero(list)) json[position_fields[axis]] = std::move(list);
  }
  Json rotations = Json::array();
  bool rotated = false;
  for (std::size_t k = 0; k < 4; ++k) {
    rotations.push_back(
        deltas(before, readings, [k](const DeviceReading& r) { return r.orientation_e9[k]; }));
    rotated = rotated || !all_zero(rotations.back());
  }
  if (rotated) json["dq_e9"] = std::move(rotations);
  const auto has_other_buttons = [&](const DeviceReading& reading) {
    return reading.buttons != before.buttons;
  };
  if (std::any_of(readings.begin(), readings.end(), has_other_buttons)) {
    Json& buttons = json["buttons"] = Json::array();
    for (const DeviceReading& reading : readings) buttons.push_back(reading.buttons);
  }
  const auto has_missed = [](const DeviceReading& reading) { return reading.missed != 0; };
  if (std::any_of(readings.begin(), readings.end(), has_missed)) {
    Json& missed = json["missed"] = Json::array();
    for (const DeviceReading& reading : readings) missed.push_back(reading.missed);
  }
  return json;
}

void read_motion(FieldReader& reader, std::vector<DeviceReading>& readings) {
  const std::uint64_t count = reader.unsigned_integer("ticks", recording_line_ticks);
  if (reader.status().ok() && count == 0) reader.refuse("ticks", "is 0, must be from 1 to 100");
  if (!reader.status().ok()) return;
  const DeviceReading before = readings.empty() ? DeviceReading{} : readings.back();
  readings.resize(readings.size() + count);
  const std::span<DeviceReading> added(readings.end() - static_cast<std::ptrdiff_t>(count), readings.end());
  read_positions(reader, before, added);
  read_orientations(reader, before, added);
  read_buttons(reader, before, added);
  read_counts(reader, "missed", added, &DeviceReading::missed);
}

Status check_command(const Json& command, const std::string& source) {
  FieldReader reader(command, source);
  reader.text("command");
  for (const char* reserved : {"tick", "end"}) {
    if (reader.has(reserved)) reader.refuse(reserved, "cannot be an argument of a command");
  }
  if (!reader.status().ok()) return reader.status();
  if (!is_simulation_command(command)) return {};
  const auto parsed = command_from_json(command, source);
  return parsed.ok() ? Status() : Status(parsed.error());
}

Json command_line_to_json(std::uint64_t tick, const Json& command) {
  Json json;
  json["tick"] = tick;
  for (const auto& item : command.items()) json[item.key()] = item.value();
  return json;
}

std::string hash_text(std::uint64_t hash) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = digits[hash & 15];
  return text;
}

std::uint64_t read_hash(FieldReader& reader) {
  const std::string text = reader.text("state_hash");
  std::uint64_t hash = 0;
  for (const char c : text) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : (c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1);
    if (digit < 0 || text.size() != 16) {
      reader.refuse("state_hash", "is " + json_excerpt(Json(text)) + ", must be 16 hexadecimal digits");
      return 0;
    }
    hash = hash << 4 | static_cast<std::uint64_t>(digit);
  }
  if (text.empty()) reader.refuse("state_hash", "is empty, must be 16 hexadecimal digits");
  return hash;
}

}  // namespace spoonbill
