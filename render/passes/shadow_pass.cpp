#include "render/passes/shadow_pass.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/geometry.h"
#include "render/gl/pipeline_state.h"
#include "render/passes/lighting_glsl.h"
#include "render/passes/shadow_glsl.h"
#include "render/passes/whole_viewport_glsl.h"

namespace spoonbill {
namespace {

constexpr int key_side_px = 1024;
constexpr int cover_side_px = 256;
constexpr int ground_side_px = 192;

// How far from the body the ground under it is darkened by the hidden sky.
constexpr float contact_reach_m = 0.007f;

GlHandle make_map(const GlFunctions& gl, GLint internal_format, GLenum format, GLenum type, int side_px,
                  GLint filter) {
  GlHandle map = make_texture(gl);
  gl.BindTexture(GL_TEXTURE_2D, map.id());
  gl.TexImage2D(GL_TEXTURE_2D, 0, internal_format, side_px, side_px, 0, format, type, nullptr);
  const bool mipmapped = filter == GL_LINEAR_MIPMAP_NEAREST;
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, mipmapped ? GL_LINEAR : filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return map;
}

GlHandle make_map_framebuffer(const GlFunctions& gl, GLenum attachment, const GlHandle& map) {
  GlHandle framebuffer = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, map.id(), 0);
  if (attachment == GL_DEPTH_ATTACHMENT) {
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
  }
  return framebuffer;
}

int used_px(float share, int side_px) {
  return std::min(side_px, static_cast<int>(std::ceil(share * static_cast<float>(side_px))) + 1);
}

}  // namespace

void set_tool_uniforms(const Program& program, const ToolSphere& tool) {
  program.set("tool_centre", tool.centre_m);
  program.set("tool_radius", tool.radius_m);
}

Result<ShadowPass> ShadowPass::make(const GlFunctions& gl) {
  auto depth = Program::make(gl, "shadow depth", shadow_depth_vertex_glsl, shadow_depth_fragment_glsl);
  if (!depth) return depth.error();
  auto cover = Program::make(gl, "shadow cover", shadow_cover_vertex_glsl, shadow_cover_fragment_glsl);
  if (!cover) return cover.error();
  auto ground = Program::make(gl, "ground light", whole_viewport_vertex_glsl,
                              std::string(key_light_glsl) + sphere_shadow_glsl + ground_light_fragment_glsl);
  if (!ground) return ground.error();
  return ShadowPass(gl,
                    Programs{std::move(depth).value(), std::move(cover).value(), std::move(ground).value()});
}

ShadowPass::ShadowPass(const GlFunctions& gl, Programs programs)
    : gl_(&gl),
      programs_(std::move(programs)),
      vertex_array_(make_vertex_array(gl)),
      key_map_(
          make_map(gl, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, key_side_px, GL_LINEAR)),
      cover_(make_map(gl, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, cover_side_px, GL_LINEAR_MIPMAP_NEAREST)),
      ground_dark_(make_map(gl, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, ground_side_px, GL_LINEAR)),
      key_framebuffer_(make_map_framebuffer(gl, GL_DEPTH_ATTACHMENT, key_map_)),
      cover_framebuffer_(make_map_framebuffer(gl, GL_COLOR_ATTACHMENT0, cover_)),
      ground_framebuffer_(make_map_framebuffer(gl, GL_COLOR_ATTACHMENT0, ground_dark_)) {
  gl.BindTexture(GL_TEXTURE_2D, key_map_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
}

float ShadowPass::highest_m() const {
  return std::max(area_.high_m, 1e-4f);
}

int ShadowPass::key_map_side_px() {
  return key_side_px;
}

void ShadowPass::draw(const FrameView& view, const std::vector<SurfaceBuffers>& bodies, const Box& body_box,
                      const Box& tool_box, const ToolSphere& tool) {
  area_ = shadow_area(body_box, tool_box, view.ground_y_m, view.toward_key, key_side_px);
  draw_key_map(bodies);
  draw_cover(view, bodies);
  light_ground(view, tool);
}

void ShadowPass::draw_key_map(const std::vector<SurfaceBuffers>& bodies) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, key_framebuffer_.id());
  gl_->Viewport(0, 0, key_side_px, key_side_px);
  set_pipeline_state(*gl_, {Depth::test_and_write, Blend::off, Cull::off});
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  programs_.depth.use();
  programs_.depth.set("to_clip", area_.key_to_clip);
  for (const SurfaceBuffers& body : bodies) body.draw();
}

void ShadowPass::draw_cover(const FrameView& view, const std::vector<SurfaceBuffers>& bodies) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, cover_framebuffer_.id());
  gl_->Viewport(0, 0, cover_side_px, cover_side_px);
  set_pipeline_state(*gl_, {Depth::off, Blend::maximum, Cull::off});
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
  const Program& program = programs_.cover;
  program.use();
  program.set("high", highest_m());
  program.set("reach", contact_reach_m);
  program.set("ground_height", view.ground_y_m);
  for (const int overhead : {0, 1}) {
    program.set("to_clip", overhead != 0 ? area_.sky_to_clip : area_.key_to_clip);
    program.set("overhead", overhead);
    for (const SurfaceBuffers& body : bodies) body.draw();
  }
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, cover_.id());
  gl_->GenerateMipmap(GL_TEXTURE_2D);
}

void ShadowPass::light_ground(const FrameView& view, const ToolSphere& tool) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, ground_framebuffer_.id());
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
  gl_->Viewport(0, 0, used_px(area_.used_share.x(), ground_side_px),
                used_px(area_.used_share.y(), ground_side_px));
  const Program& program = programs_.ground;
  program.use();
  program.set("cover", 0);
  program.set("corner", area_.corner_m);
  program.set("side", area_.side_m);
  program.set("ground_texels", static_cast<float>(ground_side_px));
  program.set("cover_texels", static_cast<float>(cover_side_px));
  program.set("high", highest_m());
  program.set("spread", key_light_spread);
  program.set("reach", contact_reach_m);
  program.set("ground_height", view.ground_y_m);
  program.set("toward_key", view.toward_key);
  set_tool_uniforms(program, tool);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, cover_.id());
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace spoonbill
