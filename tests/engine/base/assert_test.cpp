#include "engine/base/assert.h"

#include <gtest/gtest.h>

#include <string>

namespace spoonbill {
namespace {

int checked(int count) {
  SPOONBILL_ASSERT(count > 0);
  return count;
}

TEST(Assert, PassesWhatHolds) {
  EXPECT_EQ(checked(3), 3);
}

TEST(Assert, EndsTheProcessWithoutAHandler) {
  EXPECT_DEATH(checked(0), "'count > 0' does not hold \\(.*assert_test.cpp:[0-9]+\\)");
}

TEST(Assert, IsThrownByAHandlerThatThrows) {
  const AssertionHandler previous = set_assertion_handler(throw_failed_assertion);
  std::string text;
  try {
    checked(-1);
  } catch (const FailedAssertion& failure) {
    text = failure.what();
  }
  set_assertion_handler(previous);
  EXPECT_NE(text.find("'count > 0' does not hold"), std::string::npos) << text;
}

TEST(Assert, ChecksWholeStructuresInDebugBuildsAlone) {
  int calls = 0;
  const auto walk = [&calls] {
    ++calls;
    return true;
  };
  SPOONBILL_ASSERT_DEBUG(walk());
#ifdef NDEBUG
  EXPECT_EQ(calls, 0);
#else
  EXPECT_EQ(calls, 1);
#endif
}

}  // namespace
}  // namespace spoonbill
