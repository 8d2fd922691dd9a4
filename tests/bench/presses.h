// What the tick's benchmarks run: a simulation, and what the hand does to it tick by tick.
#pragma once

#include <filesystem>
#include <vector>

#include "engine/simulation/simulation.h"
#include "haptic/device.h"
#include "haptic/recording.h"

namespace spoonbill {

struct Press {
  Scene scene;
  DeviceSpecification device;
  std::vector<DeviceReading> readings;  // one a tick
  std::vector<TimedCommand> commands;   // of the simulation
};

// A recording, as its own ticks had it.
Result<Press> recorded_press(const std::filesystem::path& recording);

// The same, its bodies of a plastic that only an implicit method steps.
Result<Press> stiff_press(const std::filesystem::path& recording);

// A block of clay with 60 mm edges and count^3 nodes, held at one end, pressed by a sphere from above over a
// second and let go, with that many relaxation steps a tick.
Press block_press(int count, int iterations);

}  // namespace spoonbill
