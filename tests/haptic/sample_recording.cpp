#include "tests/haptic/sample_recording.h"

#include <random>

#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {

namespace {

Json command_of(std::uint64_t tick) {
  if (tick % 2 == 0) return Json{{"command", "set_camera"}, {"distance_mm", 250.5}, {"tick_marks", {1, 2}}};
  return command_to_json(PlacePlane{{Vector3(0.01, 0.0, 0.0), Vector3::UnitX()}});
}

}  // namespace

RecordingHeader sample_header() {
  DeviceSpecification device;
  device.name = "virtual";
  return {device, sample_document()};
}

std::vector<DeviceReading> sample_readings(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto small = [&random] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  std::vector<DeviceReading> readings;
  Pose pose{Vector3(0.06, 0.04, 0.0), Quaternion::Identity()};
  for (std::size_t tick = 0; tick < count; ++tick) {
    const std::size_t phase = tick / 150 % 4;
    if (phase != 1) pose.position_m += 1e-5 * Vector3(small(), small(), small());
    if (phase == 2) {
      pose.orientation.coeffs() += 1e-3 * Eigen::Vector4d(small(), small(), small(), small());
      pose.orientation.normalize();
    }
    readings.push_back(DeviceReading::from(pose, phase == 3 ? button_main : 0u));
  }
  return readings;
}

std::uint64_t pretended_hash(std::uint64_t tick) {
  return (tick + 1) * 0x9e3779b97f4a7c15u;
}

Status write_sample_recording(const std::filesystem::path& file, const std::vector<DeviceReading>& readings,
                              bool finish) {
  auto writer = RecordingWriter::create(file, sample_header());
  if (!writer.ok()) return writer.error();
  for (const DeviceReading& reading : readings) {
    const std::uint64_t tick = writer->tick();
    Status status;
    if (writer->checkpoint_due()) status = writer->checkpoint(pretended_hash(tick));
    if (status.ok() && (tick == 0 || tick % 373 == 250)) status = writer->command(command_of(tick));
    if (status.ok() && tick == 0) status = writer->command(command_of(1));
    if (status.ok()) status = writer->reading(reading);
    if (!status.ok()) return status;
  }
  if (!finish) return {};
  if (Status finished = writer->finish(pretended_hash(writer->tick())); !finished) return finished;
  return writer->commit();
}

Status write_again(const Recording& recording, const std::filesystem::path& file) {
  auto writer = RecordingWriter::create(file, recording.header);
  if (!writer.ok()) return writer.error();
  std::size_t next_command = 0;
  const auto give_commands = [&] {
    Status status;
    for (; status.ok() && next_command < recording.commands.size() &&
           recording.commands[next_command].tick == writer->tick();
         ++next_command) {
      status = writer->command(recording.commands[next_command].command);
    }
    return status;
  };
  for (const DeviceReading& reading : recording.readings) {
    if (writer->checkpoint_due()) {
      if (Status status = writer->checkpoint(pretended_hash(writer->tick())); !status.ok()) return status;
    }
    if (Status status = give_commands(); !status.ok()) return status;
    if (Status status = writer->reading(reading); !status.ok()) return status;
  }
  if (Status status = give_commands(); !status.ok()) return status;
  if (!recording.end) return {};
  if (Status finished = writer->finish(recording.end->state_hash); !finished) return finished;
  return writer->commit();
}

}  // namespace spoonbill
