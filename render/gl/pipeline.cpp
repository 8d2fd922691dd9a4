#include "render/gl/pipeline.h"

#include <array>
#include <string>

namespace spoonbill {
namespace {

template <class Function>
bool load(const GlContext& context, const char* name, Function& function) {
  function = reinterpret_cast<Function>(context.procedure(name));
  return function != nullptr;
}

constexpr const char* version_line = "#version 330 core\n";

Result<GlHandle> compile(const GlFunctions& gl, const char* name, GLenum stage, const std::string& source) {
  GlHandle shader(gl, gl.CreateShader(stage), [](const GlFunctions& f, GLuint i) { f.DeleteShader(i); });
  const std::array<const GLchar*, 2> parts = {version_line, source.c_str()};
  gl.ShaderSource(shader.id(), static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
  gl.CompileShader(shader.id());
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<GLchar, 2048> log{};
  gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  const char* stage_name = stage == GL_VERTEX_SHADER ? "vertex" : "fragment";
  return Error{ErrorCode::internal,
               std::string("shader ") + name + ", " + stage_name + " stage: " + log.data()};
}

void set_enabled(const GlFunctions& gl, GLenum capability, bool enabled) {
  enabled ? gl.Enable(capability) : gl.Disable(capability);
}

}  // namespace

Result<GlFunctions> load_gl_functions(const GlContext& context) {
  GlFunctions gl;
#define SPOONBILL_GL_LOAD(type, name)                                                              \
  if (!load(context, "gl" #name, gl.name)) {                                                       \
    return Error{ErrorCode::unavailable,                                                           \
                 "the GL context has no gl" #name ": OpenGL 3.3 or later is needed, update Mesa"}; \
  }
  SPOONBILL_GL_FUNCTIONS(SPOONBILL_GL_LOAD)
#undef SPOONBILL_GL_LOAD
  return gl;
}

namespace {

// Makes a GL object with `generate`; its handle deletes it with `remove`.
template <auto generate, auto remove>
GlHandle make_object(const GlFunctions& gl) {
  GLuint id = 0;
  (gl.*generate)(1, &id);
  return {gl, id, [](const GlFunctions& functions, GLuint object) { (functions.*remove)(1, &object); }};
}

}  // namespace

GlHandle make_buffer(const GlFunctions& gl) {
  return make_object<&GlFunctions::GenBuffers, &GlFunctions::DeleteBuffers>(gl);
}

GlHandle make_vertex_array(const GlFunctions& gl) {
  return make_object<&GlFunctions::GenVertexArrays, &GlFunctions::DeleteVertexArrays>(gl);
}

GlHandle make_texture(const GlFunctions& gl) {
  return make_object<&GlFunctions::GenTextures, &GlFunctions::DeleteTextures>(gl);
}

GlHandle make_renderbuffer(const GlFunctions& gl) {
  return make_object<&GlFunctions::GenRenderbuffers, &GlFunctions::DeleteRenderbuffers>(gl);
}

GlHandle make_framebuffer(const GlFunctions& gl) {
  return make_object<&GlFunctions::GenFramebuffers, &GlFunctions::DeleteFramebuffers>(gl);
}

Result<Program> Program::make(const GlFunctions& gl, const char* name, const std::string& vertex_source,
                              const std::string& fragment_source) {
  const auto vertex = compile(gl, name, GL_VERTEX_SHADER, vertex_source);
  if (!vertex) return vertex.error();
  const auto fragment = compile(gl, name, GL_FRAGMENT_SHADER, fragment_source);
  if (!fragment) return fragment.error();

  GlHandle program(gl, gl.CreateProgram(), [](const GlFunctions& f, GLuint i) { f.DeleteProgram(i); });
  gl.AttachShader(program.id(), vertex.value().id());
  gl.AttachShader(program.id(), fragment.value().id());
  gl.LinkProgram(program.id());
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return Program(gl, std::move(program));
  std::array<GLchar, 2048> log{};
  gl.GetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), nullptr, log.data());
  return Error{ErrorCode::internal, std::string("shader ") + name + ", linking: " + log.data()};
}

void Program::set(const char* name, int value) const {
  gl_->Uniform1i(gl_->GetUniformLocation(handle_.id(), name), value);
}

void Program::set(const char* name, float value) const {
  gl_->Uniform1f(gl_->GetUniformLocation(handle_.id(), name), value);
}

void Program::set(const char* name, const Eigen::Vector2f& value) const {
  gl_->Uniform2f(gl_->GetUniformLocation(handle_.id(), name), value.x(), value.y());
}

void Program::set(const char* name, const Eigen::Vector3f& value) const {
  gl_->Uniform3f(gl_->GetUniformLocation(handle_.id(), name), value.x(), value.y(), value.z());
}

void Program::set(const char* name, const Eigen::Vector4f& value) const {
  gl_->Uniform4f(gl_->GetUniformLocation(handle_.id(), name), value.x(), value.y(), value.z(), value.w());
}

void Program::set(const char* name, const Eigen::Matrix4f& value) const {
  gl_->UniformMatrix4fv(gl_->GetUniformLocation(handle_.id(), name), 1, GL_FALSE, value.data());
}

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
