#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "engine/fitting/fit_quality.h"
#include "engine/fitting/normals.h"
#include "tests/engine/fitting/clouds.h"

namespace spoonbill {
namespace {

constexpr int controls = 10;

// Returns a sheet over the unit square with evenly spaced control points.
Surface sheet() {
  ControlNet net(controls, controls);
  for (int i = 0; i < controls; ++i) {
    for (int j = 0; j < controls; ++j) net.set_point(i, j, Vector3(i, j, 0.0) / (controls - 1));
  }
  const KnotVector knots = KnotVector::clamped_uniform(3, controls).value();
  return make_surface(knots, knots, std::move(net)).value();
}

// Returns the sheet with two rows of control points swapped, so that x decreases between them.
Surface turned_back() {
  Surface surface = sheet();
  for (int j = 0; j < controls; ++j) {
    const Vector3 point = surface.net.point(4, j);
    surface.net.set_point(4, j, surface.net.point(5, j));
    surface.net.set_point(5, j, point);
  }
  return surface;
}

struct Data {
  std::vector<Vector2> uv;
  std::vector<Vector3> normals;

  NormalsAtParameters view() const { return {uv, normals}; }
};

Data facing(double z) {
  Data data;
  for (int k = 0; k < 1600; ++k) {
    data.uv.emplace_back((k / 40 + 0.5) / 40, (k % 40 + 0.5) / 40);
    data.normals.emplace_back(0.0, 0.0, z);
  }
  return data;
}

TEST(Folds, AFlatSheetHasNone) {
  const FoldCheck check = check_folds(sheet(), facing(1.0).view());
  EXPECT_EQ(check.samples, 28U * 28U);  // 4 x 4 samples in each of 7 x 7 spans
  EXPECT_EQ(check.folds, 0U);
  EXPECT_EQ(check.cusps, 0U);
}

TEST(Folds, AgainstTheDataAllOfItFolds) {
  const FoldCheck check = check_folds(sheet(), facing(-1.0).view());
  EXPECT_EQ(check.folds, check.samples);
  EXPECT_EQ(check.cusps, 0U);  // the surface itself stays smooth
}

TEST(Folds, WhereItGoesBackItFoldsAndHasCusps) {
  for (const Data& data : {facing(1.0), Data{}}) {
    const FoldCheck check = check_folds(turned_back(), data.view());
    EXPECT_GT(check.folds, 0U);
    EXPECT_LT(check.folds, check.samples / 2);
    EXPECT_GE(check.cusps, 2U * 7U * 12U);  // two cusps on every line across the swapped rows
    EXPECT_TRUE(check.span_folds[3 * 7 + 3]);
    EXPECT_FALSE(check.span_cusps[0]);
  }
}

// Returns a sheet that runs along x, back below itself and forward again. Its normal never turns far between
// two samples.
Surface doubled_back() {
  constexpr int rows = 28;
  ControlNet net(rows, controls);
  for (int i = 0; i < rows; ++i) {
    const double s = i / (rows - 1.0), back = std::clamp((s - 0.4) / 0.2, 0.0, 1.0);
    const double x = s < 0.4 ? 1.375 * s : s < 0.6 ? 0.55 - 0.5 * (s - 0.4) : 0.45 + 1.375 * (s - 0.6);
    const double z = 0.1 * (0.5 - back);
    for (int j = 0; j < controls; ++j) net.set_point(i, j, {x, j / (controls - 1.0), z});
  }
  const KnotVector u = KnotVector::clamped_uniform(3, rows).value();
  const KnotVector v = KnotVector::clamped_uniform(3, controls).value();
  return make_surface(u, v, std::move(net)).value();
}

FoldCheck check_without_normals(const FitPoints& points, const Surface& surface) {
  const ClosestParameters closest(surface);
  std::vector<Vector2> uv;
  for (const Vector3& point : points.scan.points_m) uv.push_back(closest.project(point, 4).uv);
  return check_folds(surface, {uv, estimate_normals(points, surface, uv), true});
}

TEST(Folds, AreFoundWithoutNormalsWhereTheSurfaceDoublesBackSlowly) {
  const auto flat = random_cloud(20000, 4, [](double s, double t) { return Vector3(s, t, 0.0); });
  const FitPoints points = make_fit_points(flat).value();
  EXPECT_EQ(check_folds(doubled_back(), {}).folds, 0U);  // this fold cannot be seen from the surface alone
  EXPECT_GT(check_without_normals(points, doubled_back()).folds, 28U);
  EXPECT_EQ(check_without_normals(points, sheet()).folds, 0U);
}

TEST(Folds, FewerFoldsAreBetterAndThenFewerCusps) {
  FoldCheck none, cusp, fold;
  cusp.cusps = 1;
  fold.folds = 1;
  EXPECT_TRUE(none.is_better_than(cusp));
  EXPECT_TRUE(cusp.is_better_than(fold));
  EXPECT_FALSE(fold.is_better_than(none));
  EXPECT_FALSE(none.is_better_than(none));
}

}  // namespace
}  // namespace spoonbill
