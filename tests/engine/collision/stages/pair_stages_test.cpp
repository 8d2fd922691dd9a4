// Tests the contact stages of two round tubes that cross at a right angle. The curve in which they intersect
// has a closed form.
#include "engine/collision/stages/pair_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/engine/collision/surfaces/sheets.h"

namespace spoonbill {
namespace {

constexpr double thick_m = 0.02, thin_m = 0.008, margin_m = 1e-4;

// Returns a tube along z. It begins well within the thick tube, which runs along x, and ends above it.
Surface upright_tube() {
  Surface tube = round_tube(thin_m, 0.05);
  Surface turned = tube;
  place(tube.net, Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitY()).toRotationMatrix(),
        Vector3(0.0, 0.0, 0.06), turned.net);
  return turned;
}

// Returns a point of both tubes: x^2 + y^2 = thin^2 and y^2 + z^2 = thick^2.
Vector3 on_both(double angle) {
  const double y = thin_m * std::sin(angle);
  return {thin_m * std::cos(angle), y, std::sqrt(thick_m * thick_m - y * y)};
}

ContactStages stages_of(const Surface& first, const Surface& second) {
  PairStages finder = PairStages::make(first, second).value();
  ContactStages stages;
  finder.add(first, second, margin_m, true, true, stages);
  return stages;
}

double distance_to(const Triangle& triangle, const Vector3& point) {
  double nearest = 1e30;
  const auto& [a, b, c] = triangle;
  for (int k = 0; k <= 12; ++k) {
    for (int l = 0; l + k <= 12; ++l) {
      nearest = std::min(nearest, (a + (b - a) * (k / 12.0) + (c - a) * (l / 12.0) - point).norm());
    }
  }
  return nearest;
}

class CrossingTubes : public ::testing::Test {
 protected:
  const Surface thick_ = round_tube(thick_m, 0.06), thin_ = upright_tube();
  const ContactStages stages_ = stages_of(thick_, thin_);
};

TEST_F(CrossingTubes, KeepTheirCommonCurveOnEachLevel) {
  EXPECT_EQ(stages_.surfaces, 2);
  EXPECT_FALSE(stages_.overflow);
  EXPECT_LT(stages_.elements_within, stages_.elements);
  for (int k = 0; k < 360; ++k) {
    const Vector3 point = on_both(k * std::numbers::pi / 180.0);
    for (int surface = 0; surface < 2; ++surface) {
      for (int level = 0; level <= finest_stage_level; ++level) {
        EXPECT_TRUE(std::any_of(stages_.spheres.begin(), stages_.spheres.end(),
                                [&](const StageSphere& s) {
                                  // The tubes are round to 1e-9 of their radius.
                                  return s.kept && s.surface == surface && s.cell.level == level &&
                                         (point - s.cover.centre).norm() <= s.cover.radius + 1e-9;
                                }))
            << "at " << k << " degrees, surface " << surface << ", level " << level;
      }
      // The tolerance allows for the sagitta of a chord and for the steps between the samples of a triangle.
      // Both together are less than half a cell of the last level, which is about 1 mm long.
      EXPECT_TRUE(std::any_of(stages_.triangles.begin(), stages_.triangles.end(),
                              [&](const StageTriangle& t) {
                                return t.surface == surface && distance_to(t.corners, point) < 5e-4;
                              }))
          << "at " << k << " degrees, surface " << surface;
    }
  }
}

TEST_F(CrossingTubes, RefineEachKeptCellInFour) {
  int kept[2][finest_stage_level + 1] = {}, visited[2][finest_stage_level + 1] = {};
  for (const StageSphere& sphere : stages_.spheres) {
    ++visited[sphere.surface][sphere.cell.level];
    kept[sphere.surface][sphere.cell.level] += sphere.kept ? 1 : 0;
  }
  for (int surface = 0; surface < 2; ++surface) {
    for (int level = 0; level < finest_stage_level; ++level) {
      EXPECT_EQ(visited[surface][level + 1], 4 * kept[surface][level]);
    }
    EXPECT_GT(kept[surface][finest_stage_level], 0);
    EXPECT_LT(kept[surface][finest_stage_level], visited[surface][finest_stage_level]);
  }
}

// Cells far from the curve are dropped. Each triangle that is left has a corner whose distance from the curve
// is less than three times the triangle's longest side plus the margin.
TEST_F(CrossingTubes, DropWhatIsFarFromTheCurve) {
  for (const StageTriangle& triangle : stages_.triangles) {
    double nearest = 1e30, longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (triangle.corners[k] - triangle.corners[(k + 1) % 3]).norm());
      for (int degree = 0; degree < 360; ++degree) {
        nearest =
            std::min(nearest, (triangle.corners[k] - on_both(degree * std::numbers::pi / 180.0)).norm());
      }
    }
    EXPECT_LT(nearest, 3.0 * longest + margin_m);
  }
}

TEST_F(CrossingTubes, HaveContactsOnBoth) {
  ASSERT_GE(stages_.contacts.size(), 2u);
  for (const StageContact& contact : stages_.contacts) {
    const Vector3& p = contact.at.point_m;
    const double off_thick = std::abs(std::hypot(p.y(), p.z()) - thick_m);
    const double off_thin = std::abs(std::hypot(p.x(), p.y()) - thin_m);
    // The thin tube ends in a cap within the thick tube.
    const double off_cap = std::abs(p.z() - 0.01);
    EXPECT_LT(std::min({off_thick, off_thin, off_cap}), 1e-6);
  }
}

// An open surface has the same outside as a closed one: points in front of it have a gap, not a depth.
TEST(PairStages, OfAnOpenSurfaceHaveGapsInFrontOfIt) {
  const Surface thick = round_tube(thick_m, 0.06);
  Surface beside = thick;
  for (double& y : beside.net.y) y += 2.0 * thick_m + 0.5 * margin_m;
  PairStages finder = PairStages::make(thick, beside).value();
  ContactStages stages;
  finder.add(thick, beside, margin_m, true, false, stages);
  ASSERT_FALSE(stages.contacts.empty());
  for (const StageContact& contact : stages.contacts) EXPECT_LT(contact.at.depth_m, 0.0);
}

TEST(PairStages, OfSurfacesApartEndAtTheFirst) {
  const Surface thick = round_tube(thick_m, 0.06);
  Surface far = thick;
  for (double& y : far.net.y) y += 1.0;
  const ContactStages stages = stages_of(thick, far);
  EXPECT_EQ(stages.elements_within, 0);
  EXPECT_TRUE(stages.spheres.empty());
  EXPECT_TRUE(stages.triangles.empty());
  EXPECT_TRUE(stages.contacts.empty());
}

}  // namespace
}  // namespace spoonbill
