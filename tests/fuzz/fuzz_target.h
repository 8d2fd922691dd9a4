// The targets of the coverage-guided fuzzer: each calls one of our readers and checks properties of
// everything that the reader accepts. The ordinary tests run the same functions on the stored inputs.
#pragma once

#include <span>
#include <string_view>

namespace spoonbill {

struct FuzzTarget {
  const char* name;
  // Passes the bytes to a reader. Ends the process if a property does not hold; sanitizers find other errors.
  void (*take)(std::string_view bytes);
};

std::span<const FuzzTarget> fuzz_targets();

// Prints the property that does not hold, and ends the process.
void must_hold(bool property, const char* what);

}  // namespace spoonbill
