// Tests TripleBuffer and BoundedQueue with two threads. The tests check only properties that hold for any
// scheduling.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "haptic/lock_free.h"

namespace spoonbill {
namespace {

// The block is long enough for a torn value to be noticed.
using Block = std::array<std::uint64_t, 64>;

Block block_of(std::uint64_t number) {
  Block block;
  for (std::size_t k = 0; k < block.size(); ++k) block[k] = number + k;
  return block;
}

TEST(TripleBufferThreads, ValuesAreWholeAndNeverGoBack) {
  constexpr std::uint64_t count = 200'000;
  TripleBuffer<Block> buffer(block_of(0));
  std::thread writer([&buffer] {
    for (std::uint64_t number = 1; number <= count; ++number) {
      buffer.writing() = block_of(number);
      buffer.publish();
    }
  });
  std::uint64_t last = 0, torn = 0, backward = 0, unchanged = 0;
  while (last < count) {
    if (!buffer.update_reading()) {
      std::this_thread::yield();
      continue;
    }
    const Block& block = buffer.reading();
    torn += block != block_of(block[0]) ? 1 : 0;
    backward += block[0] < last ? 1 : 0;
    unchanged += block[0] == last ? 1 : 0;
    last = block[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backward, 0u);
  EXPECT_EQ(unchanged, 0u);
  EXPECT_FALSE(buffer.update_reading());
}

TEST(BoundedQueueThreads, EveryValueArrivesOnceAndInOrder) {
  constexpr std::uint64_t count = 100'000;
  BoundedQueue<std::vector<std::uint64_t>> queue(16);
  std::thread producer([&queue] {
    std::vector<std::uint64_t> value;
    for (std::uint64_t number = 0; number < count; ++number) {
      value.assign({number, 2 * number});
      while (!queue.push(std::move(value))) std::this_thread::yield();  // NOLINT: refused, so not moved from
    }
  });
  std::uint64_t wrong = 0;
  std::vector<std::uint64_t> value;
  for (std::uint64_t number = 0; number < count; ++number) {
    while (!queue.pop(value)) std::this_thread::yield();
    wrong += value == std::vector<std::uint64_t>{number, 2 * number} ? 0 : 1;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_FALSE(queue.pop(value));
}

}  // namespace
}  // namespace spoonbill
