// Presses that the tick's benchmarks run: a simulation, and the hand's input tick by tick.
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
  std::vector<DeviceReading> readings;  // one per tick
  std::vector<TimedCommand> commands;   // commands to the simulation
};

// Reads the inputs of a recording, tick by tick as they were recorded.
Result<Press> recorded_press(const std::filesystem::path& recording);

// Reads a recording like recorded_press(), but the bodies are of a plastic so stiff that only the implicit
// method can step it.
Result<Press> stiff_press(const std::filesystem::path& recording);

// A block of clay with 60 mm edges and count^3 nodes, fixed at one end. A sphere presses it from above within
// a second and releases it; each tick takes `substeps` substeps, unless strain requires more.
Press block_press(int count, int substeps);

}  // namespace spoonbill
