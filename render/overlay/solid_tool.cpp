#include "render/overlay/solid_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

Box about_origin(const Vector3& half) {
  return {-half, half};
}

struct BoxOfShape {
  Box operator()(const SphereShape& shape) const { return about_origin(Vector3::Constant(shape.radius_m)); }
  Box operator()(const EllipsoidShape& shape) const { return about_origin(shape.semi_axes_m); }
  Box operator()(const CylinderShape& shape) const {
    return about_origin({shape.radius_m, shape.half_length_m, shape.radius_m});
  }
  Box operator()(const CapsuleShape& shape) const {
    return about_origin({shape.radius_m, shape.half_length_m + shape.radius_m, shape.radius_m});
  }
  Box operator()(const BoxShape& shape) const { return about_origin(shape.half_extents_m); }
  Box operator()(const ConeShape& shape) const {
    return {{-shape.base_radius_m, 0.0, -shape.base_radius_m},
            {shape.base_radius_m, shape.height_m, shape.base_radius_m}};
  }
  Box operator()(const TorusShape& shape) const {
    const double out = shape.ring_radius_m + shape.tube_radius_m;
    return about_origin({out, shape.tube_radius_m, out});
  }
  Box operator()(const HalfSpaceShape& /*shape*/) const {
    return about_origin({half_space_radius_m, 0.0, half_space_radius_m});
  }
  Box operator()(const SuperquadricShape& shape) const { return about_origin(shape.semi_axes_m); }
};

struct BoxOfSolid {
  Box operator()(const ImplicitShape& shape) const { return std::visit(BoxOfShape{}, shape); }
  Box operator()(const MeshSolid& solid) const { return box_about(solid.mesh.mesh.vertices_m); }
  Box operator()(const SurfaceSolid& solid) const { return spoonbill::bounding_box(solid.surface.net); }
};

}  // namespace

const ToolBody* rigid_body(const ToolSnapshot& tool) {
  return tool.kind == ToolKind::solid && tool.body && !tool.body->soft ? tool.body.get() : nullptr;
}

bool is_soft(const ToolSnapshot& tool) {
  return tool.kind == ToolKind::solid && tool.body && tool.body->soft;
}

Box bounding_box(const ToolSolid& solid) {
  return std::visit(BoxOfSolid{}, solid);
}

ToolFrame tool_frame(const Snapshot& snapshot) {
  return {snapshot.tool.proxy.orientation.toRotationMatrix(), snapshot.tool.proxy.position_m};
}

// With S the reflection and R the tool's rotation, the image is S R. The mirrored pose is a rotation and can
// only be S R S, so S follows it.
ToolFrame mirrored_tool_frame(const Snapshot& snapshot) {
  const Vector3& normal = snapshot.symmetry.normal;
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
  return {snapshot.mirrored_proxy.orientation.toRotationMatrix() * reflection,
          snapshot.mirrored_proxy.position_m};
}

Vector3 way_out(const Box& box, const ToolFrame& frame, const Vector3& direction) {
  const Vector3 local = frame.axes.transpose() * direction;
  const Vector3 middle = box.centre(), half = 0.5 * box.extent();
  double length = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (local[axis] != 0.0) length = std::min(length, half[axis] / std::abs(local[axis]));
  }
  return frame.origin_m + frame.axes * (middle + length * local);
}

}  // namespace spoonbill
