// Counts the heap allocations that each thread makes through operator new, in programs that link
// allocations.cpp.
#pragma once

#include <cstddef>

namespace spoonbill {

// Returns the number of allocations of the calling thread since it started.
std::size_t allocation_count();

// True in Debug builds, whose assertions validate whole structures and may allocate.
#ifdef NDEBUG
inline constexpr bool assertions_allocate = false;
#else
inline constexpr bool assertions_allocate = true;
#endif
inline constexpr const char* only_without_debug_assertions = "assertions of a Debug build allocate";

}  // namespace spoonbill
