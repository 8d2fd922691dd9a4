// The end of the process by a signal: Ctrl+C (INT), TERM, and HUP when the terminal closes.
#pragma once

#include <csignal>
#include <string>

namespace spoonbill {

// Returns the signals among INT, TERM and HUP that this process does not ignore. Signals that were ignored at
// its start, as under nohup, must have no effect.
sigset_t stop_signals();

// Starts a thread that waits for the signals. When one of stop_signals() arrives, has_stop_signal() becomes
// true and the command may end by itself. If the command has not ended 0.6 s later, its unfinished files are
// closed (engine/base/unfinished_files.h), one line on standard error says so, and the signal ends the
// process. Called once, by main(), before any other thread starts.
void watch_stop_signals();

// Returns true once a signal has arrived. Thread-safe.
bool has_stop_signal();

}  // namespace spoonbill
