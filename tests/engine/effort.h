// Numbers of cases that tests try. Under a sanitizer, which is ten times slower, fewer cases run the same
// code.
#pragma once

#include <cstdlib>

namespace spoonbill {

#ifdef SPOONBILL_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

// Returns the number of trials, or under a sanitizer a quarter of it, rounded up.
constexpr int effort(int trials) {
  return sanitized ? (trials + 3) / 4 : trials;
}

// Returns true if tests that take several seconds are run too, as in tests/run --full.
inline bool is_full_run() {
  return std::getenv("SPOONBILL_FULL") != nullptr;
}

// Returns true if tests that take minutes are run too, as in tests/run --long random.
inline bool is_long_run() {
  return std::getenv("SPOONBILL_LONG") != nullptr;
}

// Returns the number of random cases to try: `many` in a long run, otherwise `quick`, or under a sanitizer a
// quarter of `quick`.
inline int random_cases(int quick, int many) {
  return is_long_run() ? many : effort(quick);
}

// Reasons to skip a test.
inline constexpr const char* only_in_full = "takes several seconds; runs only if SPOONBILL_FULL is set";
inline constexpr const char* only_in_long = "takes minutes; runs only if SPOONBILL_LONG is set";

// Reason to skip tests that take a minute under a sanitizer and whose code shorter tests run as well.
inline constexpr const char* long_when_sanitized =
    "takes a minute under a sanitizer; shorter tests run the same code";

}  // namespace spoonbill
