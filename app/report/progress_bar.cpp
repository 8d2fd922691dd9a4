#include "app/report/progress_bar.h"

#include <utility>

namespace spoonbill {

ProgressBar::ProgressBar(Console& console, std::string label, bool asked_for)
    : console_(&console), label_(std::move(label)), visible_(console.person_watches || asked_for) {}

ProgressBar::~ProgressBar() {
  if (visible_ && console_->person_watches && shown_percent_ >= 0) console_->err << '\n';
}

void ProgressBar::show(std::uint64_t done, std::uint64_t total) {
  if (!visible_) return;
  const int percent = total == 0 ? 100 : static_cast<int>(100 * done / total);
  const int step = console_->person_watches ? 1 : 10;
  if (percent < shown_percent_ + step && shown_percent_ >= 0) return;
  shown_percent_ = percent - percent % step;

  constexpr int width = 40;
  const auto filled = static_cast<std::size_t>(width * percent / 100);
  const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
  const std::string text = label_ + " [" + bar + "] " + std::to_string(percent) + " %";
  if (console_->person_watches) {
    console_->err << '\r' << text << std::flush;
  } else {
    console_->err << text << std::endl;
  }
}

void ProgressBar::show(double fraction) {
  constexpr double whole = 1000.0;
  show(static_cast<std::uint64_t>(whole * fraction), static_cast<std::uint64_t>(whole));
}

}  // namespace spoonbill
