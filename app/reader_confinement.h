// Limits what a child process that parses a foreign file can do once a hostile file has taken it over.
#pragma once

namespace spoonbill {

// Forbids the calling process, for good, to gain privileges, to open sockets, to start processes or programs
// and to trace others: those calls fail with EPERM. Threads stay allowed, because OpenCASCADE may start some.
// Call it before the file is opened. Returns false if the kernel or the processor offers no such filter, or
// in a sanitizer build, whose runtime starts processes; the limits on memory, time and files hold all the
// same.
bool confine_reader();

}  // namespace spoonbill
