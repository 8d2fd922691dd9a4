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

const char* const shadow_reduce_fragment_glsl = R"(
uniform sampler2D key_map;
uniform sampler2D sky_map;
uniform float low;
uniform float high;
uniform float reach;
out vec4 result;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float covered = 0.0;
  float heights = 0.0;
  for (int i = 0; i < 16; ++i) {
    float depth = texelFetch(key_map, at * 4 + ivec2(i & 3, i >> 2), 0).r;
    float height = high - depth * (high - low);
    if (depth < 1.0 && height > 0.0) {
      covered += 1.0 / 16.0;
      heights += height / high / 16.0;
    }
  }
  float overhead = texelFetch(sky_map, at, 0).r;
  float gap = max(low + overhead * (high - low), 0.0);
  float close = overhead < 1.0 ? exp(-gap / reach) : 0.0;
  result = vec4(covered, heights, close, 1.0);
}
)";

// The discs are a golden-angle spiral; each tap reads the level whose texels are about as wide as the gap
// between taps.
const char* const ground_light_fragment_glsl = R"(
uniform sampler2D cover;
uniform vec2 corner;
uniform float side;
uniform float texels;
uniform float high;
uniform float spread;
uniform float reach;
uniform float ground_height;
out vec4 result;

const int search_taps = 8;
const int taps = 14;

vec2 spiral(int i, int count) {
  float angle = 2.39996323 * float(i);
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

float level_for(float radius) { return max(log2(radius * texels / side * 0.5), 0.0); }

void main() {
  vec2 uv = gl_FragCoord.xy / texels;
  vec3 ground = vec3(corner.x + uv.x * side, ground_height, corner.y + uv.y * side);

  float search = max(high * spread, 1.5 * side / texels);
  vec2 blockers = vec2(0.0);
  float level = level_for(search);
  for (int i = 0; i < search_taps; ++i) {
    blockers += textureLod(cover, uv + spiral(i, search_taps) * search / side, level + 0.5).rg;
  }

  float key = 1.0;
  if (blockers.r > 0.0) {
    float radius = max(high * blockers.g / blockers.r * spread, 0.8 * side / texels);
    level = level_for(radius);
    float covered = 0.0;
    for (int i = 0; i < taps; ++i) covered += textureLod(cover, uv + spiral(i, taps) * radius / side, level).r;
    key = 1.0 - covered / float(taps);
  }

  // A level so coarse that its four texels hold all that the taps could see tells where there is nothing.
  float hidden = 0.0;
  level = level_for(reach);
  if (textureLod(cover, uv, ceil(level) + 3.0).b > 0.0) {
    for (int i = 0; i < taps; ++i) hidden += textureLod(cover, uv + spiral(i, taps) * reach / side, level).b;
  }
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
