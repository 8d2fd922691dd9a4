#include "render/gl/glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

namespace spoonbill {
namespace {

constexpr const char* library_file = "libglfw.so.3";
constexpr const char* library_package = "libglfw3";

// Returns the address of a GLFW function, or null if the library or the function is missing.
void* glfw_symbol(const char* name) {
  const auto library = SharedLibrary::open(library_file, library_package);
  return library ? library->symbol(name) : nullptr;
}

// List of X(result, name, parameters, arguments), one for each GLFW function in use. The declarations must
// match those of the GLFW header.
#define SPOONBILL_GLFW_FUNCTIONS(X)                                                                          \
  X(GLFWcursor*, glfwCreateStandardCursor, (int shape), (shape))                                             \
  X(GLFWwindow*, glfwCreateWindow,                                                                           \
    (int width, int height, const char* title, GLFWmonitor* monitor, GLFWwindow* share),                     \
    (width, height, title, monitor, share))                                                                  \
  X(void, glfwDefaultWindowHints, (), ())                                                                    \
  X(void, glfwDestroyCursor, (GLFWcursor * cursor), (cursor))                                                \
  X(void, glfwDestroyWindow, (GLFWwindow * window), (window))                                                \
  X(const char*, glfwGetClipboardString, (GLFWwindow * window), (window))                                    \
  X(GLFWwindow*, glfwGetCurrentContext, (), ())                                                              \
  X(void, glfwGetCursorPos, (GLFWwindow * window, double* xpos, double* ypos), (window, xpos, ypos))         \
  X(int, glfwGetError, (const char** description), (description))                                            \
  X(void, glfwGetFramebufferSize, (GLFWwindow * window, int* width, int* height), (window, width, height))   \
  X(int, glfwGetInputMode, (GLFWwindow * window, int mode), (window, mode))                                  \
  X(const float*, glfwGetJoystickAxes, (int jid, int* count), (jid, count))                                  \
  X(const unsigned char*, glfwGetJoystickButtons, (int jid, int* count), (jid, count))                       \
  X(int, glfwGetMouseButton, (GLFWwindow * window, int button), (window, button))                            \
  X(GLFWglproc, glfwGetProcAddress, (const char* procname), (procname))                                      \
  X(double, glfwGetTime, (), ())                                                                             \
  X(uint64_t, glfwGetTimerFrequency, (), ())                                                                 \
  X(int, glfwGetWindowAttrib, (GLFWwindow * window, int attrib), (window, attrib))                           \
  X(void, glfwGetWindowContentScale, (GLFWwindow * window, float* xscale, float* yscale),                    \
    (window, xscale, yscale))                                                                                \
  X(void, glfwGetWindowSize, (GLFWwindow * window, int* width, int* height), (window, width, height))        \
  X(void*, glfwGetWindowUserPointer, (GLFWwindow * window), (window))                                        \
  X(void, glfwHideWindow, (GLFWwindow * window), (window))                                                   \
  X(int, glfwInit, (), ())                                                                                   \
  X(void, glfwMakeContextCurrent, (GLFWwindow * window), (window))                                           \
  X(void, glfwPollEvents, (), ())                                                                            \
  X(GLFWcharfun, glfwSetCharCallback, (GLFWwindow * window, GLFWcharfun callback), (window, callback))       \
  X(void, glfwSetClipboardString, (GLFWwindow * window, const char* string), (window, string))               \
  X(void, glfwSetCursor, (GLFWwindow * window, GLFWcursor * cursor), (window, cursor))                       \
  X(GLFWcursorenterfun, glfwSetCursorEnterCallback, (GLFWwindow * window, GLFWcursorenterfun callback),      \
    (window, callback))                                                                                      \
  X(void, glfwSetCursorPos, (GLFWwindow * window, double xpos, double ypos), (window, xpos, ypos))           \
  X(GLFWerrorfun, glfwSetErrorCallback, (GLFWerrorfun callback), (callback))                                 \
  X(void, glfwSetInputMode, (GLFWwindow * window, int mode, int value), (window, mode, value))               \
  X(GLFWkeyfun, glfwSetKeyCallback, (GLFWwindow * window, GLFWkeyfun callback), (window, callback))          \
  X(GLFWmonitorfun, glfwSetMonitorCallback, (GLFWmonitorfun callback), (callback))                           \
  X(GLFWmousebuttonfun, glfwSetMouseButtonCallback, (GLFWwindow * window, GLFWmousebuttonfun callback),      \
    (window, callback))                                                                                      \
  X(GLFWscrollfun, glfwSetScrollCallback, (GLFWwindow * window, GLFWscrollfun callback), (window, callback)) \
  X(GLFWwindowfocusfun, glfwSetWindowFocusCallback, (GLFWwindow * window, GLFWwindowfocusfun callback),      \
    (window, callback))                                                                                      \
  X(void, glfwSetWindowShouldClose, (GLFWwindow * window, int value), (window, value))                       \
  X(void, glfwSetWindowSize, (GLFWwindow * window, int width, int height), (window, width, height))          \
  X(void, glfwSetWindowUserPointer, (GLFWwindow * window, void* pointer), (window, pointer))                 \
  X(void, glfwShowWindow, (GLFWwindow * window), (window))                                                   \
  X(void, glfwSwapBuffers, (GLFWwindow * window), (window))                                                  \
  X(void, glfwSwapInterval, (int interval), (interval))                                                      \
  X(void, glfwTerminate, (), ())                                                                             \
  X(void, glfwWaitEventsTimeout, (double timeout), (timeout))                                                \
  X(void, glfwWindowHint, (int hint, int value), (hint, value))                                              \
  X(int, glfwWindowShouldClose, (GLFWwindow * window), (window))

// Opens GLFW. Must succeed before any GLFW function is called. Errors: GLFW is missing or lacks one of the
// functions.
Status open_glfw() {
  const auto library = SharedLibrary::open(library_file, library_package);
  if (!library) return library.error();
#define SPOONBILL_CHECK_GLFW_FUNCTION(result, name, parameters, arguments)                                 \
  if (library->symbol(#name) == nullptr) {                                                                 \
    return Error{ErrorCode::unavailable,                                                                   \
                 std::string(library_file) + " has no " #name ": GLFW 3.3 or later is needed, update it"}; \
  }
  SPOONBILL_GLFW_FUNCTIONS(SPOONBILL_CHECK_GLFW_FUNCTION)
#undef SPOONBILL_CHECK_GLFW_FUNCTION
  return {};
}

constexpr int maximum_side = 16384;

std::string last_glfw_message() {
  const char* message = nullptr;
  glfwGetError(&message);
  return message != nullptr ? message : "GLFW gives no reason";
}

Error make_window_error(const std::string& reason) {
  return Error{
      ErrorCode::unavailable,
      "no window can be opened: " + reason +
          "; start it in a desktop session, or use `spoonbill replay`, which draws without a display"};
}

bool is_glfw_in_use() {
  return glfwGetTimerFrequency() != 0;
}

void request_core_profile() {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  // The renderer has its own depth buffer and multisampling, so the window needs none.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_SAMPLES, 0);
}

}  // namespace

Result<std::unique_ptr<GlfwWindow>> GlfwWindow::make(int width, int height, const std::string& title) {
  if (width < 1 || height < 1 || width > maximum_side || height > maximum_side) {
    return Error{ErrorCode::out_of_range, "window size " + std::to_string(width) + "x" +
                                              std::to_string(height) + ": each side must be from 1 to " +
                                              std::to_string(maximum_side)};
  }
  if (const Status opened = open_glfw(); !opened) return make_window_error(opened.error().message);
  if (is_glfw_in_use()) {
    return Error{ErrorCode::in_use, "a window is already open: close it before opening another"};
  }
  if (glfwInit() != GLFW_TRUE) return make_window_error(last_glfw_message());
  request_core_profile();
  GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string reason = last_glfw_message();
    glfwTerminate();
    return make_window_error("the display has no OpenGL 3.3 core profile (" + reason + ")");
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

std::vector<GlfwWindow::KeyPress> GlfwWindow::consume_key_presses() {
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
    return Error{ErrorCode::unavailable,
                 "the window's GL context cannot be made current: " + last_glfw_message()};
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

// Definitions of the GLFW functions that the window and the ImGui backend call. Each forwards to the function
// of the same name in the shared library.
#define SPOONBILL_DEFINE_GLFW_FUNCTION(result, name, parameters, arguments)                        \
  extern "C" result name parameters {                                                              \
    static const auto function = reinterpret_cast<decltype(&name)>(spoonbill::glfw_symbol(#name)); \
    return function arguments;                                                                     \
  }
SPOONBILL_GLFW_FUNCTIONS(SPOONBILL_DEFINE_GLFW_FUNCTION)
