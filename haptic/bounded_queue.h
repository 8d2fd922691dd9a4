// Hands every value from one thread to another, in order and without waiting; a full queue refuses.
//
// Exactly one thread pushes and one pops. A value changes places with what the slot held, in both directions:
// so the thread that pops frees nothing, and what it no longer needs, as a vector's memory, goes back to the
// thread that pushes and is freed or used again there.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace spoonbill {

// T starts as T().
template <class T>
class BoundedQueue {
  static_assert(std::is_nothrow_swappable_v<T>);

 public:
  // Holds as many values as `capacity` says, at least one. Allocates here and never again.
  explicit BoundedQueue(std::size_t capacity) : slots_(std::max<std::size_t>(capacity, 1)) {}
  BoundedQueue(const BoundedQueue&) = delete;
  BoundedQueue& operator=(const BoundedQueue&) = delete;

  // False, and the value as it was, where the queue is full; else `value` is what was popped some time ago.
  bool push(T&& value) noexcept {
    const std::size_t end = pushed_.load(std::memory_order_relaxed);
    if (end - popped_.load(std::memory_order_acquire) == slots_.size()) return false;
    swap_with_slot(end, value);
    pushed_.store(end + 1, std::memory_order_release);
    return true;
  }

  // As copying T does, this may allocate.
  bool push(const T& value) {
    T copy(value);
    return push(std::move(copy));
  }

  // False, and `value` as it was, where the queue is empty.
  bool pop(T& value) noexcept {
    const std::size_t begin = popped_.load(std::memory_order_relaxed);
    if (begin == pushed_.load(std::memory_order_acquire)) return false;
    swap_with_slot(begin, value);
    popped_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  // The threads count in different cache lines.
  static constexpr std::size_t cache_line = 64;

  // Counts only grow: at a million a second they last longer than half a million years.
  void swap_with_slot(std::size_t count, T& value) noexcept {
    using std::swap;
    swap(slots_[count % slots_.size()], value);
  }

  alignas(cache_line) std::atomic<std::size_t> pushed_{0};
  alignas(cache_line) std::atomic<std::size_t> popped_{0};
  std::vector<T> slots_;
};

}  // namespace spoonbill
