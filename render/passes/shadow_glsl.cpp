#include "render/passes/shadow_glsl.h"

namespace spoonbill {

const char* const shadow_depth_vertex_glsl = R"(
uniform mat4 to_clip;
layout(location = 0) in float x;
layout(location = 1) in float y;
layout(location = 2) in float z;
void main() { gl_Position = to_clip * vec4(x, y, z, 1.0); }
)";

const char* const shadow_depth_fragment_glsl = R"(
void main() {}
)";

const char* const shadow_cover_vertex_glsl = R"(
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

const char* const shadow_cover_fragment_glsl = R"(
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

// The discs are a golden-angle spiral; each tap reads the level whose texels are about as wide as the gap
// between taps. A level so coarse that its four texels hold all that the taps could see tells where there is
// nothing: the loops do not run there, which on a processor that draws most of the ground is most of the
// time.
const char* const ground_light_fragment_glsl = R"(
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

// The sum over a disc around uv, zero taps where `any` is 0.
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
  // The shares of key and sky add to one: an open ground lets the background through unchanged. The light is linear,
  // the background that it dims is encoded.
  float dark = 1.0 - pow(0.06 + 0.94 * (0.46 * key + 0.54 * sky), 1.0 / 2.2);
  result = vec4(dark);
}
)";

}  // namespace spoonbill
