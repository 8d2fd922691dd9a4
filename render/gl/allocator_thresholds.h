// The C library's allocator and the software renderer: by default glibc gives large blocks back to the system
// after every frame, and clearing fresh pages then costs a third of the frame.
#pragma once

namespace spoonbill {

// Keeps freed memory of drawing in the process (up to 1 GiB). Call once at the program's start, before the
// first context and before other threads; a program that never draws need not. Does nothing without glibc.
void keep_drawing_memory();

}  // namespace spoonbill
