// Programs that link allocations.cpp count what each thread takes from the heap by operator new.
#pragma once

#include <cstddef>

namespace spoonbill {

// Of the calling thread, since it began.
std::size_t allocation_count();

}  // namespace spoonbill
