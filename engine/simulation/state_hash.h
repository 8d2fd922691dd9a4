// FNV-1a, 64 bits, over the bytes of plain values (Fowler, Noll and Vo 1991): the fingerprint of a state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace spoonbill {

class StateHash {
 public:
  // Four bytes at a time: one multiplication for each float.
  void add(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t bits;
      std::memcpy(&bits, values + i, sizeof bits);
      mix(bits);
    }
  }
  void add(const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) add(values[i]);
  }
  void add(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(std::uint64_t bits) {
    mix(static_cast<std::uint32_t>(bits));
    mix(static_cast<std::uint32_t>(bits >> 32));
  }

  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint32_t word) { hash_ = (hash_ ^ word) * 1099511628211ull; }

  std::uint64_t hash_ = 14695981039346656037ull;
};

}  // namespace spoonbill
