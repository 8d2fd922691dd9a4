#include "app/console.h"

#include <ctime>
#include <string_view>

#include "app/stop_signals.h"
#include "engine/base/text.h"

namespace spoonbill {

std::string one_line(const std::string& text) {
  return without_controls(std::string_view(text).substr(0, text.find('\n')));
}

InterruptWatch::InterruptWatch() : watched_(stop_signals()) {
  pthread_sigmask(SIG_BLOCK, &watched_, &before_);
}

InterruptWatch::~InterruptWatch() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool InterruptWatch::requested() const {
  if (has_stop_signal()) return true;
  sigset_t pending;
  sigpending(&pending);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    if (sigismember(&pending, number) == 1 && sigismember(&watched_, number) == 1) return true;
  }
  return false;
}

void InterruptWatch::answer() {
  const timespec no_wait{};
  while (sigtimedwait(&watched_, nullptr, &no_wait) > 0) {
  }
}

ProgressBar::ProgressBar(Console& console, std::string label, bool is_forced)
    : console_(&console), label_(escaped(label)), visible_(console.err_is_terminal || is_forced) {}

ProgressBar::~ProgressBar() {
  if (visible_ && console_->err_is_terminal && shown_percent_ >= 0) console_->err << '\n';
}

void ProgressBar::show(std::uint64_t done, std::uint64_t total) {
  if (!visible_) return;
  const int percent = total == 0 ? 100 : static_cast<int>(100 * done / total);
  const int step = console_->err_is_terminal ? 1 : 10;
  if (percent < shown_percent_ + step && shown_percent_ >= 0) return;
  shown_percent_ = percent - percent % step;

  constexpr int width = 40;
  const auto filled = static_cast<std::size_t>(width * percent / 100);
  const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
  const std::string text = label_ + " [" + bar + "] " + std::to_string(percent) + " %";
  if (console_->err_is_terminal) {
    console_->err << '\r' << text << std::flush;
  } else {
    console_->err << text << std::endl;
  }
}

void ProgressBar::show(double fraction) {
  constexpr double resolution = 1000.0;
  show(static_cast<std::uint64_t>(resolution * fraction), static_cast<std::uint64_t>(resolution));
}

Error CancellableJob::cancelled() {
  interrupt_.answer();
  return stopped_before_writing(out_);
}

Error stopped_before_writing(const std::filesystem::path& file) {
  if (file.empty()) return Progress::stopped();
  return Error{ErrorCode::cancelled, "stopped; " + file.string() + " was not written"};
}

}  // namespace spoonbill
