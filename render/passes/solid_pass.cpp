#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "render/passes/studio_light.h"
#include "render/passes/surface_passes.h"

namespace spoonbill {
namespace {

constexpr const char* solid_vertex_source = R"(
uniform mat4 world_to_clip;
uniform mat4 model;
uniform mat4 normal_to_world;
layout(location = 0) in vec3 local_position;
layout(location = 1) in vec3 local_normal;
out vec3 position;
out vec3 normal;
void main() {
  position = (model * vec4(local_position, 1.0)).xyz;
  normal = (normal_to_world * vec4(local_normal, 0.0)).xyz;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
)";

constexpr const char* solid_source = R"(
uniform vec4 colour;
in vec3 position;
in vec3 normal;
out vec4 result;
void main() {
  Look look = Look(colour.rgb, 0.45, 0.0, 0.0);
  result = opaque_colour(studio_light(look, position, normalize(normal), 1.0, 1.0));
}
)";

constexpr const char* glass_source = R"(
uniform vec4 colour;
in vec3 position;
in vec3 normal;
out vec4 result;
void main() {
  vec3 n = normalize(normal);
  Look look = Look(colour.rgb, 0.20, 0.0, 0.0);
  float grazing = 1.0 - clamp(dot(n, normalize(eye - position)), 0.0, 1.0);
  result = clear_colour(studio_light(look, position, n, 1.0, 1.0), mix(0.44, 0.90, grazing * grazing));
}
)";

constexpr const char* pane_source = R"(
uniform vec4 colour;
out vec4 result;
void main() { result = vec4(colour.rgb * colour.a, colour.a); }
)";

constexpr std::array<int, 5> sphere_segments = {16, 28, 44, 68, 104};
constexpr float sphere_sagitta_px = 0.25f;
constexpr int arrow_segments = 28;

Eigen::Matrix4f make_model(const Eigen::Vector3f& origin, const Eigen::Matrix3f& axes) {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  model.topLeftCorner<3, 3>() = axes;
  model.topRightCorner<3, 1>() = origin;
  return model;
}

Eigen::Vector4f to_linear(Colour colour) {
  return {srgb8_to_linear(colour.r), srgb8_to_linear(colour.g), srgb8_to_linear(colour.b),
          static_cast<float>(colour.a) / 255.0f};
}

// Returns the colour in sRGB, as it is written to the picture.
Eigen::Vector4f to_srgb(Colour colour) {
  return Eigen::Vector4i(colour.r, colour.g, colour.b, colour.a).cast<float>() / 255.0f;
}

struct SolidVertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  // unit normal, outward
};

// A point of a profile: distance from the axis, height, and normal in the plane of the profile.
struct LathePoint {
  float radius, height, normal_out, normal_up;
};

SolidVertex revolve(const LathePoint& p, double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{p.radius * c, p.height, p.radius * s}, {p.normal_out * c, p.normal_up, p.normal_out * s}};
}

// Appends the band between two successive points of a profile, which runs from the lower end of the axis to
// the upper end. Each triangle has three vertices, counter-clockwise seen from outside.
void append_band(const LathePoint& low, const LathePoint& high, int segments,
                 std::vector<SolidVertex>& vertices) {
  for (int i = 0; i < segments; ++i) {
    const double a = 2.0 * std::numbers::pi * i / segments;
    const double b = 2.0 * std::numbers::pi * (i + 1) / segments;
    const SolidVertex low_a = revolve(low, a), low_b = revolve(low, b);
    const SolidVertex high_a = revolve(high, a), high_b = revolve(high, b);
    for (const SolidVertex& v : {low_a, high_b, low_b, low_a, high_a, high_b}) vertices.push_back(v);
  }
}

