// Flushes denormal numbers to zero while it lives: they cost a hundred times as much as others, and live and
// lock-step runs must agree on them. Per thread.
#pragma once

#include <immintrin.h>

namespace spoonbill {

class DenormalsFlushed {
 public:
  DenormalsFlushed() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero); }
  ~DenormalsFlushed() { _mm_setcsr(saved_); }
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  static constexpr unsigned flush_to_zero = 0x8000u;
  static constexpr unsigned denormals_are_zero = 0x0040u;
  unsigned saved_;
};

}  // namespace spoonbill
