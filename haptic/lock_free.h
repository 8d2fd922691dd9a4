// Lock-free exchange between two threads: TripleBuffer passes on the newest value, BoundedQueue every value.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/containers.h"

namespace spoonbill {

// Passes the newest value from one thread to another. Neither thread ever waits. A value that the reader does
// not fetch in time is overwritten.
//
//   writer: fill writing(), then publish().    reader: if (update_reading()) use reading().
//
// 1. The writer owns one slot, the reader another, and a third is between them. Publishing and updating swap
//    slot numbers by one atomic exchange, which also publishes the contents of the slot.
// 2. Exactly one thread calls writing() and publish(), exactly one calls update_reading() and reading().
// 3. After publish(), writing() is a different slot with an older value: overwrite all of it. Memory owned by
//    a value, such as a vector's, is reused, so that nothing is allocated after a few rounds.
// 4. reading() does not change until update_reading() returns true.
template <class T>
class TripleBuffer {
 public:
  explicit TripleBuffer(const T& initial) : slots_{Slot{initial}, Slot{initial}, Slot{initial}} {}
  // Calls `prepare` with each slot, for example to reserve memory that a copy of `initial` has not reserved.
  template <class Prepare>
  TripleBuffer(const T& initial, const Prepare& prepare) : TripleBuffer(initial) {
    for (Slot& slot : slots_) prepare(slot.value);
  }
  TripleBuffer(const TripleBuffer&) = delete;
  TripleBuffer& operator=(const TripleBuffer&) = delete;

  T& writing() { return slots_[writers_].value; }

  void publish() {
    writers_ = between_.exchange(writers_ | fresh_bit, std::memory_order_acq_rel) & slot_mask;
  }

  // Returns true and updates reading() if a newer value has been published since the last call.
  bool update_reading() {
    if ((between_.load(std::memory_order_relaxed) & fresh_bit) == 0) return false;
    readers_ = between_.exchange(readers_, std::memory_order_acq_rel) & slot_mask;
    return true;
  }

  const T& reading() const { return slots_[readers_].value; }

 private:
  static constexpr std::uint32_t slot_mask = 3;
  static constexpr std::uint32_t fresh_bit = 4;

  struct alignas(cache_line_bytes) Slot {
    T value;
  };

  std::array<Slot, 3> slots_;
  alignas(cache_line_bytes) std::uint32_t writers_ = 0;
  alignas(cache_line_bytes) std::atomic<std::uint32_t> between_{1};
  alignas(cache_line_bytes) std::uint32_t readers_ = 2;
};

// Passes every value from one thread to another, in order and without waiting. A full queue rejects the
// value.
//
// Exactly one thread pushes and exactly one thread pops. push() and pop() swap the value with the contents of
// a slot, so the popping thread frees nothing: memory that it no longer needs returns to the pushing thread.
// T must be default-constructible; slots start as T().
template <class T>
class BoundedQueue {
  static_assert(std::is_nothrow_swappable_v<T>);

 public:
  // Makes a queue for `capacity` values, at least one. Only the constructor allocates.
  explicit BoundedQueue(std::size_t capacity) : slots_(std::max<std::size_t>(capacity, 1)) {}
  BoundedQueue(const BoundedQueue&) = delete;
  BoundedQueue& operator=(const BoundedQueue&) = delete;

  // Returns false and leaves `value` unchanged if the queue is full. Otherwise swaps `value` with the
  // contents of the slot: T(), or what the argument of an earlier pop() contained before the call.
  bool push(T&& value) noexcept {
    const std::size_t end = pushed_.load(std::memory_order_relaxed);
    if (end - popped_.load(std::memory_order_acquire) == slots_.size()) return false;
    swap_with_slot(end, value);
    pushed_.store(end + 1, std::memory_order_release);
    return true;
  }

  // Pushes a copy. Copying T may allocate.
  bool push(const T& value) {
    T copy(value);
    return push(std::move(copy));
  }

  // Returns false and leaves `value` unchanged if the queue is empty.
  bool pop(T& value) noexcept {
    const std::size_t begin = popped_.load(std::memory_order_relaxed);
    if (begin == pushed_.load(std::memory_order_acquire)) return false;
    swap_with_slot(begin, value);
    popped_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  // Swaps the value with the contents of a slot. The counters never wrap: at a million values a second they
  // last more than half a million years.
  void swap_with_slot(std::size_t count, T& value) noexcept {
    using std::swap;
    swap(slots_[count % slots_.size()], value);
  }

  alignas(cache_line_bytes) std::atomic<std::size_t> pushed_{0};
  alignas(cache_line_bytes) std::atomic<std::size_t> popped_{0};
  std::vector<T> slots_;
};

}  // namespace spoonbill