// Returns a sphere of radius 1 around the origin.
std::vector<SolidVertex> lathe_sphere(int segments) {
  std::vector<SolidVertex> vertices;
  const int bands = segments / 2;
  const auto at = [&](int band) {
    const double latitude = std::numbers::pi * (static_cast<double>(band) / bands - 0.5);
    const auto out = static_cast<float>(std::cos(latitude)), up = static_cast<float>(std::sin(latitude));
    return LathePoint{out, up, out, up};
  };
  for (int band = 0; band < bands; ++band) append_band(at(band), at(band + 1), segments, vertices);
  return vertices;
}

// Returns a closed cylinder of radius 1 from y = 0 to 1.
std::vector<SolidVertex> lathe_cylinder(int segments) {
  std::vector<SolidVertex> vertices;
  append_band({0, 0, 0, -1}, {1, 0, 0, -1}, segments, vertices);
  append_band({1, 0, 1, 0}, {1, 1, 1, 0}, segments, vertices);
  append_band({1, 1, 0, 1}, {0, 1, 0, 1}, segments, vertices);
  return vertices;
}

// Returns a closed cone of radius 1 at y = 0 with its tip at y = 1.
std::vector<SolidVertex> lathe_cone(int segments) {
  std::vector<SolidVertex> vertices;
  const auto slant = static_cast<float>(std::numbers::sqrt2 / 2.0);
  append_band({0, 0, 0, -1}, {1, 0, 0, -1}, segments, vertices);
  append_band({1, 0, slant, slant}, {0, 1, slant, slant}, segments, vertices);
  return vertices;
}

// Returns the unit square of the xy plane.
std::vector<SolidVertex> unit_pane() {
  const Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  const SolidVertex a{{0, 0, 0}, normal}, b{{1, 0, 0}, normal}, c{{1, 1, 0}, normal}, d{{0, 1, 0}, normal};
  return {a, b, c, a, c, d};
}

}  // namespace

Result<SolidPass> SolidPass::make(const GlFunctions& gl) {
  const std::string light = std::string("const bool reflects = true;\n") + key_light_glsl + studio_light_glsl;
  auto solid = Program::make(gl, "solid", solid_vertex_source, light + solid_source);
  if (!solid) return solid.error();
  auto glass = Program::make(gl, "glass", solid_vertex_source, light + glass_source);
  if (!glass) return glass.error();
  auto pane = Program::make(gl, "pane", solid_vertex_source, pane_source);
  if (!pane) return pane.error();
  return SolidPass(gl, Programs{std::move(solid).value(), std::move(glass).value(), std::move(pane).value()});
}

SolidPass::SolidPass(const GlFunctions& gl, Programs programs)
    : gl_(&gl),
      programs_(std::move(programs)),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)) {
  std::vector<SolidVertex> vertices;
  const auto add = [&](const std::vector<SolidVertex>& more) {
    const Shape shape{static_cast<GLint>(vertices.size()), static_cast<GLsizei>(more.size())};
    vertices.insert(vertices.end(), more.begin(), more.end());
    return shape;
  };
  for (const int segments : sphere_segments) spheres_.push_back(add(lathe_sphere(segments)));
  shaft_ = add(lathe_cylinder(arrow_segments));
  head_ = add(lathe_cone(arrow_segments));
  pane_ = add(unit_pane());
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(SolidVertex)),
                vertices.data(), GL_STATIC_DRAW);
  constexpr GLsizei stride = sizeof(SolidVertex);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
  gl.VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride,
                         reinterpret_cast<const void*>(offsetof(SolidVertex, normal)));
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
}

void SolidPass::draw_solid(const FrameView& view, const Shape& shape, const Eigen::Matrix4f& model,
                           Colour colour) const {
  set_pipeline_state(*gl_, {Depth::test_and_write, Blend::off, Cull::back});
  draw_shape(programs_.solid, view, shape, model, to_linear(colour));
}

void SolidPass::draw_shape(const Program& program, const FrameView& view, const Shape& shape,
                           const Eigen::Matrix4f& model, const Eigen::Vector4f& colour) const {
  use_program(program, view, model, colour);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawArrays(GL_TRIANGLES, shape.first, shape.count);
}

