#include <gtest/gtest.h>

#include <string>

#include "haptic/lock_free.h"

namespace spoonbill {
namespace {

TEST(TripleBuffer, StartsWithTheInitialValueAndNothingNew) {
  TripleBuffer<std::string> buffer("first");
  EXPECT_FALSE(buffer.update_reading());
  EXPECT_EQ(buffer.reading(), "first");
  EXPECT_EQ(buffer.writing(), "first");
}

TEST(TripleBuffer, TheReaderSeesNothingBeforePublishAndNothingTwice) {
  TripleBuffer<int> buffer(0);
  buffer.writing() = 7;
  EXPECT_FALSE(buffer.update_reading());
  buffer.publish();
  EXPECT_EQ(buffer.reading(), 0);
  EXPECT_TRUE(buffer.update_reading());
  EXPECT_EQ(buffer.reading(), 7);
  EXPECT_FALSE(buffer.update_reading());
  EXPECT_EQ(buffer.reading(), 7);
}

TEST(TripleBuffer, TheNewestWins) {
  TripleBuffer<int> buffer(0);
  for (int value = 1; value <= 10; ++value) {
    buffer.writing() = value;
    buffer.publish();
  }
  EXPECT_TRUE(buffer.update_reading());
  EXPECT_EQ(buffer.reading(), 10);
  EXPECT_FALSE(buffer.update_reading());
}

TEST(TripleBuffer, WritingNeverTouchesWhatIsRead) {
  TripleBuffer<int> buffer(0);
  buffer.writing() = 1;
  buffer.publish();
  ASSERT_TRUE(buffer.update_reading());
  for (int value = 2; value < 20; ++value) {
    buffer.writing() = value;
    EXPECT_EQ(buffer.reading(), 1);
    buffer.publish();
    EXPECT_EQ(buffer.reading(), 1);
  }
  ASSERT_TRUE(buffer.update_reading());
  EXPECT_EQ(buffer.reading(), 19);
}

}  // namespace
}  // namespace spoonbill
