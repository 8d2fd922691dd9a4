// Recordings made in code: a hand that moves, turns, presses and gives commands, without a simulation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "haptic/recording.h"

namespace spoonbill {

RecordingHeader sample_header();

// A wandering hand; the same for the same seed. It holds still, turned, or pressed now and then.
std::vector<DeviceReading> sample_readings(std::size_t count, unsigned seed);

// Stands for the state hash at a tick.
std::uint64_t pretended_hash(std::uint64_t tick);

// Writes `readings` with commands at several ticks and all checkpoints; the end only where `finish` is set.
Status write_sample_recording(const std::filesystem::path& file, const std::vector<DeviceReading>& readings,
                              bool finish);

// Replays a recording and records it again.
Status write_again(const Recording& recording, const std::filesystem::path& file);

}  // namespace spoonbill
