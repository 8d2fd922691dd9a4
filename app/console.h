// The terminal side of a command: its output streams, the progress that it shows, and Ctrl+C.
#pragma once

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <utility>

#include "engine/base/progress.h"
#include "engine/base/result.h"

namespace spoonbill {

// The streams of a command: results go to `out`; progress, warnings and errors go to `err`. Both streams must
// outlive the console.
struct Console {
  std::ostream& out;
  std::ostream& err;
  bool err_is_terminal = false;
};

// Returns the first line of the text, without control characters. Messages quote the content of files, which
// could otherwise send control sequences to the terminal.
std::string one_line(const std::string& text);

// Blocks the signals that stop a command (Ctrl+C, TERM and HUP) while the object exists. A signal stays
// pending until the work reaches a point where it can stop. watch_stop_signals() ends work that does not
// reach such a point. Create the object before other threads start: they inherit the signal mask.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();  // delivers a signal that is still pending
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  // Returns true once a blocked signal has arrived.
  bool requested() const;

  // Discards the pending signal, so that the process can still report that it stopped the work.
  void answer();

 private:
  sigset_t watched_;
  sigset_t before_;
};

// A progress bar on the console's error stream. On a terminal it is one line that is redrawn; elsewhere it is
// a new line for every tenth of the work. A hidden bar prints nothing.
class ProgressBar {
 public:
  // The bar is visible on a terminal; elsewhere it is visible only if it is forced. The console must outlive
  // the bar.
  ProgressBar(Console& console, std::string label, bool is_forced);
  ~ProgressBar();  // ends the line that the bar was drawn on
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::uint64_t done, std::uint64_t total);
  // `fraction` is from 0 to 1.
  void show(double fraction);

 private:
  Console* console_;
  std::string label_;
  bool visible_;
  int shown_percent_ = -1;
};

// Runs a long job of a command with a progress bar; Ctrl+C stops the job. The console must outlive the
// object.
class CancellableJob {
 public:
  // `out` is the file that is not written if the job is stopped; empty if the job writes none.
  CancellableJob(Console& console, std::string label, std::filesystem::path out)
      : out_(std::move(out)), bar_(console, std::move(label), false) {}

  // Calls `work` with a Progress, to which `work` must report. Returns the result of `work`, or
  // ErrorCode::cancelled after Ctrl+C.
  template <class Work>
  auto run(const Work& work) -> decltype(work(Progress())) {
    const Progress progress([this](double fraction) {
      bar_.show(fraction);
      return !interrupt_.requested();
    });
    if (!progress.report(0.0)) return cancelled();
    auto result = work(progress);
    // Ctrl+C may have been pressed during the last step, which can be long.
    if (!progress.report(result ? 1.0 : 0.0)) return cancelled();
    return result;
  }

 private:
  Error cancelled();

  InterruptWatch interrupt_;
  std::filesystem::path out_;
  ProgressBar bar_;
};

// Returns the error of a command that Ctrl+C stopped before it wrote `file`; `file` is empty if the command
// writes none.
Error stopped_before_writing(const std::filesystem::path& file);

}  // namespace spoonbill
