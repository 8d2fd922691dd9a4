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

// Returns the gradient as RGBA8 or BGRA8, bottom row first.
std::vector<std::uint8_t> gradient(const Studio& studio, int width_px, int height_px, GLenum channels) {
  const Eigen::Vector3d top = studio.top_srgb.cast<double>(), bottom = studio.bottom_srgb.cast<double>();
  std::vector<std::uint8_t> texels;
  texels.reserve(4 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (int y = 0; y < height_px; ++y) {
    const double t = (y + 0.5) / height_px;
    const double fraction = t * t * (3.0 - 2.0 * t);
    std::uint8_t colour[4] = {0, 0, 0, 255};
    const bool is_reversed = channels == GL_BGRA;
    // The channels are dithered with different offsets; otherwise rows would be visible.
    for (int c = 0; c < 3; ++c) {
      colour[is_reversed ? 2 - c : c] = dithered(bottom[c] + fraction * (top[c] - bottom[c]), y + 3 * c);
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

constexpr const char* stretched_source = R"(
uniform sampler2D scene;
uniform vec2 texture_per_px;
out vec4 result;
void main() { result = texture(scene, gl_FragCoord.xy * texture_per_px); }
)";

}  // namespace

void BackgroundPass::build(const Studio& studio, const RenderTarget& target) {
  width_px_ = target.width_px();
  height_px_ = target.height_px();
  channels_ = target.channels();
  picture_ = make_texture(*gl_);
  gl_->BindTexture(GL_TEXTURE_2D, picture_.id());
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_px_, height_px_, 0, channels_, GL_UNSIGNED_BYTE,
                  gradient(studio, width_px_, height_px_, channels_).data());
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  framebuffer_ = make_framebuffer(*gl_);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_.id(), 0);
  top_srgb_ = studio.top_srgb;
  bottom_srgb_ = studio.bottom_srgb;
}

void BackgroundPass::draw(const Studio& studio, const RenderTarget& target) {
  const int width = target.width_px(), height = target.height_px();
  const bool is_built = width == width_px_ && height == height_px_ && target.channels() == channels_ &&
                        studio.top_srgb == top_srgb_ && studio.bottom_srgb == bottom_srgb_;
  if (!is_built) build(studio, target);
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
  std::vector<Program> programs;
  for (const char* const source : {with_samples_source, without_samples_source, stretched_source}) {
    auto program = Program::make(gl, "resolve", whole_viewport_vertex_glsl, source);
    if (!program) return program.error();
    programs.push_back(std::move(program).value());
  }
  return ResolvePass(gl, std::move(programs[0]), std::move(programs[1]), std::move(programs[2]));
}

ResolvePass::ResolvePass(const GlFunctions& gl, Program with_samples, Program without_samples,
                         Program stretched)
    : gl_(&gl),
      with_samples_(std::move(with_samples)),
      without_samples_(std::move(without_samples)),
      stretched_(std::move(stretched)),
      vertex_array_(make_vertex_array(gl)) {}

void ResolvePass::draw(const RenderTarget& target, std::span<const PixelArea> areas) const {
  const PixelSize frame{target.width_px(), target.height_px()}, scene = target.scene_size();
  set_pipeline_state(*gl_, {Depth::off, Blend::premultiplied, Cull::off});
  const Program& program = target.samples() > 0 ? with_samples_
                           : scene == frame     ? without_samples_
                                                : stretched_;
  program.use();
  program.set("scene", 0);
  if (&program == &stretched_) {
    program.set("texture_per_px", Eigen::Vector2f(1.0f / static_cast<float>(frame.width_px),
                                                  1.0f / static_cast<float>(frame.height_px)));
  }
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(target.scene_texture_kind(), target.scene_texture());
  gl_->BindVertexArray(vertex_array_.id());
  const auto in_frame = [](int at, int scene_px, int frame_px) { return at * frame_px / scene_px; };
  for (const PixelArea& area : areas) {
    const int left = in_frame(area.x, scene.width_px, frame.width_px);
    const int bottom = in_frame(area.y, scene.height_px, frame.height_px);
    const int right = in_frame(area.x + area.width, scene.width_px, frame.width_px);
    const int top = in_frame(area.y + area.height, scene.height_px, frame.height_px);
    gl_->Viewport(left, bottom, right - left, top - bottom);
    gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl_->Viewport(0, 0, frame.width_px, frame.height_px);
}

}  // namespace spoonbill
