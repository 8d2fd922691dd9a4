// Checks of what callers promise: a function whose contract states a precondition asserts it on entry. What
// comes from outside (a file, a device, a person) is checked before and refused with an Error; it never
// reaches an assert.
//
//   SPOONBILL_ASSERT(count > 0);                  cheap; stays in every build
//   SPOONBILL_ASSERT_DEBUG(is_sorted(knots));     may walk a whole structure; Debug builds only
//
// A failed assert calls the process's handler on the thread that failed. The default one prints the place and
// aborts. The program's own throws the FailedAssertion: whoever runs a unit of work that can be given up (a
// tick, a save, a command) catches it, and nothing else does. Kernels have no asserts; their callers do.
#pragma once

#include <array>
#include <exception>

namespace spoonbill {

// Where which promise was broken. Copying and what() allocate nothing, so that the haptic thread may catch
// it.
class FailedAssertion : public std::exception {
 public:
  // `condition` and `file` are literals.
  FailedAssertion(const char* condition, const char* file, int line) noexcept;

  // "internal fault: 'count > 0' does not hold (engine/bspline/grid.cpp:41)"
  const char* what() const noexcept override { return text_.data(); }

 private:
  std::array<char, 256> text_{};
};

// May throw the failure to give up the work at hand. Where it returns, the process aborts.
using AssertionHandler = void (*)(const FailedAssertion& failure);

// Sets the process's handler and returns the previous one. Called while there is one thread.
AssertionHandler set_assertion_handler(AssertionHandler handler);

// Throws the failure: the handler of a program that catches it where work can be given up.
void throw_failed_assertion(const FailedAssertion& failure);

[[noreturn]] void fail_assertion(const char* condition, const char* file, int line);

}  // namespace spoonbill

#define SPOONBILL_ASSERT(condition)                                \
  do {                                                             \
    if (!(condition)) [[unlikely]]                                 \
      ::spoonbill::fail_assertion(#condition, __FILE__, __LINE__); \
  } while (false)

// Unevaluated in release builds, so that what it names counts as used.
#ifdef NDEBUG
#define SPOONBILL_ASSERT_DEBUG(condition) static_cast<void>(sizeof(static_cast<bool>(condition)))
#else
#define SPOONBILL_ASSERT_DEBUG(condition) SPOONBILL_ASSERT(condition)
#endif
