// A display in memory (Xvfb) for tests of windows. The environment variable DISPLAY names the display while
// the object exists. Only one object may exist at a time.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

class VirtualDisplay {
 public:
  // Starts Xvfb, which chooses a free display number itself, so that tests can run in parallel. Fails if Xvfb
  // is not installed or does not start.
  static Result<std::unique_ptr<VirtualDisplay>> start(int width_px, int height_px);

  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  const std::string& name() const { return name_; }

  // Returns the upper left part of the display, where all windows are because there is no window manager.
  Image screenshot(int width_px, int height_px) const;

  // Sets the density that windows opened later read from the display: 96 dots per inch are a scale of 1.
  void set_dots_per_inch(int dots_per_inch) const;

 private:
  VirtualDisplay(pid_t process, std::string name);

  pid_t process_;
  std::string name_;
};

}  // namespace spoonbill
