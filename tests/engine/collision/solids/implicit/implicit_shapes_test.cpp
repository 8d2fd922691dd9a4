#include "engine/collision/solids/implicit_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/engine/allocations.h"
#include "tests/engine/collision/solids/implicit/support_function.h"
#include "tests/engine/collision/solids/signed_distance_check.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

double size_of(const ImplicitShape& shape) {
  return make_signed_distance(shape)->bounds().size();
}

// Checks that the solid is on one side of the tangent plane at the foot (the nearest surface point), and that
// the foot is on the surface. Outside the solid, these two facts prove the distance. Inside, they prove only
// a local minimum.
void expect_proven(const ImplicitShape& shape, const Vector3& point, double tolerance,
                   double inside_tolerance) {
  const auto solid = make_signed_distance(shape);
  const DistanceSample sample = solid->at(point);
  const double size = solid->bounds().size() + point.norm();
  ASSERT_NEAR(sample.gradient.norm(), 1.0, 1e-12);
  EXPECT_NEAR(sample.gradient.dot(point) - support(shape, sample.gradient), sample.distance_m,
              tolerance * size);
  const Vector3 nearest = point - sample.distance_m * sample.gradient;
  EXPECT_LT(std::abs(solid->at(nearest).distance_m),
            (sample.distance_m > 0.0 ? tolerance : inside_tolerance) * size);
}

TEST(ImplicitShapes, DistancesOfConvexOnesAreProvenByTheirSupport) {
  Random random(31);
  for (int trial = 0; trial < random_cases(7000, 200000); ++trial) {
    const ImplicitShape shape = random_convex_shape(random, trial % convex_shape_kinds);
    const Box bounds = make_signed_distance(shape)->bounds();
    const double reach = trial % 3 == 0 ? 1.0 : 3.0;
    Vector3 point = 0.5 * (bounds.low + bounds.high) +
                    0.5 * reach * (bounds.high - bounds.low).cwiseProduct(random_in_cube(random));
    if (trial % 5 == 0) point[random.integer(0, 2)] = 0.0;
    if (trial % 25 == 0) point = point.cwiseProduct(Vector3::Unit(random.integer(0, 2)));
    SCOPED_TRACE(trial);
    // Inside a superquadric, in a plane of symmetry, the search can end slightly early: by at most 1.1e-5 of
    // the size in 200,000 trials.
    expect_proven(shape, point, 1e-12, trial % convex_shape_kinds == 6 ? 2e-5 : 1e-12);
  }
}

TEST(ImplicitShapes, DistancesOfConvexOnesAreTheBestOverAllDirections) {
  Random random(32);
  for (int trial = 0; trial < random_cases(140, 1000); ++trial) {
    const ImplicitShape shape = random_convex_shape(random, trial % convex_shape_kinds);
    const auto solid = make_signed_distance(shape);
    const Box bounds = solid->bounds();
    const Vector3 point =
        0.5 * (bounds.low + bounds.high) + (bounds.high - bounds.low).cwiseProduct(random_in_cube(random));
    // The search over directions can end slightly before the optimum if the optimum is at a ridge.
    const double found = distance_by_support(shape, point), distance = solid->at(point).distance_m;
    EXPECT_LE(found, distance + 1e-12) << trial;
    EXPECT_GE(found, distance - 1e-3 * bounds.size()) << trial;
  }
}

TEST(ImplicitShapes, TheTorusIsAsFarAsItsRingLessTheTube) {
  const auto torus = make_signed_distance(TorusShape{0.03, 0.008});
  Random random(33);
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3 point = 0.05 * random_in_cube(random);
    double ring = 1e300, best = 0.0, width = 2.0 * M_PI;
    for (int round = 0; round < 6; ++round, width *= 0.02) {
      const double middle = best;
      for (int k = -100; k <= 100; ++k) {
        const double angle = middle + width * k / 100;
        const double there = (point - 0.03 * Vector3(std::cos(angle), 0.0, std::sin(angle))).norm();
        if (there < ring) best = angle;
        ring = std::min(ring, there);
      }
    }
    EXPECT_NEAR(torus->at(point).distance_m, ring - 0.008, 1e-12);
  }
  EXPECT_NEAR(torus->at(Vector3::Zero()).distance_m, 0.022, 1e-15);
}

TEST(ImplicitShapes, KeepWhatASignedDistancePromises) {
  Random random(34);
  for (int trial = 0; trial < random_cases(28, 100); ++trial) {
    const int kind = trial % (convex_shape_kinds + 1);
    const ImplicitShape shape = kind == convex_shape_kinds
                                    ? ImplicitShape(TorusShape{0.03, random.uniform(0.001, 0.029)})
                                    : random_convex_shape(random, kind);
    const auto solid = make_signed_distance(shape);
    const Box bounds = solid->bounds();
    const Vector3 more = 0.3 * (bounds.high - bounds.low) + Vector3::Constant(1e-3);
    const Status status = check_signed_distance(*solid, {bounds.low - more, bounds.high + more});
    EXPECT_TRUE(status.ok()) << trial << " kind " << kind << " "
                             << (status.ok() ? "" : status.error().message);
  }
  EXPECT_TRUE(check_signed_distance(*make_signed_distance(HalfSpaceShape{}),
                                    {Vector3::Constant(-1.0), Vector3::Constant(1.0)})
                  .ok());
}

