// The GL function table, owners of GL objects, shader programs, and the fixed-function state of draw calls.
#pragma once

#include <GL/glcorearb.h>

#include <Eigen/Core>
#include <string>
#include <utility>

#include "engine/base/result.h"
#include "render/gl/context.h"

namespace spoonbill {

// List of X(type, name), one for each GL function in use. `name` becomes a member of GlFunctions and is
// loaded as "gl" + name.
#define SPOONBILL_GL_FUNCTIONS(X)                                            \
  X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                                   \
  X(PFNGLATTACHSHADERPROC, AttachShader)                                     \
  X(PFNGLBINDBUFFERPROC, BindBuffer)                                         \
  X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                               \
  X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                             \
  X(PFNGLBINDTEXTUREPROC, BindTexture)                                       \
  X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                               \
  X(PFNGLBLENDEQUATIONPROC, BlendEquation)                                   \
  X(PFNGLBLENDFUNCPROC, BlendFunc)                                           \
  X(PFNGLBLENDFUNCSEPARATEPROC, BlendFuncSeparate)                           \
  X(PFNGLBLITFRAMEBUFFERPROC, BlitFramebuffer)                               \
  X(PFNGLBUFFERDATAPROC, BufferData)                                         \
  X(PFNGLBUFFERSUBDATAPROC, BufferSubData)                                   \
  X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)                 \
  X(PFNGLCLEARPROC, Clear)                                                   \
  X(PFNGLCLEARCOLORPROC, ClearColor)                                         \
  X(PFNGLCOMPILESHADERPROC, CompileShader)                                   \
  X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                   \
  X(PFNGLCREATESHADERPROC, CreateShader)                                     \
  X(PFNGLCULLFACEPROC, CullFace)                                             \
  X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                   \
  X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                         \
  X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                   \
  X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                       \
  X(PFNGLDELETESHADERPROC, DeleteShader)                                     \
  X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                 \
  X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                         \
  X(PFNGLDEPTHFUNCPROC, DepthFunc)                                           \
  X(PFNGLDEPTHMASKPROC, DepthMask)                                           \
  X(PFNGLDISABLEPROC, Disable)                                               \
  X(PFNGLDRAWARRAYSPROC, DrawArrays)                                         \
  X(PFNGLDRAWARRAYSINSTANCEDPROC, DrawArraysInstanced)                       \
  X(PFNGLDRAWBUFFERPROC, DrawBuffer)                                         \
  X(PFNGLDRAWELEMENTSPROC, DrawElements)                                     \
  X(PFNGLDRAWELEMENTSBASEVERTEXPROC, DrawElementsBaseVertex)                 \
  X(PFNGLENABLEPROC, Enable)                                                 \
  X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)               \
  X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)               \
  X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)                     \
  X(PFNGLGENBUFFERSPROC, GenBuffers)                                         \
  X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                               \
  X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                             \
  X(PFNGLGENTEXTURESPROC, GenTextures)                                       \
  X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                               \
  X(PFNGLGENERATEMIPMAPPROC, GenerateMipmap)                                 \
  X(PFNGLGETERRORPROC, GetError)                                             \
  X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                           \
  X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                     \
  X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                             \
  X(PFNGLGETSHADERIVPROC, GetShaderiv)                                       \
  X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                         \
  X(PFNGLLINKPROGRAMPROC, LinkProgram)                                       \
  X(PFNGLPIXELSTOREIPROC, PixelStorei)                                       \
  X(PFNGLREADBUFFERPROC, ReadBuffer)                                         \
  X(PFNGLREADPIXELSPROC, ReadPixels)                                         \
  X(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, RenderbufferStorageMultisample) \
  X(PFNGLSCISSORPROC, Scissor)                                               \
  X(PFNGLSHADERSOURCEPROC, ShaderSource)                                     \
  X(PFNGLTEXIMAGE2DPROC, TexImage2D)                                         \
  X(PFNGLTEXIMAGE2DMULTISAMPLEPROC, TexImage2DMultisample)                   \
  X(PFNGLTEXPARAMETERIPROC, TexParameteri)                                   \
  X(PFNGLTEXPARAMETERIVPROC, TexParameteriv)                                 \
  X(PFNGLUNIFORM1FPROC, Uniform1f)                                           \
  X(PFNGLUNIFORM1IPROC, Uniform1i)                                           \
  X(PFNGLUNIFORM2FPROC, Uniform2f)                                           \
  X(PFNGLUNIFORM3FPROC, Uniform3f)                                           \
  X(PFNGLUNIFORM4FPROC, Uniform4f)                                           \
  X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                             \
  X(PFNGLUSEPROGRAMPROC, UseProgram)                                         \
  X(PFNGLVERTEXATTRIBDIVISORPROC, VertexAttribDivisor)                       \
  X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                       \
  X(PFNGLVIEWPORTPROC, Viewport)

