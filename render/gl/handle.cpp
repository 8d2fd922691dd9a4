#include "render/gl/handle.h"

namespace spoonbill {

GlHandle make_buffer(const GlFunctions& gl) {
  GLuint id = 0;
  gl.GenBuffers(1, &id);
  return {gl, id, [](const GlFunctions& f, GLuint i) { f.DeleteBuffers(1, &i); }};
}

GlHandle make_vertex_array(const GlFunctions& gl) {
  GLuint id = 0;
  gl.GenVertexArrays(1, &id);
  return {gl, id, [](const GlFunctions& f, GLuint i) { f.DeleteVertexArrays(1, &i); }};
}

GlHandle make_texture(const GlFunctions& gl) {
  GLuint id = 0;
  gl.GenTextures(1, &id);
  return {gl, id, [](const GlFunctions& f, GLuint i) { f.DeleteTextures(1, &i); }};
}

GlHandle make_renderbuffer(const GlFunctions& gl) {
  GLuint id = 0;
  gl.GenRenderbuffers(1, &id);
  return {gl, id, [](const GlFunctions& f, GLuint i) { f.DeleteRenderbuffers(1, &i); }};
}

GlHandle make_framebuffer(const GlFunctions& gl) {
  GLuint id = 0;
  gl.GenFramebuffers(1, &id);
  return {gl, id, [](const GlFunctions& f, GLuint i) { f.DeleteFramebuffers(1, &i); }};
}

}  // namespace spoonbill
