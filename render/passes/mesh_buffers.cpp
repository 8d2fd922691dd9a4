#include "render/passes/mesh_buffers.h"

#include <cstddef>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {

SurfaceBuffers::SurfaceBuffers(const GlFunctions& gl)
    : gl_(&gl), vertex_array_(make_vertex_array(gl)), vertices_(make_buffer(gl)), indices_(make_buffer(gl)) {}

void SurfaceBuffers::upload(const TessellatedSurface& surface, const BothSides& visibility,
                            const std::vector<float>& tint) {
  SPOONBILL_ASSERT(visibility.front.size() == surface.vertex_count());
  SPOONBILL_ASSERT(visibility.back.size() == surface.vertex_count());
  SPOONBILL_ASSERT(tint.size() == surface.vertex_count());
  const GridSamples<float>& samples = surface.samples();
  const std::size_t plane_bytes = surface.vertex_count() * sizeof(float);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(9 * plane_bytes), nullptr, GL_STREAM_DRAW);
  GLuint attribute = 0;
  for (const auto* plane : {&samples.x, &samples.y, &samples.z, &samples.nx, &samples.ny, &samples.nz,
                            &visibility.front, &visibility.back, &tint}) {
    const std::size_t start = attribute * plane_bytes;
    gl_->BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(start), static_cast<GLsizeiptr>(plane_bytes),
                       plane->data());
    gl_->VertexAttribPointer(attribute, 1, GL_FLOAT, GL_FALSE, 0, reinterpret_cast<const void*>(start));
    gl_->EnableVertexAttribArray(attribute);
    ++attribute;
  }
  closed_ = surface.is_closed();
  if (topology_version_ == surface.topology_version()) return;
  topology_version_ = surface.topology_version();
  index_count_ = static_cast<GLsizei>(surface.indices().size());
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(surface.indices().size() * sizeof(std::uint32_t)),
                  surface.indices().data(), GL_STATIC_DRAW);
}

void SurfaceBuffers::draw() const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

// Number of frames over which a live view spreads the computation of visibility.
constexpr std::size_t live_occlusion_parts = 4;

Status BodyMeshes::update(const Snapshot& snapshot, double pixels_per_metre, const MeshChoice& choice) {
  surfaces_.resize(snapshot.bodies.size());
  tints_.resize(snapshot.bodies.size());
  rings_.resize(snapshot.bodies.size());
  while (buffers_.size() > surfaces_.size()) buffers_.pop_back();
  while (buffers_.size() < surfaces_.size()) buffers_.emplace_back(*gl_);
  bounds_ = {};
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const BodySnapshot& body = snapshot.bodies[i];
    if (body.is_mesh()) {
      surfaces_[i].update(body.mesh);
    } else {
      if (Status net = check_net(body.surface); !net) return net;
      const SamplingLevel last = choice.keeps_level ? surfaces_[i].level() : SamplingLevel();
      const SamplingLevel level = choose_sampling_level(body.surface, pixels_per_metre, last);
      if (Status updated = surfaces_[i].update(body.surface, level); !updated) return updated;
    }
    const Box one = surfaces_[i].bounds();
    if (one.is_empty()) continue;
    bounds_.join(one);
  }
  if (choice.is_occluded) {
    occlusion_.update(surfaces_, choice.keeps_level ? live_occlusion_parts : 1);
  } else {
    occlusion_ = {};
  }
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const std::size_t count = surfaces_[i].vertex_count();
    if (!choice.is_occluded) open_.assign(count);
    untinted_.assign(count, 0.0f);
    const ToolSnapshot& tool = snapshot.tool;
    rings_[i].clear();
    if (choice.shows_reach && tool.local_radius_m > 0.0 && tool.local_body == static_cast<int>(i)) {
      rings_[i].update(surfaces_[i], tool.local_point_m, tool.local_radius_m);
    }
    if (choice.shows_fixed) tints_[i].update(snapshot.bodies[i].lattice, surfaces_[i], choice.keeps_level);
    buffers_[i].upload(surfaces_[i], choice.is_occluded ? occlusion_.visibility(i) : open_,
                       choice.shows_fixed ? tints_[i].weights() : untinted_);
  }
  return {};
}

ToolBuffers::ToolBuffers(const GlFunctions& gl)
    : gl_(&gl), vertex_array_(make_vertex_array(gl)), vertices_(make_buffer(gl)), indices_(make_buffer(gl)) {}

Status ToolBuffers::update(const ToolSnapshot& tool) {
  if (rigid_body(tool) == nullptr || tool.body == body_) return {};
  Result<ToolMesh> mesh = make_tool_mesh(tool.body->solid);
  if (!mesh) return mesh.error();
  mesh_ = std::move(mesh).value();
  body_ = tool.body;
  upload();
  return {};
}

void ToolBuffers::upload() const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh_.vertices.size() * sizeof(ToolVertex)),
                  mesh_.vertices.data(), GL_STATIC_DRAW);
  constexpr GLsizei stride = sizeof(ToolVertex);
  gl_->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
  gl_->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride,
                           reinterpret_cast<const void*>(offsetof(ToolVertex, normal)));
  gl_->EnableVertexAttribArray(0);
  gl_->EnableVertexAttribArray(1);
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(mesh_.indices.size() * sizeof(std::uint32_t)), mesh_.indices.data(),
                  GL_STATIC_DRAW);
}

void ToolBuffers::draw(const Eigen::Vector3f& eye_m) {
  gl_->BindVertexArray(vertex_array_.id());
  std::size_t count = mesh_.indices.size();
  if (!mesh_.convex) {
    const std::vector<std::uint32_t>& ordered = order_.sort(mesh_, eye_m);
    count = ordered.size();
    gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
    gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(std::uint32_t)),
                    ordered.data(), GL_STREAM_DRAW);
  }
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, nullptr);
}

}  // namespace spoonbill
