// The lines of a recording, one by one: what recording.h says about each, in both directions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/exchange/field_reader.h"
#include "haptic/recording/recording.h"

namespace spoonbill {

// Longest line but the first, its newline included.
inline constexpr std::size_t recording_line_bytes_limit = std::size_t{32} << 20;

Json header_to_json(const RecordingHeader& header);
Result<RecordingHeader> header_from_json(const Json& json, const std::string& source);

// `before` is the reading that precedes the first.
Json motion_to_json(std::uint64_t tick, const DeviceReading& before, std::span<const DeviceReading> readings);

// Takes a motion line's fields; appends to `readings`. After a problem what was appended means nothing.
void read_motion(FieldReader& reader, std::vector<DeviceReading>& readings);

// An object with a text "command"; complete and within its ranges where the simulation knows it.
Status check_command(const Json& command, const std::string& source);

// {"tick": ..., fields of the command}
Json command_line_to_json(std::uint64_t tick, const Json& command);

// A hash in its 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);
std::uint64_t read_hash(FieldReader& reader);

}  // namespace spoonbill
