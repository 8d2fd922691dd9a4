#include "render/passes/solid_pass.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "render/gl/pipeline_state.h"
#include "render/passes/lathe.h"
#include "render/passes/lighting_glsl.h"
#include "render/surface_look.h"

namespace spoonbill {
namespace {

constexpr const char* vertex_source = R"(
uniform mat4 world_to_clip;
uniform mat4 model;
layout(location = 0) in vec3 local_position;
layout(location = 1) in vec3 local_normal;
out vec3 position;
out vec3 normal;
void main() {
  position = (model * vec4(local_position, 1.0)).xyz;
  normal = transpose(inverse(mat3(model))) * local_normal;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
)";

constexpr const char* fragment_source = R"(
uniform vec4 colour;
uniform int finish;
in vec3 position;
in vec3 normal;
out vec4 result;
void main() {
  if (finish == 2) {
    result = vec4(colour.rgb * colour.a, colour.a);
    return;
  }
  vec3 n = normalize(normal);
  Look look = Look(colour.rgb, finish == 1 ? 0.20 : 0.45, 0.0, 0.0);
  Lit lit = studio_light(look, position, n, 1.0, 1.0);
  float grazing = 1.0 - clamp(dot(n, normalize(eye - position)), 0.0, 1.0);
  float opacity = finish == 1 ? mix(0.44, 0.90, grazing * grazing) : 1.0;
  result = picture_colour(lit, opacity);
}
)";

constexpr int sphere_segments = 56;
constexpr int arrow_segments = 28;

Eigen::Matrix4f placed(const Eigen::Vector3f& origin, const Eigen::Matrix3f& axes) {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  model.topLeftCorner<3, 3>() = axes;
  model.topRightCorner<3, 1>() = origin;
  return model;
}

}  // namespace

Result<SolidPass> SolidPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "solids", vertex_source,
                               std::string(key_light_glsl) + studio_light_glsl + fragment_source);
  if (!program) return program.error();
  return SolidPass(gl, std::move(program).value());
}

SolidPass::SolidPass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)) {
  std::vector<SolidVertex> vertices;
  const auto add = [&](const std::vector<SolidVertex>& more) {
    const Shape shape{static_cast<GLint>(vertices.size()), static_cast<GLsizei>(more.size())};
    vertices.insert(vertices.end(), more.begin(), more.end());
    return shape;
  };
  sphere_ = add(lathe_sphere(sphere_segments));
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

void SolidPass::draw_shape(const FrameView& view, const Shape& shape, const Eigen::Matrix4f& model,
                           Colour colour, Finish finish) const {
  switch (finish) {
    case Finish::solid:
      set_pipeline_state(*gl_, {Depth::test_and_write, Blend::off, Cull::back});
      break;
    case Finish::glass:
      set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::back});
      break;
    case Finish::pane:
      set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
      break;
  }
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("model", model);
  program_.set("finish", static_cast<int>(finish));
  const auto channel = [&](int value) {
    // Panes are unlit and go into the picture as they are.
    return finish == Finish::pane ? static_cast<float>(value) / 255.0f : linear_of_srgb8(value);
  };
  program_.set("colour", Eigen::Vector4f(channel(colour.r), channel(colour.g), channel(colour.b),
                                         static_cast<float>(colour.a) / 255.0f));
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawArrays(GL_TRIANGLES, shape.first, shape.count);
}

void SolidPass::draw_glass_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                                  Colour colour) const {
  draw_shape(view, sphere_, placed(centre_m, radius_m * Eigen::Matrix3f::Identity()), colour, Finish::glass);
}

void SolidPass::draw_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                            Colour colour) const {
  draw_shape(view, sphere_, placed(centre_m, radius_m * Eigen::Matrix3f::Identity()), colour, Finish::solid);
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
  draw_shape(view, shaft_, placed(start_m, turn * shaft_size.asDiagonal()), colour, Finish::solid);
  draw_shape(view, head_, placed(start_m + shaft_length * along, turn * head_size.asDiagonal()), colour,
             Finish::solid);
}

void SolidPass::draw_pane(const FrameView& view, const std::array<Eigen::Vector3f, 4>& corners_m,
                          Colour colour) const {
  Eigen::Matrix3f axes;
  axes.col(0) = corners_m[1] - corners_m[0];
  axes.col(1) = corners_m[3] - corners_m[0];
  axes.col(2) = axes.col(0).cross(axes.col(1)).normalized();
  draw_shape(view, pane_, placed(corners_m[0], axes), colour, Finish::pane);
}

}  // namespace spoonbill
