#include "render/gl/glfw_library.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "render/gl/shared_library.h"

namespace spoonbill {
namespace {

constexpr const char* library_file = "libglfw.so.3";
constexpr const char* library_package = "libglfw3";

// Null where the library or the function is missing.
void* glfw_symbol(const char* name) {
  const auto library = SharedLibrary::open(library_file, library_package);
  return library ? library->symbol(name) : nullptr;
}

}  // namespace

// X(result, name, parameters, arguments): as GLFW's own header declares them, or they do not compile.
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

Status open_glfw() {
  const auto library = SharedLibrary::open(library_file, library_package);
  if (!library) return library.error();
#define SPOONBILL_CHECK_GLFW_FUNCTION(result, name, parameters, arguments)                                 \
  if (library->symbol(#name) == nullptr) {                                                                 \
    return Error{std::string(library_file) + " has no " #name ": GLFW 3.3 or later is needed, update it"}; \
  }
  SPOONBILL_GLFW_FUNCTIONS(SPOONBILL_CHECK_GLFW_FUNCTION)
#undef SPOONBILL_CHECK_GLFW_FUNCTION
  return {};
}

}  // namespace spoonbill

#define SPOONBILL_DEFINE_GLFW_FUNCTION(result, name, parameters, arguments)                        \
  extern "C" result name parameters {                                                              \
    static const auto function = reinterpret_cast<decltype(&name)>(spoonbill::glfw_symbol(#name)); \
    return function arguments;                                                                     \
  }
SPOONBILL_GLFW_FUNCTIONS(SPOONBILL_DEFINE_GLFW_FUNCTION)
