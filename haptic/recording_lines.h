// Conversion of the individual lines of a recording from and to JSON; recording.h describes the format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/exchange/field_reader.h"
#include "haptic/recording.h"

namespace spoonbill {

// Maximum length in bytes of every line but the first, including its newline.
inline constexpr std::size_t recording_line_bytes_limit = std::size_t{32} << 20;

Json header_to_json(const RecordingHeader& header);
Result<RecordingHeader> header_from_json(const Json& json, const std::string& source);

// Makes a motion line. `before` is the reading before the first of `readings`.
Json motion_to_json(std::uint64_t tick, const DeviceReading& before, std::span<const DeviceReading> readings);

// Reads the fields of a motion line and appends to `readings`. After an error the appended readings are
// undefined.
void read_motion(FieldReader& reader, std::vector<DeviceReading>& readings);

// Checks that a command is an object with a text "command" and with neither "tick" nor "end". A command of
// the simulation must also be complete and within its ranges.
Status check_command(const Json& command, const std::string& source);

// Returns {"tick": ..., fields of the command}.
Json command_line_to_json(std::uint64_t tick, const Json& command);

// Returns the 16 hexadecimal digits of a hash.
std::string hash_text(std::uint64_t hash);
std::uint64_t read_hash(FieldReader& reader);

}  // namespace spoonbill
