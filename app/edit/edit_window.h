// The window with what draws in it: GL, interface and renderer, kept at the display's scale. One owner; the
// program's main thread.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/panel/interface_context.h"
#include "render/gl/glfw_window.h"
#include "render/image.h"
#include "render/renderer.h"

namespace spoonbill {

class EditWindow {
 public:
  // `scale` overrides the display's, for those that report none. Refused: no display, no GL, no font.
  static Result<EditWindow> make(int width, int height, std::optional<double> scale);

  EditWindow(EditWindow&&) noexcept;
  EditWindow& operator=(EditWindow&&) = delete;
  ~EditWindow();

  GlfwWindow& window() { return *window_; }
  const Theme& theme() const { return interface_.theme(); }
  double scale() const { return scale_; }
  int width_px() const { return window_->width_px(); }
  int height_px() const { return window_->height_px(); }

  // Handles events and begins the interface's frame. Refused: fonts that cannot be read at a new scale.
  Status begin_frame();
  // Ends it, draws and shows.
  Status end_frame(const Snapshot& snapshot, const ViewSettings& view);

  // The last frame.
  void read_pixels(Image& image) const { renderer_.read_pixels(image); }

 private:
  struct Backend;  // ImGui's way to the window's events
  EditWindow(std::unique_ptr<GlfwWindow> window, InterfaceContext interface, Renderer renderer, double scale,
             std::optional<double> chosen_scale);

  std::unique_ptr<GlfwWindow> window_;
  InterfaceContext interface_;
  Renderer renderer_;
  std::unique_ptr<Backend> backend_;
  double scale_;
  std::optional<double> chosen_scale_;
};

}  // namespace spoonbill
