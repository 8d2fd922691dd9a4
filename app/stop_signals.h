// Handling of the signals that stop the process: INT (Ctrl+C), TERM, and HUP, which arrives when the terminal
// closes.
#pragma once

#include <csignal>
#include <string>

namespace spoonbill {

// Returns the signals among INT, TERM and HUP that this process does not ignore. A signal that was ignored
// when the process started, as under nohup, must have no effect.
sigset_t stop_signals();

// Starts a thread that waits for the signals. When one of stop_signals() arrives, has_stop_signal() becomes
// true and the command may end by itself. If the command has not ended 0.6 s later, the thread removes or
// completes the unfinished files (engine/base/unfinished_files.h), reports the stop in one line on standard
// error, and lets the signal end the process. Called once, by main(), before any other thread starts.
void watch_stop_signals();

// Returns true once a signal has arrived. Thread-safe.
bool has_stop_signal();

}  // namespace spoonbill
