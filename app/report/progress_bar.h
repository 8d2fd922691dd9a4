// A progress bar on the console's error stream: one line that is redrawn for a person who watches, a line for
// every tenth otherwise, nothing when hidden.
#pragma once

#include <cstdint>
#include <string>

#include "app/console.h"

namespace spoonbill {

class ProgressBar {
 public:
  // Shown when a person watches or it was asked for. The console must outlive it.
  ProgressBar(Console& console, std::string label, bool asked_for);
  ~ProgressBar();  // leaves the line it was drawing on
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::uint64_t done, std::uint64_t total);
  void show(double fraction);

 private:
  Console* console_;
  std::string label_;
  bool visible_;
  int shown_percent_ = -1;
};

}  // namespace spoonbill
