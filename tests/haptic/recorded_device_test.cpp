// Tests the device fields of a recording's header, including recordings that are older than the safety chain.
#include <gtest/gtest.h>

#include "haptic/recording_lines.h"
#include "tests/engine/refusal.h"
#include "tests/haptic/sample_recording.h"

namespace spoonbill {
namespace {

const char* const safety_fields[] = {"quiet_force_n", "ramp_time_s", "maximum_force_rate_n_per_s",
                                     "maximum_speed_m_per_s", "dead_man_buttons"};

TEST(RecordedDevice, KeepsWhatTheSafetyChainNeeds) {
  RecordingHeader header = sample_header();
  header.device.quiet_force_n = 0.3;
  header.device.ramp_time_s = 2.0;
  header.device.maximum_force_rate_n_per_s = 500.0;
  header.device.maximum_speed_m_per_s = 0.7;
  header.device.dead_man_buttons = 0x80000001u;
  const auto read = header_from_json(header_to_json(header), "a");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->device.quiet_force_n, 0.3);
  EXPECT_EQ(read->device.ramp_time_s, 2.0);
  EXPECT_EQ(read->device.maximum_force_rate_n_per_s, 500.0);
  EXPECT_EQ(read->device.maximum_speed_m_per_s, 0.7);
  EXPECT_EQ(read->device.dead_man_buttons, 0x80000001u);
}

TEST(RecordedDevice, TakesTheDefaultsWhereARecordingHasNone) {
  Json json = header_to_json(sample_header());
  for (const char* field : safety_fields) ASSERT_EQ(json["device"].erase(field), 1u);
  const auto read = header_from_json(json, "old");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const DeviceSpecification defaults;
  EXPECT_EQ(read->device.quiet_force_n, defaults.quiet_force_n);
  EXPECT_EQ(read->device.ramp_time_s, defaults.ramp_time_s);
  EXPECT_EQ(read->device.maximum_force_rate_n_per_s, defaults.maximum_force_rate_n_per_s);
  EXPECT_EQ(read->device.maximum_speed_m_per_s, defaults.maximum_speed_m_per_s);
  EXPECT_EQ(read->device.dead_man_buttons, defaults.dead_man_buttons);
}

TEST(RecordedDevice, NamesTheFieldThatIsOutOfRange) {
  for (const char* field : safety_fields) {
    Json json = header_to_json(sample_header());
    json["device"][field] = -1;
    const auto read = header_from_json(json, "bad");
    ASSERT_FALSE(read.ok()) << field;
    EXPECT_EQ(Refusal(read), Refusal(ErrorCode::out_of_range, std::string("device.") + field));
  }
}

}  // namespace
}  // namespace spoonbill
