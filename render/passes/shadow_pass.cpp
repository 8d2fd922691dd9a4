#include "render/passes/shadow_pass.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/geometry.h"
#include "render/passes/frame_view.h"

namespace spoonbill {
namespace {

constexpr const char* shadow_depth_vertex_glsl = R"(
uniform mat4 to_clip;
layout(location = 0) in float x;
layout(location = 1) in float y;
layout(location = 2) in float z;
void main() { gl_Position = to_clip * vec4(x, y, z, 1.0); }
)";

constexpr const char* shadow_depth_fragment_glsl = R"(
void main() {}
)";

// Draws the objects that hide light from the ground, with MAX blending. Red is 1 where the key light is
// blocked, green is the height of the highest object, and blue is the closeness of the lowest object
// overhead.
constexpr const char* shadow_cover_vertex_glsl = R"(
uniform mat4 to_clip;
uniform float ground_height;
layout(location = 0) in float x;
layout(location = 1) in float y;
layout(location = 2) in float z;
out float height;
void main() {
  height = y - ground_height;
  gl_Position = to_clip * vec4(x, y, z, 1.0);
}
)";

constexpr const char* shadow_cover_fragment_glsl = R"(
uniform float high;
uniform float reach;
uniform int overhead;
in float height;
out vec4 result;

void main() {
  vec2 covered = vec2(1.0, height / high) * step(0.0, height);
  float close = exp(-max(height, 0.0) / reach);
  result = overhead != 0 ? vec4(0.0, 0.0, close, 1.0) : vec4(covered, 0.0, 1.0);
}
)";

// Computes the light on the ground: a percentage-closer soft shadow of the key light, and the occlusion of
// the sky nearby. This source must be appended to sphere_shadow_glsl. The taps (texture reads) form a
// golden-angle spiral and read the mip level whose texels are about as wide as the gap between taps. A coarse
// level, whose four texels cover all taps, shows where nothing hides the light. The loops are skipped there,
// which saves most of the time on a software renderer.
constexpr const char* ground_light_fragment_glsl = R"(
uniform sampler2D cover;
uniform vec2 corner;
uniform float side;
uniform float ground_texels;
uniform float cover_texels;
uniform float high;
uniform float spread;
uniform float reach;
uniform float ground_height;
out vec4 result;

const int search_taps = 8;
const int taps = 14;

float level_for(float radius) { return max(log2(radius * cover_texels / side * 0.5), 0.0); }

// Returns the sum of the taps over a disc around uv; takes no taps if `any` is 0.
vec3 gather(vec2 uv, float radius, float level, int count, float any) {
  const mat2 golden_turn = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
  vec2 way = vec2(radius / side, 0.0);
  vec3 sum = vec3(0.0);
  int end = any > 0.0 ? count : 0;
  for (int i = 0; i < end; ++i) {
    sum += textureLod(cover, uv + way * sqrt((float(i) + 0.5) / float(count)), level).rgb;
    way = golden_turn * way;
  }
  return sum;
}

void main() {
  vec2 uv = gl_FragCoord.xy / ground_texels;
  vec3 ground = vec3(corner.x + uv.x * side, ground_height, corner.y + uv.y * side);

  float search = max(high * spread, 1.5 * side / ground_texels);
  float level = level_for(search);
  float near = textureLod(cover, uv, ceil(level) + 2.0).r;
  vec2 blockers = gather(uv, search, level + 0.5, search_taps, near).rg;

  float mean_height = high * blockers.g / max(blockers.r, 1e-6);
  float radius = max(mean_height * spread, 0.8 * side / ground_texels);
  float covered = gather(uv, radius, level_for(radius), taps, blockers.r).r;
  float key = 1.0 - covered / float(taps);

  level = level_for(reach);
  near = textureLod(cover, uv, ceil(level) + 2.0).b;
  float hidden = gather(uv, reach, level, taps, near).b;
  float sky = 1.0 - 0.85 * min(hidden / float(taps), 1.0);

  key *= key_past_sphere(ground);
  sky *= sky_past_sphere(ground, vec3(0.0, 1.0, 0.0));
  // The weights of key and sky add up to one, so that open ground leaves the background unchanged. The light is linear;
  // the background that it dims is encoded.
  float dark = 1.0 - pow(0.06 + 0.94 * (0.46 * key + 0.54 * sky), 1.0 / 2.2);
  result = vec4(dark);
}
)";

