#include "render/gl/allocator_thresholds.h"

#if defined(__GLIBC__) || __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace spoonbill {

void keep_drawing_memory() {
#ifdef M_MMAP_THRESHOLD
  constexpr int one_gibibyte = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, one_gibibyte);
  mallopt(M_TRIM_THRESHOLD, one_gibibyte);
  constexpr int grow_step = 64 << 20;
  mallopt(M_TOP_PAD, grow_step);
#endif
}

}  // namespace spoonbill
