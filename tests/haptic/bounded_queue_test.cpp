#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "haptic/lock_free.h"
#include "tests/engine/allocations.h"

namespace spoonbill {
namespace {

TEST(BoundedQueue, KeepsOrderAndRefusesWhenFullOrEmpty) {
  BoundedQueue<int> queue(3);
  int value = -1;
  EXPECT_FALSE(queue.pop(value));
  EXPECT_EQ(value, -1);
  for (int round = 0; round < 5; ++round) {
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(queue.push(10 * round + k));
    EXPECT_FALSE(queue.push(99));
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(queue.pop(value));
      EXPECT_EQ(value, 10 * round + k);
    }
    EXPECT_FALSE(queue.pop(value));
  }
}

TEST(BoundedQueue, HoldsAtLeastOne) {
  BoundedQueue<int> queue(0);
  EXPECT_TRUE(queue.push(1));
  EXPECT_FALSE(queue.push(2));
}

TEST(BoundedQueue, ARefusedValueStaysAsItWas) {
  BoundedQueue<std::unique_ptr<int>> queue(1);
  ASSERT_TRUE(queue.push(std::make_unique<int>(1)));
  auto refused = std::make_unique<int>(2);
  const int* const address = refused.get();
  EXPECT_FALSE(queue.push(std::move(refused)));
  EXPECT_EQ(refused.get(), address);  // NOLINT(bugprone-use-after-move): a refused value is not moved
}

TEST(BoundedQueue, MemoryGoesRoundInsteadOfBeingFreed) {
  using Numbers = std::vector<int>;
  BoundedQueue<Numbers> queue(2);
  Numbers first(100, 5), second(100, 6), taken(100, 7), back;
  const std::size_t before = allocation_count();
  ASSERT_TRUE(queue.push(std::move(first)));
  ASSERT_TRUE(queue.pop(taken));
  ASSERT_TRUE(queue.push(std::move(second)));
  ASSERT_TRUE(queue.push(std::move(back)));
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(taken, Numbers(100, 5));
  EXPECT_EQ(back, Numbers(100, 7));  // NOLINT(bugprone-use-after-move): push() swaps it with the slot
}

}  // namespace
}  // namespace spoonbill
