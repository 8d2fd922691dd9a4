// Test cases, two of which end their process. run_suite_test checks that the results of the other cases are
// still known.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace {

TEST(Crashing, Passes) {}

TEST(Crashing, IsKilled) {
  std::raise(SIGKILL);
}

TEST(Crashing, Fails) {
  EXPECT_EQ(1, 2);
}

TEST(Crashing, IsSkipped) {
  GTEST_SKIP();
}

TEST(Crashing, Exits) {
  std::_Exit(0);
}

TEST(Crashing, PassesAtLast) {}

}  // namespace
