// Limits what a child process can do if the foreign file that it parses is hostile and takes control of it.
#pragma once

#include "engine/base/result.h"

namespace spoonbill {

// Forbids the calling process, for good, to gain privileges, to open sockets, to start processes or programs
// and to trace other processes. These calls fail with EPERM, clone3 with ENOSYS. Threads stay allowed,
// because OpenCASCADE may start some. Call it before the file is opened; after an error, the file must not be
// opened. Returns ErrorCode::unavailable if the kernel or the processor offers no such filter. Does nothing
// in a sanitizer build, whose runtime starts processes.
[[nodiscard]] Status confine_reader();

}  // namespace spoonbill
