#include "tests/fuzz/fuzz_target.h"

#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/targets/targets.h"

namespace spoonbill {

std::span<const FuzzTarget> fuzz_targets() {
  static constexpr FuzzTarget targets[] = {
      {"document", take_document}, {"recording", take_recording},
      {"script", take_script},     {"points", take_points},
      {"ply", take_ply},           {"cad_stream", take_cad_stream},
      {"values", take_values},     {"table", take_table},
      {"stl", take_stl},           {"obj", take_obj},
  };
  return targets;
}

void must_hold(bool property, const char* what) {
  if (property) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace spoonbill
