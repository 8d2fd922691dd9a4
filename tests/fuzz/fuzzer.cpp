// libFuzzer entry point for one target, whose name the build defines.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "tests/fuzz/fuzz_target.h"

// libFuzzer prescribes the function's name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace spoonbill;
  static const FuzzTarget* const target = [] {
    for (const FuzzTarget& one : fuzz_targets()) {
      if (one.name == std::string_view(SPOONBILL_FUZZ_TARGET)) return &one;
    }
    return static_cast<const FuzzTarget*>(nullptr);
  }();
  target->take({reinterpret_cast<const char*>(data), size});
  return 0;
}
