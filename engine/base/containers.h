// Containers that the standard library lacks: disjoint sets, and vectors aligned to cache lines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <numeric>
#include <vector>

namespace spoonbill {

inline constexpr std::size_t cache_line_bytes = 64;

// Allocates memory that starts at a multiple of cache_line_bytes, so that an aligned vector load never
// straddles two cache lines.
template <class T>
struct CacheLineAllocator {
  using value_type = T;

  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(cache_line_bytes)));
  }
  void deallocate(T* data, std::size_t) { ::operator delete(data, std::align_val_t(cache_line_bytes)); }

  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

// A partition of the items 0 to count - 1 into sets (union-find with path halving). Each item starts as a set
// of its own; join() merges two sets.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }

  // Returns the representative of the item's set, which is its lowest item.
  std::size_t find(std::size_t item) {
    while (parents_[item] != item) item = parents_[item] = parents_[parents_[item]];
    return item;
  }

  void join(std::size_t a, std::size_t b) {
    const std::size_t first = find(a), second = find(b);
    parents_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::size_t> parents_;
};

}  // namespace spoonbill
