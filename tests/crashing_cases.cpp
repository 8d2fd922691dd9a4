// Cases that end their process, for run_suite_test: which of them passed must be known all the same.
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
