// Work that a command shows the progress of, and that Ctrl+C stops.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "app/console.h"
#include "app/interrupt.h"
#include "app/report/progress_bar.h"
#include "engine/base/result.h"
#include "engine/base/work_watch.h"

namespace spoonbill {

// While it lives, SIGINT waits (InterruptWatch). The console must outlive it.
class WatchedWork {
 public:
  // `out` is the file that is not written when the work is stopped.
  WatchedWork(Console& console, std::string label, std::filesystem::path out)
      : out_(std::move(out)), bar_(console, std::move(label), false) {}

  // What `work` makes of a watch, or that it was stopped.
  template <class Work>
  auto done(const Work& work) -> decltype(work(WorkWatch())) {
    const WorkWatch watch([this](double share) {
      constexpr double whole = 1000.0;
      bar_.show(static_cast<std::uint64_t>(whole * share), static_cast<std::uint64_t>(whole));
      return !interrupt_.requested();
    });
    if (!watch.goes_on(0.0)) return stopped();
    auto result = work(watch);
    // The last step may have been long.
    if (!watch.goes_on(result ? 1.0 : 0.0)) return stopped();
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
