// Hands the newest value from one thread to another without waiting: the writer never blocks the reader, nor
// the reader the writer, and values in between are lost on purpose.
//
//   writer: fill writing(), then publish().    reader: if (take()) use reading().
//
// 1. Three slots: one is the writer's, one the reader's, one lies between them. Only slot numbers change
//    hands, by one atomic exchange that publishes what was written into the slot.
// 2. Exactly one thread calls writing() and publish(), exactly one take() and reading().
// 3. After publish(), writing() is another slot, with a value of some time ago: write all of it. So memory
// that
//    a value holds, as a vector's, is used again and again, and after a few rounds nothing is allocated.
// 4. reading() stays as it is until take() says true.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace spoonbill {

template <class T>
class TripleBuffer {
 public:
  explicit TripleBuffer(const T& initial) : slots_{Slot{initial}, Slot{initial}, Slot{initial}} {}
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  T& writing() { return slots_[writers_].value; }

  void publish() {
    writers_ = between_.exchange(writers_ | fresh_bit, std::memory_order_acq_rel) & slot_mask;
  }

  // Whether there was something newer than reading(), which is that now.
  bool take() {
    if ((between_.load(std::memory_order_relaxed) & fresh_bit) == 0) return false;
    readers_ = between_.exchange(readers_, std::memory_order_acq_rel) & slot_mask;
    return true;
  }

  const T& reading() const { return slots_[readers_].value; }

 private:
  static constexpr std::uint32_t slot_mask = 3;
  static constexpr std::uint32_t fresh_bit = 4;
  // No cache line holds what two threads write.
  static constexpr std::size_t cache_line = 64;

  struct alignas(cache_line) Slot {
    T value;
  };

  std::array<Slot, 3> slots_;
  alignas(cache_line) std::uint32_t writers_ = 0;
  alignas(cache_line) std::atomic<std::uint32_t> between_{1};
  alignas(cache_line) std::uint32_t readers_ = 2;
};

}  // namespace spoonbill