// The GL functions in use. Plain data after loading, valid for one context on the thread of that context.
struct GlFunctions {
#define SPOONBILL_GL_MEMBER(type, name) type name = nullptr;
  SPOONBILL_GL_FUNCTIONS(SPOONBILL_GL_MEMBER)
#undef SPOONBILL_GL_MEMBER
};

// Loads the functions from the context, which must be current. If a function is missing, the error names the
// function and the remedy.
Result<GlFunctions> load_gl_functions(const GlContext& context);

// Owns a GL object and deletes it in the destructor, when the context must be current. Movable, not copyable.
// The function table must outlive the handle.
class GlHandle {
 public:
  using Destroy = void (*)(const GlFunctions& gl, GLuint id);

  GlHandle() = default;
  GlHandle(const GlFunctions& gl, GLuint id, Destroy destroy) : gl_(&gl), id_(id), destroy_(destroy) {}
  GlHandle(GlHandle&& other) noexcept
      : gl_(other.gl_), id_(std::exchange(other.id_, 0)), destroy_(other.destroy_) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    if (this != &other) {
      reset();
      gl_ = other.gl_;
      id_ = std::exchange(other.id_, 0);
      destroy_ = other.destroy_;
    }
    return *this;
  }
  ~GlHandle() { reset(); }

  // Returns the GL name, 0 if empty.
  GLuint id() const { return id_; }

 private:
  void reset() {
    if (id_ != 0) destroy_(*gl_, id_);
    id_ = 0;
  }

  const GlFunctions* gl_ = nullptr;
  GLuint id_ = 0;
  Destroy destroy_ = nullptr;
};

GlHandle make_buffer(const GlFunctions& gl);
GlHandle make_vertex_array(const GlFunctions& gl);
GlHandle make_texture(const GlFunctions& gl);
GlHandle make_renderbuffer(const GlFunctions& gl);
GlHandle make_framebuffer(const GlFunctions& gl);

// A linked shader program, whose uniforms are set by name.
class Program {
 public:
  // Compiles and links GLSL sources, to which the version line is prepended. Errors contain `name`, the stage
  // and the message of the compiler.
  static Result<Program> make(const GlFunctions& gl, const char* name, const std::string& vertex_source,
                              const std::string& fragment_source);

  void use() const { gl_->UseProgram(handle_.id()); }

  // Sets a uniform; the program must be in use. A uniform that the compiler removed is ignored.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  Program(const GlFunctions& gl, GlHandle handle) : gl_(&gl), handle_(std::move(handle)) {}

  const GlFunctions* gl_;
  GlHandle handle_;
};

enum class Depth { off, test, test_and_write };
// `premultiplied` blends the source over the destination; `maximum` keeps the larger value of each channel.
enum class Blend { off, premultiplied, maximum };
enum class Cull { off, back, front };

// The fixed-function state of a draw call. Every pass sets the complete state, so that no pass depends on an
// earlier pass. Scissoring is not included; the render target and the interface manage it.
struct PipelineState {
  Depth depth = Depth::off;
  Blend blend = Blend::off;
  Cull cull = Cull::off;
};

void set_pipeline_state(const GlFunctions& gl, const PipelineState& state);

}  // namespace spoonbill
