// Vectors that begin on a cache line, so that the widest vector load never straddles two.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace spoonbill {

inline constexpr std::size_t cache_line_bytes = 64;

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

}  // namespace spoonbill
