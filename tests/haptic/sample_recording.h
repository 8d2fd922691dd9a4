// Makes recordings in code, without a simulation: a hand that moves, turns, presses and gives commands.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "haptic/recording.h"

namespace spoonbill {

RecordingHeader sample_header();

// Returns the readings of a wandering hand, which are the same for the same seed. At times the hand holds
// still, is turned, or presses.
std::vector<DeviceReading> sample_readings(std::size_t count, unsigned seed);

// Returns a made-up value in place of the state hash at a tick.
std::uint64_t pretended_hash(std::uint64_t tick);

// Writes `readings`, with commands at several ticks and all checkpoints. Writes the end of the recording only
// if `finish` is true.
Status write_sample_recording(const std::filesystem::path& file, const std::vector<DeviceReading>& readings,
                              bool finish);

// Writes the header, commands and readings of a recording to a new file, with pretended_hash() at the
// checkpoints.
Status write_again(const Recording& recording, const std::filesystem::path& file);

}  // namespace spoonbill
