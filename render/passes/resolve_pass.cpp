#include "render/passes/resolve_pass.h"

#include <string>
#include <utility>

#include "render/gl/pipeline_state.h"
#include "render/passes/whole_viewport_glsl.h"

namespace spoonbill {
namespace {

constexpr const char* with_samples_source = R"(
uniform sampler2DMS scene;
out vec4 result;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  result = 0.25 * (texelFetch(scene, pixel, 0) + texelFetch(scene, pixel, 1) + texelFetch(scene, pixel, 2) +
                   texelFetch(scene, pixel, 3));
}
)";

constexpr const char* without_samples_source = R"(
uniform sampler2D scene;
out vec4 result;
void main() { result = texelFetch(scene, ivec2(gl_FragCoord.xy), 0); }
)";

}  // namespace

Result<ResolvePass> ResolvePass::make(const GlFunctions& gl) {
  auto with = Program::make(gl, "resolve", whole_viewport_vertex_glsl, with_samples_source);
  if (!with) return with.error();
  auto without = Program::make(gl, "resolve", whole_viewport_vertex_glsl, without_samples_source);
  if (!without) return without.error();
  return ResolvePass(gl, std::move(with).value(), std::move(without).value());
}

ResolvePass::ResolvePass(const GlFunctions& gl, Program with_samples, Program without_samples)
    : gl_(&gl),
      with_samples_(std::move(with_samples)),
      without_samples_(std::move(without_samples)),
      vertex_array_(make_vertex_array(gl)) {}

void ResolvePass::draw(const RenderTarget& target, std::span<const PixelArea> areas) const {
  set_pipeline_state(*gl_, {Depth::off, Blend::premultiplied, Cull::off});
  const Program& program = target.samples() > 0 ? with_samples_ : without_samples_;
  program.use();
  program.set("scene", 0);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(target.scene_texture_kind(), target.scene_texture());
  gl_->BindVertexArray(vertex_array_.id());
  for (const PixelArea& area : areas) {
    gl_->Viewport(area.x, area.y, area.width, area.height);
    gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl_->Viewport(0, 0, target.width_px(), target.height_px());
}

}  // namespace spoonbill
