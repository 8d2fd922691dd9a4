#include "render/passes/frame_passes.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "render/passes/frame_view.h"

namespace spoonbill {
namespace {

// Ordered dithering of rows hides the steps of eight-bit colours. It is by less than a step, so that
// neighbouring rows differ by at most one. Each row has one colour, which keeps PNG files small and fast to
// write.
constexpr double dithered_part = 0.7;
constexpr int pattern_rows = 8;
constexpr int pattern[pattern_rows] = {0, 4, 2, 6, 1, 5, 3, 7};

std::uint8_t dithered(double value, int row) {
  const double threshold = 0.5 + dithered_part * ((pattern[row % pattern_rows] + 0.5) / pattern_rows - 0.5);
  return static_cast<std::uint8_t>(std::floor(value + threshold));
}

// Returns the gradient as RGBA8, bottom row first.
std::vector<std::uint8_t> gradient(const Studio& studio, int width_px, int height_px) {
  const Eigen::Vector3d top = studio.top_srgb.cast<double>(), bottom = studio.bottom_srgb.cast<double>();
  std::vector<std::uint8_t> texels;
  texels.reserve(4 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (int y = 0; y < height_px; ++y) {
    const double t = (y + 0.5) / height_px;
    const double fraction = t * t * (3.0 - 2.0 * t);
    std::uint8_t colour[4] = {0, 0, 0, 255};
    // The channels are dithered with different offsets; otherwise rows would be visible.
    for (int c = 0; c < 3; ++c) {
      colour[c] = dithered(bottom[c] + fraction * (top[c] - bottom[c]), y + 3 * c);
    }
    for (int x = 0; x < width_px; ++x) texels.insert(texels.end(), colour, colour + 4);
  }
  return texels;
}

// The part that is left of the floor's sRGB colour where no light reaches it: slightly blue.
const Eigen::Vector3f deepest_shadow(0.107f, 0.118f, 0.150f);

constexpr const char* ground_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec2 corner;
uniform vec2 size;
uniform vec2 used;
uniform float ground_y;
out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * used;
  vec2 at = corner + uv * size;
  gl_Position = world_to_clip * vec4(at.x, ground_y, at.y, 1.0);
}
)";

constexpr const char* ground_fragment_source = R"(
uniform sampler2D ground_dark;
uniform vec3 shadow_colour;
in vec2 uv;
out vec4 result;
void main() {
  float dark = texture(ground_dark, uv).r;
  result = vec4(shadow_colour * dark, dark);
}
)";

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

void BackgroundPass::build(const Studio& studio, int width_px, int height_px) {
  picture_ = make_texture(*gl_);
  gl_->BindTexture(GL_TEXTURE_2D, picture_.id());
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_px, height_px, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  gradient(studio, width_px, height_px).data());
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  framebuffer_ = make_framebuffer(*gl_);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_.id(), 0);
  width_px_ = width_px;
  height_px_ = height_px;
  top_srgb_ = studio.top_srgb;
  bottom_srgb_ = studio.bottom_srgb;
}

void BackgroundPass::draw(const Studio& studio, const RenderTarget& target) {
  const int width = target.width_px(), height = target.height_px();
  const bool is_built = width == width_px_ && height == height_px_ && studio.top_srgb == top_srgb_ &&
                        studio.bottom_srgb == bottom_srgb_;
  if (!is_built) build(studio, width, height);
  target.begin_frame();
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  gl_->BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Result<GroundPass> GroundPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "ground", ground_vertex_source, ground_fragment_source);
  if (!program) return program.error();
  return GroundPass(gl, std::move(program).value());
}

GroundPass::GroundPass(const GlFunctions& gl, Program program)
    : gl_(&gl), program_(std::move(program)), vertex_array_(make_vertex_array(gl)) {}

void GroundPass::draw_shadow(const FrameView& view, const ShadowPass& shadow) const {
  if (view.eye_m.y() <= view.ground_y_m) return;
  const ShadowArea& area = shadow.area();
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("corner", area.corner_m);
  program_.set("size", Eigen::Vector2f(area.side_m, area.side_m));
  program_.set("used", area.used_fraction);
  program_.set("ground_dark", 0);
  const Eigen::Vector3f floor = view.studio.bottom_srgb / 255.0f;
  program_.set("shadow_colour", floor.cwiseProduct(deepest_shadow).eval());
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, shadow.ground_dark());
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

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
