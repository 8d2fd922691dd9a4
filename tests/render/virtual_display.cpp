#include "tests/render/virtual_display.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <utility>

namespace spoonbill {
namespace {

// Turns the child process into Xvfb, which writes the number of its display to `number_pipe`. With -noreset,
// Xvfb keeps its settings when its last client leaves. Otherwise the next client could connect during the
// reset.
[[noreturn]] void become_xvfb(int number_pipe, const std::string& screen) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  const std::string number = std::to_string(number_pipe);
  execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", screen.c_str(), "-nolisten", "tcp",
         "-noreset", static_cast<char*>(nullptr));
  _exit(127);
}

// Returns a line without its newline; an empty text if the pipe is closed before the line ends.
std::string read_line(int pipe) {
  std::string line;
  char letter = 0;
  while (read(pipe, &letter, 1) == 1) {
    if (letter == '\n') return line;
    line += letter;
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<VirtualDisplay>> VirtualDisplay::start(int width_px, int height_px) {
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) return Error{ErrorCode::unavailable, "no pipe for Xvfb"};
  const std::string screen = std::to_string(width_px) + "x" + std::to_string(height_px) + "x24";
  const pid_t process = fork();
  if (process == 0) {
    close(pipe_ends[0]);
    become_xvfb(pipe_ends[1], screen);
  }
  close(pipe_ends[1]);
  const std::string number = read_line(pipe_ends[0]);
  close(pipe_ends[0]);
  if (number.empty()) {
    waitpid(process, nullptr, 0);
    return Error{ErrorCode::unavailable,
                 "Xvfb does not start: install the group [tests] of app/setup/packages.txt"};
  }
  return std::unique_ptr<VirtualDisplay>(new VirtualDisplay(process, ":" + number));
}

VirtualDisplay::VirtualDisplay(pid_t process, std::string name) : process_(process), name_(std::move(name)) {
  setenv("DISPLAY", name_.c_str(), 1);
}

VirtualDisplay::~VirtualDisplay() {
  unsetenv("DISPLAY");
  kill(process_, SIGTERM);
  waitpid(process_, nullptr, 0);
}

Image VirtualDisplay::screenshot(int width_px, int height_px) const {
  Image picture;
  Display* display = XOpenDisplay(name_.c_str());
  if (display == nullptr) return picture;
  XImage* seen = XGetImage(display, DefaultRootWindow(display), 0, 0, static_cast<unsigned>(width_px),
                           static_cast<unsigned>(height_px), AllPlanes, ZPixmap);
  picture.resize(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const unsigned long rgb = XGetPixel(seen, x, y);
      std::uint8_t* pixel = picture.pixel(x, y);
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(rgb >> (16 - 8 * c));
      pixel[3] = 255;
    }
  }
  XDestroyImage(seen);
  XCloseDisplay(display);
  return picture;
}

void VirtualDisplay::set_dots_per_inch(int dots_per_inch) const {
  Display* display = XOpenDisplay(name_.c_str());
  if (display == nullptr) return;
  const std::string resources = "Xft.dpi: " + std::to_string(dots_per_inch) + "\n";
  XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(resources.data()),
                  static_cast<int>(resources.size()));
  XCloseDisplay(display);
}

}  // namespace spoonbill