// Tests thin discs, needles and a sphere, at points on their axes, in the centre and beside the rim.
TEST(ImplicitShapes, EllipsoidsOfAnyAxesKeepTheirDigits) {
  const Vector3 kinds[] = {{0.1, 1e-4, 0.1}, {1e-4, 0.1, 1e-4}, {0.1, 0.01, 1e-4}, {0.01, 0.01, 0.01}};
  const double shares[] = {0.0, 1e-12, 1e-6, 0.5, 1.0 - 1e-9, 1.0, 1.5, 30.0};
  for (const Vector3& axes : kinds) {
    for (const double x : shares) {
      for (const double y : shares) {
        for (const double z : shares) {
          expect_proven(EllipsoidShape{axes}, axes.cwiseProduct(Vector3(x, y, z)), 1e-12, 1e-12);
        }
      }
    }
    const DistanceSample middle = make_signed_distance(EllipsoidShape{axes})->at(Vector3::Zero());
    EXPECT_NEAR(middle.distance_m, -axes.minCoeff(), 1e-15);
  }
}

TEST(ImplicitShapes, ASuperquadricOfExponentOneIsAnEllipsoid) {
  const Vector3 axes(0.03, 0.01, 0.02);
  const auto super = make_signed_distance(SuperquadricShape{axes, 1.0, 1.0});
  const auto ellipsoid = make_signed_distance(EllipsoidShape{axes});
  Random random(35);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 point = 2.0 * axes.cwiseProduct(random_in_cube(random));
    EXPECT_NEAR(super->at(point).distance_m, ellipsoid->at(point).distance_m, 1e-12) << trial;
  }
}

TEST(ImplicitShapes, RangesAreChecked) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ImplicitShape bad[] = {SphereShape{-0.1},
                               SphereShape{nan},
                               EllipsoidShape{{0.1, 0.1, 5e-5}},
                               EllipsoidShape{{0.1, nan, 0.1}},
                               CylinderShape{0.0, 0.1},
                               CapsuleShape{0.1, 0.6},
                               BoxShape{{0.1, 0.0, 0.1}},
                               ConeShape{0.1, 0.0},
                               TorusShape{0.01, 0.01},
                               SuperquadricShape{{0.1, 0.1, 0.1}, 2.0, 1.0},
                               SuperquadricShape{{0.1, 0.1, 0.1}, 1.0, 0.1}};
  for (const ImplicitShape& shape : bad) {
    const Status status = check_implicit_shape(shape);
    ASSERT_FALSE(status.ok()) << shape.index();
    EXPECT_NE(status.error().message.find("must be"), std::string::npos) << status.error().message;
  }
  for (int kind = 0; kind < convex_shape_kinds; ++kind) {
    Random random(36);
    EXPECT_TRUE(check_implicit_shape(random_convex_shape(random, kind)).ok()) << kind;
  }
  EXPECT_TRUE(check_implicit_shape(TorusShape{}).ok());
  EXPECT_TRUE(check_implicit_shape(HalfSpaceShape{}).ok());
  EXPECT_GT(size_of(SphereShape{0.1}), 0.2);
}

TEST(ImplicitShapes, AllocateNothing) {
  Random random(37);
  for (int kind = 0; kind < convex_shape_kinds; ++kind) {
    const auto solid = make_signed_distance(random_convex_shape(random, kind));
    const std::size_t before = allocation_count();
    for (int k = 0; k < 100; ++k) (void)solid->at(0.1 * random_in_cube(random));
    EXPECT_EQ(allocation_count(), before) << kind;
  }
}

// The signed distance of a ball, with one of several deliberate faults.
class WrongBall final : public SignedDistance {
 public:
  enum class Fault { none, not_finite, too_steep, not_unit, other_gradient, not_convex, bounds };
  explicit WrongBall(Fault fault) : fault_(fault) {}

  DistanceSample at(const Vector3& p) const override {
    DistanceSample sample{p.norm() - 0.5, p.normalized()};
    if (fault_ == Fault::not_finite && p.x() > 0.9) sample.distance_m = std::sqrt(-p.x());
    if (fault_ == Fault::too_steep) sample.distance_m *= 1.01;
    if (fault_ == Fault::not_unit) sample.gradient *= 0.99;
    if (fault_ == Fault::other_gradient) sample.gradient = Vector3(p.y(), -p.x(), p.z()).normalized();
    if (fault_ == Fault::not_convex) sample = {0.5 - p.norm(), -p.normalized()};
    return sample;
  }
  bool is_convex() const override { return fault_ != Fault::other_gradient && fault_ != Fault::too_steep; }
  Box bounds() const override {
    const double half = fault_ == Fault::bounds ? 0.4 : fault_ == Fault::not_convex ? 9.0 : 0.5;
    return {Vector3::Constant(-half), Vector3::Constant(half)};
  }

 private:
  Fault fault_;
};

TEST(SignedDistanceCheck, RefusesWhatIsNotADistance) {
  const Box where{Vector3::Constant(-1.0), Vector3::Constant(1.0)};
  using Fault = WrongBall::Fault;
  EXPECT_TRUE(check_signed_distance(WrongBall(Fault::none), where).ok());
  const std::pair<Fault, const char*> faults[] = {{Fault::not_finite, "not finite"},
                                                  {Fault::too_steep, "more than the way"},
                                                  {Fault::not_unit, "length"},
                                                  {Fault::other_gradient, "not the slope"},
                                                  {Fault::not_convex, "is_convex() must"},
                                                  {Fault::bounds, "outside bounds()"}};
  for (const auto& [fault, words] : faults) {
    const Status status = check_signed_distance(WrongBall(fault), where);
    ASSERT_FALSE(status.ok()) << words;
    EXPECT_NE(status.error().message.find(words), std::string::npos) << status.error().message;
  }
  EXPECT_FALSE(check_signed_distance(WrongBall(Fault::none), {where.high, where.low}).ok());
}

}  // namespace
}  // namespace spoonbill
