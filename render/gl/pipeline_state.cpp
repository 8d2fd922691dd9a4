#include "render/gl/pipeline_state.h"

namespace spoonbill {
namespace {

void set_enabled(const GlFunctions& gl, GLenum capability, bool enabled) {
  enabled ? gl.Enable(capability) : gl.Disable(capability);
}

}  // namespace

void set_pipeline_state(const GlFunctions& gl, const PipelineState& state) {
  set_enabled(gl, GL_DEPTH_TEST, state.depth != Depth::off);
  gl.DepthMask(state.depth == Depth::test_and_write ? GL_TRUE : GL_FALSE);
  gl.DepthFunc(GL_LEQUAL);
  set_enabled(gl, GL_BLEND, state.blend != Blend::off);
  gl.BlendEquation(state.blend == Blend::maximum ? GL_MAX : GL_FUNC_ADD);
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  set_enabled(gl, GL_CULL_FACE, state.cull != Cull::off);
  gl.CullFace(state.cull == Cull::front ? GL_FRONT : GL_BACK);
}

}  // namespace spoonbill