void SolidPass::use_program(const Program& program, const FrameView& view, const Eigen::Matrix4f& model,
                            const Eigen::Vector4f& colour) const {
  program.use();
  set_frame_uniforms(program, view);
  set_studio_uniforms(program, view);
  Eigen::Matrix4f normal_to_world = Eigen::Matrix4f::Identity();
  normal_to_world.topLeftCorner<3, 3>() = model.topLeftCorner<3, 3>().inverse().transpose();
  program.set("model", model);
  program.set("normal_to_world", normal_to_world);
  program.set("colour", colour);
}

// Returns the coarsest sphere whose sagitta is small enough on the screen, or the finest sphere if no sphere
// is fine enough. Each of n equal chords of a circle of radius r deviates from its arc by at most
// r (pi / n)^2 / 2.
const SolidPass::Shape& SolidPass::sphere_for(const FrameView& view, const Eigen::Vector3f& centre_m,
                                              float radius_m) const {
  const float depth = std::max((centre_m - view.eye_m).norm() - radius_m, view.nearest_depth_m);
  const float radius_px = radius_m * view.pixel_depth_ratio / depth;
  const float needed = std::numbers::pi_v<float> * std::sqrt(radius_px / (2.0f * sphere_sagitta_px));
  std::size_t choice = 0;
  while (choice + 1 < spheres_.size() && static_cast<float>(sphere_segments[choice]) < needed) ++choice;
  return spheres_[choice];
}

void SolidPass::draw_glass_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                                  Colour colour) const {
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::back});
  draw_shape(programs_.glass, view, sphere_for(view, centre_m, radius_m),
             make_model(centre_m, radius_m * Eigen::Matrix3f::Identity()), to_linear(colour));
}

void SolidPass::draw_glass_tool(const FrameView& view, ToolBuffers& tool, const ToolFrame& frame,
                                Colour colour) const {
  const bool mirrored = frame.axes.determinant() < 0.0;
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, mirrored ? Cull::front : Cull::back});
  use_program(programs_.glass, view, make_model(frame.origin_m.cast<float>(), frame.axes.cast<float>()),
              to_linear(colour));
  tool.draw((frame.axes.transpose() * (view.eye_m.cast<double>() - frame.origin_m)).cast<float>());
}

void SolidPass::draw_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                            Colour colour) const {
  draw_solid(view, sphere_for(view, centre_m, radius_m),
             make_model(centre_m, radius_m * Eigen::Matrix3f::Identity()), colour);
}

void SolidPass::draw_arrow(const FrameView& view, const Eigen::Vector3f& start_m,
                           const Eigen::Vector3f& tip_m, float width_m, Colour colour) const {
  const float length = (tip_m - start_m).norm();
  if (length <= 0.0f) return;
  const Eigen::Vector3f along = (tip_m - start_m) / length;
  const Eigen::Matrix3f turn =
      Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitY(), along).toRotationMatrix();
  const float head_length = std::min(3.4f * width_m, 0.75f * length);
  const float head_radius = 0.42f * head_length;
  const float shaft_length = length - head_length;
  const Eigen::Vector3f shaft_size(0.5f * width_m, shaft_length, 0.5f * width_m);
  const Eigen::Vector3f head_size(head_radius, head_length, head_radius);
  draw_solid(view, shaft_, make_model(start_m, turn * shaft_size.asDiagonal()), colour);
  draw_solid(view, head_, make_model(start_m + shaft_length * along, turn * head_size.asDiagonal()), colour);
}

void SolidPass::draw_pane(const FrameView& view, const std::array<Eigen::Vector3f, 4>& corners_m,
                          Colour colour) const {
  Eigen::Matrix3f axes;
  axes.col(0) = corners_m[1] - corners_m[0];
  axes.col(1) = corners_m[3] - corners_m[0];
  axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  draw_shape(programs_.pane, view, pane_, make_model(corners_m[0], axes), to_srgb(colour));
}

}  // namespace spoonbill