constexpr int key_side_px = 1024;
constexpr int cover_side_px = 256;
constexpr int ground_side_px = 192;

// Distance from the body within which the ground is darkened because the body hides part of the sky.
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

int used_px(float fraction, int side_px) {
  return std::min(side_px, static_cast<int>(std::ceil(fraction * static_cast<float>(side_px))) + 1);
}

constexpr float contact_margin_m = 0.012f;

// Returns the matrix that projects points onto the ground along `along`, into the clip space of a square map.
// If `sign` is +1, the highest point is in front; if it is -1, the lowest.
Eigen::Matrix4f ground_projection(const ShadowArea& area, const Eigen::Vector3f& along, float ground_y_m,
                                  float sign) {
  const float to_clip = 2.0f / area.side_m;
  const float skew_x = -along.x() / along.y(), skew_z = -along.z() / along.y();
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m(0, 0) = to_clip;
  m(0, 1) = to_clip * skew_x;
  m(0, 3) = to_clip * (-skew_x * ground_y_m - area.corner_m.x()) - 1.0f;
  m(1, 2) = to_clip;
  m(1, 1) = to_clip * skew_z;
  m(1, 3) = to_clip * (-skew_z * ground_y_m - area.corner_m.y()) - 1.0f;
  const float depth = 2.0f / (area.high_m - area.low_m);
  m(2, 1) = -sign * depth;
  m(2, 3) = sign * depth * (ground_y_m + 0.5f * (area.low_m + area.high_m));
  m(3, 3) = 1.0f;
  return m;
}

// The rectangle of the ground that shadows of the key light and the darkening below the bodies can reach.
struct Footprint {
  FloatBox2 box;

  void include_shadow(const Box& caster, float ground_y_m, const Eigen::Vector3f& toward_key) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3f corner = caster.corner(i).cast<float>();
      const float height = std::max(0.0f, corner.y() - ground_y_m);
      const Eigen::Vector2f below(corner.x(), corner.z());
      const Eigen::Vector2f cast =
          below - Eigen::Vector2f(toward_key.x(), toward_key.z()) * (height / toward_key.y());
      const Eigen::Vector2f soft = Eigen::Vector2f::Constant(key_light_spread * height + contact_margin_m);
      box.join({below.cwiseMin(cast) - soft, below.cwiseMax(cast) + soft});
    }
  }
};

// Rounds a size up to one of eight steps per octave.
float quantised_size(float size) {
  const float octave = std::exp2(std::floor(std::log2(size)));
  return octave * std::ceil(8.0f * size / octave) / 8.0f;
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
  gl_->Viewport(0, 0, used_px(area_.used_fraction.x(), ground_side_px),
                used_px(area_.used_fraction.y(), ground_side_px));
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

ShadowArea shadow_area(const Box& body, const Box& tool, float ground_y_m, const Eigen::Vector3f& toward_key,
                       int map_side_px) {
  Box box = body;
  if (box.is_empty()) box.include(Vector3(0.0, ground_y_m, 0.0));
  Footprint footprint;
  footprint.include_shadow(box, ground_y_m, toward_key);
  if (!tool.is_empty()) footprint.include_shadow(tool, ground_y_m, toward_key);
  const Eigen::Vector2f low = footprint.box.low, high = footprint.box.high;
  ShadowArea area;
  area.side_m = quantised_size((high - low).maxCoeff());
  const float step = area.side_m / 64.0f;
  area.side_m += step;
  const float texel = area.side_m / static_cast<float>(map_side_px);
  const float snap = std::max(1.0f, std::round(step / texel)) * texel;
  area.corner_m = (low / snap).array().floor().matrix() * snap;
  area.used_fraction = ((high - area.corner_m) / area.side_m).cwiseMin(1.0f);
  area.low_m = static_cast<float>(box.low.y()) - ground_y_m - 0.001f;
  area.high_m = static_cast<float>(box.high.y()) - ground_y_m + 0.001f;
  area.key_to_clip = ground_projection(area, toward_key, ground_y_m, 1.0f);
  area.sky_to_clip = ground_projection(area, Eigen::Vector3f::UnitY(), ground_y_m, -1.0f);
  return area;
}

}  // namespace spoonbill
