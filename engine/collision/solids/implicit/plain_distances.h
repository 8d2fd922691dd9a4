// Signed distances with a closed form: of a sphere, a half-space, a box, and of solids of revolution about y.
// implicit_shapes.h describes each.
#pragma once

#include "engine/collision/solids/implicit/implicit_shapes.h"

namespace spoonbill {

class SphereDistance final : public SignedDistance {
 public:
  explicit SphereDistance(const SphereShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  SphereShape shape_;
};

class HalfSpaceDistance final : public SignedDistance {
 public:
  DistanceSample at(const Vector3& point_m) const override { return {point_m.y(), Vector3::UnitY()}; }
  bool is_convex() const override { return true; }
  Box bounds() const override;
};

class BoxDistance final : public SignedDistance {
 public:
  explicit BoxDistance(const BoxShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override { return {-shape_.half_extents_m, shape_.half_extents_m}; }

 private:
  BoxShape shape_;
};

class CapsuleDistance final : public SignedDistance {
 public:
  explicit CapsuleDistance(const CapsuleShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  CapsuleShape shape_;
};

class CylinderDistance final : public SignedDistance {
 public:
  explicit CylinderDistance(const CylinderShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  CylinderShape shape_;
};

class ConeDistance final : public SignedDistance {
 public:
  explicit ConeDistance(const ConeShape& shape);
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return true; }
  Box bounds() const override;

 private:
  ConeShape shape_;
  double slant_m_;                 // from the rim to the tip
  double normal_out_, normal_up_;  // of the side, away from the axis and along y
};

class TorusDistance final : public SignedDistance {
 public:
  explicit TorusDistance(const TorusShape& shape) : shape_(shape) {}
  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return false; }
  Box bounds() const override;

  // The distance is convex in the distance from the axis and the height; only about the axis, and only nearer
  // to it than the ring, does it bend the other way, by less than one over the distance from the axis.
  double concavity(const Vector3& centre_m, double radius_m) const override;

 private:
  TorusShape shape_;
};

}  // namespace spoonbill
