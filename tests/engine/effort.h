// How much a test tries. Under a sanitizer, ten times slower, a part of it meets the same code.
#pragma once

#include <cstdlib>

namespace spoonbill {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

// A quarter of the trials under a sanitizer.
constexpr int effort(int trials) {
  return sanitized ? (trials + 3) / 4 : trials;
}

// How many random cases a test tries: `full` where SPOONBILL_FULL is set in the environment.
inline int random_cases(int quick, int full) {
  return std::getenv("SPOONBILL_FULL") != nullptr ? full : effort(quick);
}

// Said of tests that take a sanitizer a minute, and of which shorter ones meet the same code.
inline constexpr const char* long_when_sanitized =
    "a minute under a sanitizer, which shorter tests tell as much";

}  // namespace spoonbill
