// Directions in which the skin of a rigid body faces around each of its samples or vertices.
#pragma once

#include <cmath>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/simulation/body_mapping.h"

namespace spoonbill {

// Two smooth rigid bodies touch where their normals are opposite. A sample that is merely near a rounded edge
// of another body, whose normal there is tilted, must not hold the edge back as it slides over the sample.
// Deformable bodies yield to such contacts, but rigid ones would catch.
//
// Owned by the contact of two bodies, which makes it. Allocates only in its constructor.
class NormalCones {
 public:
  NormalCones() = default;  // allows all contacts
  // `has_far_face` is true for a shell, whose samples stand for both of its faces.
  NormalCones(const BodyMapping& mapping, bool has_far_face);
  // The cone of a vertex includes the normals of the triangles around it.
  explicit NormalCones(const MeshMapping& mapping);

  // Returns whether another body with the unit normal `other_normal` can touch the sample, or vertex, of a
  // body that has turned by `turn` since rest: whether the opposite of this normal is in the cone about the
  // sample's normal that includes the normals of the samples around it, or almost in it.
  bool allow(int sample, const Quaternion& turn, const Vector3& other_normal) const {
    if (cones_.empty() || sample < 0) return true;
    const Cone& cone = cones_[static_cast<std::size_t>(sample)];
    const double cosine = -(turn * cone.axis).dot(other_normal);
    return (has_far_face_ ? std::abs(cosine) : cosine) >= cone.least_cosine;
  }

 private:
  struct Cone {
    Vector3 axis = Vector3::UnitY();
    double least_cosine = -1.0;
  };
  std::vector<Cone> cones_;  // by sample or vertex
  bool has_far_face_ = false;
};

}  // namespace spoonbill
