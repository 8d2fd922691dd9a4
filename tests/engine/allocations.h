// Programs that link allocations.cpp count the heap allocations of each thread through operator new.
#pragma once

#include <cstddef>

namespace spoonbill {

// Returns the number of allocations of the calling thread since it started.
std::size_t allocation_count();

}  // namespace spoonbill
