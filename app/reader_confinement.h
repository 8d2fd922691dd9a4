// Limits what a child process that parses a foreign file can do once a hostile file has taken it over.
#pragma once

namespace spoonbill {

// Permanently forbids the calling process to gain privileges, open sockets, start processes or programs, and
// trace others: these calls then fail with EPERM. Threads stay allowed, because OpenCASCADE may start some.
// Call it before the file is opened. Returns false if the kernel or the processor offers no such filter, or
// in a sanitizer build, whose runtime starts processes. The limits on memory, time and files apply in any
// case.
bool confine_reader();

}  // namespace spoonbill
