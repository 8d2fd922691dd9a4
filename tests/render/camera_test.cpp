#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace spoonbill {
namespace {

const std::vector<StandardView> views = {StandardView::perspective, StandardView::front, StandardView::back,
                                         StandardView::left,        StandardView::right, StandardView::top,
                                         StandardView::bottom};

Box handle_box() {
  Box box;
  box.include({0.0, 0.0, -0.006});
  box.include({0.1, 0.005, 0.006});
  return box;
}

Box2 projected(const Box& box, const Camera& camera, const Viewport& viewport) {
  Box2 pixels;
  for (int i = 0; i < 8; ++i) {
    const auto at = project(camera, viewport, box.corner(i));
    EXPECT_TRUE(at.has_value());
    if (!at) continue;
    pixels.include(*at);
  }
  return pixels;
}

TEST(Camera, LooksAlongMinusZFromTheFront) {
  Camera camera;
  camera.distance_m = 0.5;
  EXPECT_TRUE(eye_position(camera).isApprox(Vector3(0, 0, 0.5)));
  camera = look_from(camera, StandardView::right);
  EXPECT_TRUE(eye_position(camera).isApprox(Vector3(0.5, 0, 0), 1e-12));
  camera = look_from(camera, StandardView::top);
  EXPECT_TRUE(eye_position(camera).isApprox(Vector3(0, 0.5, 0), 1e-12));
}

// The pixel of a point in front of the camera follows from similar triangles.
TEST(Camera, ProjectsByTheClosedForm) {
  Camera camera;
  camera.distance_m = 0.4;
  const Viewport viewport = make_viewport(1280, 720, {0, 0, 300, 720});
  const double focal_px = 360.0 / std::tan(0.5 * camera.vertical_field_of_view_rad);
  const Vector3 point(0.03, -0.02, 0.1);
  const auto pixel = project(camera, viewport, point);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 790.0 + focal_px * 0.03 / 0.3, 1e-9);
  EXPECT_NEAR(pixel->y(), 360.0 + focal_px * 0.02 / 0.3, 1e-9);
  EXPECT_FALSE(project(camera, viewport, Vector3(0, 0, 0.5)));
}

TEST(Camera, MatricesAgreeWithProjection) {
  Camera camera;
  camera.target_m = {0.05, 0.01, 0.0};
  camera.yaw_rad = 0.7;
  camera.pitch_rad = 0.4;
  const Viewport viewport = make_viewport(1280, 720, {0, 0, 300, 720});
  const Vector3 point(0.08, 0.02, 0.03);
  const Eigen::Vector4d clip =
      projection_matrix(camera, viewport) * view_matrix(camera) * point.homogeneous();
  const auto pixel = project(camera, viewport, point);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR((clip.x() / clip.w() + 1.0) * 640.0, pixel->x(), 1e-9);
  EXPECT_NEAR((1.0 - clip.y() / clip.w()) * 360.0, pixel->y(), 1e-9);
}

TEST(Camera, FramesTheBoxInTwoThirdsOfTheFreeRectangle) {
  for (const double panel : {0.0, 300.0, 420.0}) {
    const Viewport viewport = make_viewport(1280, 720, {0, 0, panel, 720});
    EXPECT_NEAR(viewport.free_px.width, 1280.0 - panel, 1e-12);
    for (const StandardView view : views) {
      const Camera camera = frame(look_from({}, view), handle_box(), viewport);
      const Box2 pixels = projected(handle_box(), camera, viewport);
      const Rectangle& free = viewport.free_px;
      EXPECT_GE(pixels.low.x(), free.x);
      EXPECT_LE(pixels.high.x(), free.x + free.width);
      EXPECT_GE(pixels.low.y(), free.y);
      EXPECT_LE(pixels.high.y(), free.y + free.height);
      const double share = std::max((pixels.high.x() - pixels.low.x()) / free.width,
                                    (pixels.high.y() - pixels.low.y()) / free.height);
      EXPECT_NEAR(share, 2.0 / 3.0, 0.01);
      const Eigen::Vector2d middle = pixels.centre();
      EXPECT_NEAR(middle.x(), free.x + 0.5 * free.width, 1.0);
      EXPECT_NEAR(middle.y(), free.y + 0.5 * free.height, 1.0);
    }
  }
}

TEST(Camera, LeavesRoomBesideAPanelOnTheRight) {
  const Viewport viewport = make_viewport(1280, 720, {980, 0, 300, 720});
  EXPECT_EQ(viewport.free_px.x, 0.0);
  EXPECT_EQ(viewport.free_px.width, 980.0);
}

TEST(Camera, AnEmptyBoxMovesNothing) {
  Camera camera;
  camera.distance_m = 0.123;
  const Camera framed = frame(camera, Box{}, make_viewport(640, 480, {}));
  EXPECT_EQ(framed.distance_m, camera.distance_m);
  EXPECT_EQ(framed.target_m, camera.target_m);
}

TEST(Camera, PixelsOfTheGroundGoThereAndBack) {
  Camera camera;
  camera.pitch_rad = 0.5;
  const Viewport viewport = make_viewport(1280, 720, {0, 0, 300, 720});
  const auto ground = point_on_height(camera, viewport, {700.0, 500.0}, -0.01);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->y(), -0.01, 1e-12);
  const auto back = project(camera, viewport, *ground);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->x(), 700.0, 1e-6);
  EXPECT_NEAR(back->y(), 500.0, 1e-6);
  camera.pitch_rad = 0.0;
  EXPECT_FALSE(point_on_height(camera, viewport, {700.0, 100.0}, -0.01)) << "above the horizon";
}

}  // namespace
}  // namespace spoonbill
