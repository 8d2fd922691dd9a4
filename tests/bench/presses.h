// Presses that the tick's benchmarks run. A press is a scene and the hand's input in each tick.
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
  std::vector<DeviceReading> readings;  // input of the hand, one reading per tick
  std::vector<TimedCommand> commands;   // commands to the simulation
};

// Reads a recording and returns its inputs tick by tick.
Result<Press> recorded_press(const std::filesystem::path& recording);

// Reads a recording as recorded_press() does, and replaces the material of each body by ABS, a plastic so
// stiff that it requires the implicit solver.
Result<Press> stiff_press(const std::filesystem::path& recording);

// Returns a press of a block of clay with 60 mm edges and count^3 nodes, fixed at one end. A sphere presses
// it from above within a second and releases it. Each tick takes `substeps` substeps, or more if the strain
// requires them.
Press block_press(int count, int substeps);

}  // namespace spoonbill
