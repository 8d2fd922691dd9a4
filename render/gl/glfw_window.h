// A desktop window with a GL context. One owner; every call comes from the program's main thread, which is
// what GLFW asks for. GLFW is one to a process, so there is one window at a time.
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

class GlfwWindow final : public GlContext {
 public:
  // Width and height as on a display of ordinary density, 1..16384: at scale 2 the window gets twice as many
  // pixels. Hidden until show(), so that nobody sees an empty frame. The context is not current yet. Refused,
  // with the remedy: no display, a display without OpenGL 3.3 core, a second window, impossible sizes.
  static Result<std::unique_ptr<GlfwWindow>> make(int width, int height, const std::string& title);

  ~GlfwWindow() override;
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  Status make_current() override;
  GlProcedure procedure(const char* name) const override;

  // The framebuffer in pixels, at least 1: what is drawn and read. Follows the window as events are handled.
  int width_px() const override;
  int height_px() const override;

  bool has_window() const override { return true; }

  // Waits for the display's next refresh where the driver can; make_current() must have been called.
  void swap() override;

  // The window in screen coordinates, in which the pointer moves. They are pixels on X11, not everywhere.
  int width() const;
  int height() const;
  void resize(int width, int height);  // in screen coordinates; the display may take its time or refuse

  // How many pixels a length of the interface should cover: 1 on an ordinary display, 2 on a dense one. It
  // changes when the window moves to another display.
  double scale() const;

  void show();
  void hide();
  bool is_minimised() const;  // nothing need be drawn

  // Handles what has happened.
  void poll_events();

  // Whether somebody asked the window to close. The owner decides, and may put the wish aside.
  bool should_close() const;
  void set_should_close(bool close);

  // A key as it goes down; held ones repeat no press.
  struct KeyPress {
    int key = 0;  // GLFW_KEY_
    bool ctrl = false;
    bool shift = false;
  };
  // Those since the last call, in their order: a tap between two frames is not lost.
  std::vector<KeyPress> take_key_presses();

  // For Dear ImGui's GLFW backend, whose callbacks must be installed after make(); it stays the window's.
  GLFWwindow* native() const { return window_; }

 private:
  explicit GlfwWindow(GLFWwindow* window);

  GLFWwindow* window_;
  std::vector<KeyPress> key_presses_;
};

}  // namespace spoonbill
