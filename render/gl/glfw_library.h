// GLFW, opened when a window is made: glfw_library.cpp defines the functions of GLFW that the window and Dear
// ImGui's backend call, each of which calls the one of the same name in the shared library.
#pragma once

#include "engine/base/result.h"

namespace spoonbill {

// Must have succeeded before any function of GLFW is called. Refused, naming the package, where GLFW is
// missing or lacks one of the functions.
Status open_glfw();

}  // namespace spoonbill
