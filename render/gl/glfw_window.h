// A desktop window with a GL context.
//
//   auto window = GlfwWindow::make(1280, 720, "Spoonbill");
//   auto renderer = Renderer::make(*window.value());
//   window->show();
//   while (!window->should_close()) {
//     window->poll_events();
//     renderer->draw(snapshot, settings, ImGui::GetDrawData());
//     renderer->present();
//   }
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/gl/context.h"

struct GLFWwindow;

namespace spoonbill {

// One owner. All calls must come from the main thread of the program, as GLFW requires. GLFW is global to the
// process, so there is one window at a time.
class GlfwWindow final : public GlContext {
 public:
  // Makes a window that is hidden until show(), so that no empty frame appears. Width and height, 1 to 16384,
  // are for a display of ordinary density: at scale 2 the window gets twice as many pixels along each side.
  // The context is not current yet. Errors, with the remedy: no display, a display without OpenGL 3.3 core, a
  // second window, invalid sizes.
  static Result<std::unique_ptr<GlfwWindow>> make(int width, int height, const std::string& title);

  ~GlfwWindow() override;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  Status make_current() override;
  GlProcedure procedure(const char* name) const override;

  // Size of the framebuffer in pixels, at least 1. Changes with the window when events are handled.
  int width_px() const override;
  int height_px() const override;

  bool has_window() const override { return true; }

  // Shows the frame and waits for the next refresh of the display if the driver can. Requires make_current().
  void swap() override;

  // Size of the window in screen coordinates, which are also the unit of the pointer's position. On X11
  // screen coordinates are pixels; on other systems they may differ from pixels.
  int width() const;
  int height() const;
  // Resizes the window, in screen coordinates. The display may delay or refuse the change.
  void resize(int width, int height);

  // Returns the number of display pixels along one pixel of the interface: 1 on an ordinary display, 2 on a
  // dense display. Changes when the window moves to another display.
  double scale() const;

  void show();
  void hide();
  bool is_minimised() const;  // a minimised window need not be drawn

  // Handles pending events.
  void poll_events();

  // Returns whether the user has asked to close the window. The owner decides and may clear the request.
  bool should_close() const;
  void set_should_close(bool close);

  // A key that was pressed. Holding a key does not repeat it.
  struct KeyPress {
    int key = 0;  // a GLFW_KEY_ constant
    bool ctrl = false;
    bool shift = false;
  };
  // Returns the key presses since the last call, in order, and clears them. Short presses between two frames
  // are included.
  std::vector<KeyPress> consume_key_presses();

  // Returns the handle for the GLFW backend of Dear ImGui. The backend must install its callbacks after
  // make(). The window remains the owner.
  GLFWwindow* native() const { return window_; }

 private:
  explicit GlfwWindow(GLFWwindow* window);

  GLFWwindow* window_;
  std::vector<KeyPress> key_presses_;
};

}  // namespace spoonbill
