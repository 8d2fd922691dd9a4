#include "render/gl/functions.h"

#include <string>

namespace spoonbill {
namespace {

template <class Function>
bool load(const GlContext& context, const char* name, Function& function) {
  function = reinterpret_cast<Function>(context.procedure(name));
  return function != nullptr;
}

}  // namespace

Result<GlFunctions> load_gl_functions(const GlContext& context) {
  GlFunctions gl;
#define SPOONBILL_GL_LOAD(type, name)                                                              \
  if (!load(context, "gl" #name, gl.name)) {                                                       \
    return Error{"the GL context has no gl" #name ": OpenGL 3.3 or later is needed, update Mesa"}; \
  }
  SPOONBILL_GL_FUNCTIONS(SPOONBILL_GL_LOAD)
#undef SPOONBILL_GL_LOAD
  return gl;
}

}  // namespace spoonbill
