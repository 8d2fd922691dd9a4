// Work that a command shows the progress of, and that Ctrl+C stops.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "app/console.h"
#include "app/interrupt.h"
#include "app/report/progress_bar.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"

namespace spoonbill {

// While it lives, SIGINT waits (InterruptWatch). The console must outlive it.
class WatchedWork {
 public:
  // `out` is the file that is not written when the work is stopped.
  WatchedWork(Console& console, std::string label, std::filesystem::path out)
      : out_(std::move(out)), bar_(console, std::move(label), false) {}

  // What `work` makes with a progress to report to, or that it was stopped.
  template <class Work>
  auto done(const Work& work) -> decltype(work(Progress())) {
    const Progress progress([this](double fraction) {
      bar_.show(fraction);
      return !interrupt_.requested();
    });
    if (!progress.report(0.0)) return stopped();
    auto result = work(progress);
    // The last step may have been long.
    if (!progress.report(result ? 1.0 : 0.0)) return stopped();
    return result;
  }

 private:
  Error stopped() {
    interrupt_.answer();
    return Error{"stopped; " + out_.string() + " was not written"};
  }

  InterruptWatch interrupt_;
  std::filesystem::path out_;
  ProgressBar bar_;
};

}  // namespace spoonbill
