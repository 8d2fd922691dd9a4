// What a coverage-guided fuzzer throws bytes at: each reader of ours, and what must hold of whatever it
// accepts. The same functions take the kept cases in the ordinary tests.
#pragma once

#include <span>
#include <string_view>

namespace spoonbill {

struct FuzzTarget {
  const char* name;
  // Ends the process where a property does not hold; whatever else is wrong is the sanitizers' to find.
  void (*take)(std::string_view bytes);
};

std::span<const FuzzTarget> fuzz_targets();

// Says what does not hold, and ends the process.
void must_hold(bool property, const char* what);

}  // namespace spoonbill
