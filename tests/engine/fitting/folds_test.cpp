#include "engine/fitting/folds.h"

#include <gtest/gtest.h>

#include <utility>

namespace spoonbill {
namespace {

constexpr int controls = 10;

// Over the unit square, the control points evenly.
Surface sheet() {
  ControlNet net(controls, controls);
  for (int i = 0; i < controls; ++i) {
    for (int j = 0; j < controls; ++j) net.set_point(i, j, Vector3(i, j, 0.0) / (controls - 1));
  }
  const KnotVector knots = KnotVector::clamped_uniform(3, controls).value();
  return make_surface(knots, knots, std::move(net)).value();
}

// Two rows of control points have changed places: x goes back between them.
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
  EXPECT_EQ(check.samples, 28U * 28U);  // four by four in each of 7 x 7 spans
  EXPECT_EQ(check.folds, 0U);
  EXPECT_EQ(check.cusps, 0U);
}

TEST(Folds, AgainstTheDataAllOfItFolds) {
  const FoldCheck check = check_folds(sheet(), facing(-1.0).view());
  EXPECT_EQ(check.folds, check.samples);
  EXPECT_EQ(check.cusps, 0U);  // in itself it is as smooth as before
}

TEST(Folds, WhereItGoesBackItFoldsAndHasCusps) {
  for (const Data& data : {facing(1.0), Data{}}) {
    const FoldCheck check = check_folds(turned_back(), data.view());
    EXPECT_GT(check.folds, 0U);
    EXPECT_LT(check.folds, check.samples / 2);
    EXPECT_GE(check.cusps, 2U * 7U * 12U);  // twice on every line across
    EXPECT_TRUE(check.span_folds[3 * 7 + 3]);
    EXPECT_FALSE(check.span_cusps[0]);
  }
}

TEST(Folds, FewerFoldsAreBetterAndThenFewerCusps) {
  FoldCheck none, cusp, fold;
  cusp.cusps = 1;
  fold.folds = 1;
  EXPECT_TRUE(none.better_than(cusp));
  EXPECT_TRUE(cusp.better_than(fold));
  EXPECT_FALSE(fold.better_than(none));
  EXPECT_FALSE(none.better_than(none));
}

}  // namespace
}  // namespace spoonbill
