// Assertions. A function whose contract states a precondition asserts it on entry. Input from a file, a
// device or a person is checked earlier and refused with an Error, so it never reaches an assertion.
#pragma once

#include <array>
#include <exception>

namespace spoonbill {

// A failed assertion: its condition and its location in the source. Copying and what() do not allocate, so
// that the haptic thread may catch this exception.
class FailedAssertion : public std::exception {
 public:
  // `condition` and `file` must be string literals.
  FailedAssertion(const char* condition, const char* file, int line) noexcept;

  // Returns text such as "internal fault: 'count > 0' does not hold (engine/bspline/grid.cpp:41)".
  const char* what() const noexcept override { return text_.data(); }

 private:
  std::array<char, 256> text_{};
};

// Function that handles a failed assertion. It may throw the failure to abandon the current work; if it
// returns, the process aborts.
using AssertionHandler = void (*)(const FailedAssertion& failure);

// Sets the process's handler and returns the previous one. Must be called while the process has one thread.
AssertionHandler set_assertion_handler(AssertionHandler handler);

// Throws the failure. This is the handler for programs that catch failures and abandon the work in progress.
void throw_failed_assertion(const FailedAssertion& failure);

// Calls the process's handler with the failed assertion, and aborts if the handler returns.
[[noreturn]] void fail_assertion(const char* condition, const char* file, int line);

}  // namespace spoonbill

#define SPOONBILL_ASSERT(condition)                                \
  do {                                                             \
    if (!(condition)) [[unlikely]]                                 \
      ::spoonbill::fail_assertion(#condition, __FILE__, __LINE__); \
  } while (false)

// Release builds do not evaluate the condition. They still count the names in it as used, so that the
// compiler does not warn of unused variables.
#ifdef NDEBUG
#define SPOONBILL_ASSERT_DEBUG(condition) static_cast<void>(sizeof(static_cast<bool>(condition)))
#else
#define SPOONBILL_ASSERT_DEBUG(condition) SPOONBILL_ASSERT(condition)
#endif
