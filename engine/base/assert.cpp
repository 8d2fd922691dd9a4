#include "engine/base/assert.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace spoonbill {
namespace {

void print_and_abort(const FailedAssertion& failure) {
  std::fprintf(stderr, "spoonbill: %s\n", failure.what());
  std::abort();
}

std::atomic<AssertionHandler> process_handler{print_and_abort};

}  // namespace

FailedAssertion::FailedAssertion(const char* condition, const char* file, int line) noexcept {
  std::snprintf(text_.data(), text_.size(), "internal fault: '%s' does not hold (%s:%d)", condition, file,
                line);
}

AssertionHandler set_assertion_handler(AssertionHandler handler) {
  return process_handler.exchange(handler);
}

void throw_failed_assertion(const FailedAssertion& failure) {
  throw failure;
}

void fail_assertion(const char* condition, const char* file, int line) {
  const FailedAssertion failure(condition, file, line);
  process_handler.load()(failure);
  std::abort();
}

}  // namespace spoonbill
