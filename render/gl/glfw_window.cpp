#include "render/gl/glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "render/gl/glfw_library.h"

namespace spoonbill {
namespace {

constexpr int largest_side = 16384;

std::string last_glfw_message() {
  const char* message = nullptr;
  glfwGetError(&message);
  return message != nullptr ? message : "GLFW gives no reason";
}

Error no_window(const std::string& reason) {
  return Error{"no window can be opened: " + reason +
               "; start it in a desktop session, or use `spoonbill replay`, which draws without a display"};
}

bool glfw_in_use() {
  return glfwGetTimerFrequency() != 0;
}

void ask_for_core_profile() {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  // The renderer has a depth buffer and samples of its own.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SAMPLES, 0);
}

}  // namespace

Result<std::unique_ptr<GlfwWindow>> GlfwWindow::make(int width, int height, const std::string& title) {
  if (width < 1 || height < 1 || width > largest_side || height > largest_side) {
    return Error{"window size " + std::to_string(width) + "x" + std::to_string(height) +
                 ": each side must lie between 1 and " + std::to_string(largest_side)};
  }
  if (const Status opened = open_glfw(); !opened) return no_window(opened.error().message);
  if (glfw_in_use()) return Error{"a window is open already: close it before opening another"};
  if (glfwInit() != GLFW_TRUE) return no_window(last_glfw_message());
  ask_for_core_profile();
  GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string reason = last_glfw_message();
    glfwTerminate();
    return no_window("the display has no OpenGL 3.3 core profile (" + reason + ")");
  }
  return std::unique_ptr<GlfwWindow>(new GlfwWindow(window));
}

GlfwWindow::GlfwWindow(GLFWwindow* window) : window_(window) {
  glfwSetWindowUserPointer(window, this);
  glfwSetKeyCallback(window, [](GLFWwindow* from, int key, int, int action, int modifiers) {
    if (action != GLFW_PRESS) return;
    auto* self = static_cast<GlfwWindow*>(glfwGetWindowUserPointer(from));
    self->key_presses_.push_back(
        {key, (modifiers & GLFW_MOD_CONTROL) != 0, (modifiers & GLFW_MOD_SHIFT) != 0});
  });
}

std::vector<GlfwWindow::KeyPress> GlfwWindow::take_key_presses() {
  return std::exchange(key_presses_, {});
}

GlfwWindow::~GlfwWindow() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Status GlfwWindow::make_current() {
  if (glfwGetCurrentContext() == window_) return {};
  glfwMakeContextCurrent(window_);
  if (glfwGetCurrentContext() != window_) {
    return Error{"the window's GL context cannot be made current: " + last_glfw_message()};
  }
  glfwSwapInterval(1);
  return {};
}

GlProcedure GlfwWindow::procedure(const char* name) const {
  return glfwGetProcAddress(name);
}

int GlfwWindow::width_px() const {
  int width = 0;
  glfwGetFramebufferSize(window_, &width, nullptr);
  return std::max(1, width);
}

int GlfwWindow::height_px() const {
  int height = 0;
  glfwGetFramebufferSize(window_, nullptr, &height);
  return std::max(1, height);
}

void GlfwWindow::swap() {
  glfwSwapBuffers(window_);
}

int GlfwWindow::width() const {
  int width = 0;
  glfwGetWindowSize(window_, &width, nullptr);
  return width;
}

int GlfwWindow::height() const {
  int height = 0;
  glfwGetWindowSize(window_, nullptr, &height);
  return height;
}

void GlfwWindow::resize(int width, int height) {
  glfwSetWindowSize(window_, width, height);
}

double GlfwWindow::scale() const {
  float horizontal = 1.0F, vertical = 1.0F;
  glfwGetWindowContentScale(window_, &horizontal, &vertical);
  return std::max(1.0F, std::max(horizontal, vertical));
}

void GlfwWindow::show() {
  glfwShowWindow(window_);
}

void GlfwWindow::hide() {
  glfwHideWindow(window_);
}

bool GlfwWindow::is_minimised() const {
  return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

void GlfwWindow::poll_events() {
  glfwPollEvents();
}

bool GlfwWindow::should_close() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void GlfwWindow::set_should_close(bool close) {
  glfwSetWindowShouldClose(window_, close ? GLFW_TRUE : GLFW_FALSE);
}

}  // namespace spoonbill
