#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/scene/scene.h"
#include "render/gl/context.h"
#include "render/overlay/overlays.h"
#include "render/passes/scene_passes.h"
#include "render/renderer.h"
#include "render/tessellation/tool_mesh.h"
#include "tests/render/sample_scene.h"

namespace spoonbill {
namespace {

const Vector3 half_m(0.004, 0.003, 0.010);

Snapshot scene_with(ToolSolid solid, const Pose& pose = {}) {
  Snapshot snapshot = sample_scene();
  snapshot.tool.kind = ToolKind::solid;
  snapshot.tool.body = std::make_shared<ToolBody>(ToolBody{std::move(solid), std::nullopt});
  snapshot.tool.proxy = pose;
  return snapshot;
}

Snapshot without_bodies(Snapshot snapshot) {
  snapshot.bodies.clear();
  snapshot.planes.clear();
  return snapshot;
}

Pose turned(const Vector3& position_m, double angle_rad, const Vector3& axis) {
  return {position_m, Quaternion(Eigen::AngleAxisd(angle_rad, axis.normalized()))};
}

// Poses in which the tool is beside the body and does not touch it.
const Pose upright = turned({0.030, 0.025, 0.0}, 0.0, Vector3::UnitX());
const Pose oblique = turned({0.075, 0.028, 0.0}, 1.1, {0.3, 1.0, 0.5});

ViewSettings plain_view() {
  ViewSettings settings;
  settings.camera = look_from({}, StandardView::perspective);
  settings.camera.target_m = {0.05, 0.01, 0.0};
  settings.camera.distance_m = 0.35;
  settings.ground_y_m = -0.05F;
  settings.shadow = false;
  settings.overlays.force = settings.overlays.touched_nodes = false;
  return settings;
}

// The pixels whose colour differs from a picture without the tool, and the box around those pixels.
struct Changed {
  int count = 0, bluer = 0;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = Eigen::Vector2d::Constant(-1e9);
};

Changed difference(const Image& without, const Image& with) {
  Changed changed;
  for (int y = 0; y < sample_height_px; ++y) {
    for (int x = 0; x < sample_width_px; ++x) {
      const std::uint8_t *a = without.pixel(x, y), *b = with.pixel(x, y);
      const int most = std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
      if (most <= 2) continue;
      ++changed.count;
      changed.bluer += b[2] - b[0] > a[2] - a[0] ? 1 : 0;
      changed.low = changed.low.cwiseMin(Eigen::Vector2d(x, y));
      changed.high = changed.high.cwiseMax(Eigen::Vector2d(x + 1, y + 1));
    }
  }
  return changed;
}

class SolidToolPicture : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = OsmesaContext::make(sample_width_px, sample_height_px);
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(context).value();
    auto renderer = Renderer::make(*context_);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::make_unique<Renderer>(std::move(renderer).value());
  }

  Image picture(const Snapshot& snapshot, const ViewSettings& settings) {
    Image image;
    const Status drawn = renderer_->draw(snapshot, settings, nullptr);
    EXPECT_TRUE(drawn.ok()) << drawn.error().message;
    renderer_->read_pixels(image);
    return image;
  }

  Changed tool_pixels(const Snapshot& snapshot) {
    ViewSettings settings = plain_view();
    const Image with = picture(snapshot, settings);
    settings.overlays.tool = false;
    return difference(picture(snapshot, settings), with);
  }

  std::unique_ptr<OsmesaContext> context_;
  std::unique_ptr<Renderer> renderer_;
};

// Returns the bounds, in pixels, of a box in the pose of a tool frame.
Changed projected_tool(const Box& box, const ToolFrame& frame) {
  const ViewSettings settings = plain_view();
  const Viewport viewport = make_viewport(sample_width_px, sample_height_px, settings.panel_px);
  Changed bounds;
  for (int i = 0; i < 8; ++i) {
    const auto pixel = project(settings.camera, viewport, frame.origin_m + frame.axes * box.corner(i));
    bounds.low = bounds.low.cwiseMin(*pixel);
    bounds.high = bounds.high.cwiseMax(*pixel);
  }
  return bounds;
}

// Expects equal bounds within 1.5 pixels, because pixels at the border are only partly covered.
void expect_same_bounds(const Changed& seen, const Changed& expected) {
  EXPECT_LT((seen.low - expected.low).cwiseAbs().maxCoeff(), 1.5);
  EXPECT_LT((seen.high - expected.high).cwiseAbs().maxCoeff(), 1.5);
}

TEST_F(SolidToolPicture, ABoxFillsItsProjectionAndIsBlue) {
  for (const Pose& pose : {upright, oblique}) {
    const Snapshot snapshot = scene_with(ImplicitShape(BoxShape{half_m}), pose);
    const Changed seen = tool_pixels(snapshot);
    expect_same_bounds(seen, projected_tool({-half_m, half_m}, tool_frame(snapshot)));
    EXPECT_GT(seen.count, 300);
    EXPECT_GT(seen.bluer, 0.98 * seen.count);
  }
}

// Returns a wedge with three different sides and no plane of symmetry, so that a rotated copy looks
// different.
MeshSolid wedge() {
  TriangleMesh mesh;
  mesh.vertices_m = {Vector3(0, 0, 0), Vector3(0.012, 0, 0), Vector3(0, 0.006, 0), Vector3(0, 0, 0.020)};
  for (const TriangleCorners& corners : {TriangleCorners{0, 2, 1}, TriangleCorners{0, 1, 3},
                                         TriangleCorners{0, 3, 2}, TriangleCorners{1, 2, 3}}) {
    mesh.triangles.push_back(corners);
  }
  return {clean_mesh(std::move(mesh), "wedge").value()};
}

TEST(SolidTool, TheMirroredFrameIsTheReflectionOfTheTool) {
  Snapshot snapshot = scene_with(wedge(), oblique);
  const Symmetry symmetry{true, {0.01, 0.02, 0.003}, Vector3(1.0, 0.4, -0.7).normalized()};
  snapshot.symmetric = true;
  snapshot.symmetry = {symmetry.point_m, symmetry.normal};
  snapshot.mirrored_proxy = mirror_pose(symmetry, oblique);
  const ToolFrame own = tool_frame(snapshot), mirrored = mirrored_tool_frame(snapshot);
  for (const Vector3& vertex : wedge().mesh.mesh.vertices_m) {
    const Vector3 expected = mirror_point(symmetry, own.origin_m + own.axes * vertex);
    EXPECT_LT((mirrored.origin_m + mirrored.axes * vertex - expected).norm(), 1e-15);
  }
  EXPECT_NEAR(mirrored.axes.determinant(), -1.0, 1e-12);
}

// If S is the reflection, a mesh with vertices S v in the mirrored pose is the mirror image of the mesh with
// vertices v. The frame of the mirrored pose is right-handed.
TEST_F(SolidToolPicture, TheMirrorImageLooksLikeAMirroredMesh) {
  const Symmetry symmetry{true, {0.05, 0.0, 0.0}, Vector3::UnitX()};
  const Pose pose = turned({0.085, 0.030, 0.0}, 0.7, {0.2, 1.0, 0.3});
  TriangleMesh reflected = wedge().mesh.mesh;
  for (Vector3& vertex : reflected.vertices_m) vertex.x() = -vertex.x();
  const MeshSolid image{clean_mesh(std::move(reflected), "image").value()};
  const Snapshot alone = without_bodies(scene_with(image, mirror_pose(symmetry, pose)));
  Snapshot both = without_bodies(scene_with(wedge(), pose));
  const Changed right = tool_pixels(both), left = tool_pixels(alone);
  ASSERT_GT(left.count, 100);
  ASSERT_LT(left.high.x() + 5.0, right.low.x()) << "one must not cover the other";
  both.symmetric = true;
  both.symmetry = {symmetry.point_m, symmetry.normal};
  both.mirrored_proxy = mirror_pose(symmetry, pose);
  ViewSettings settings = plain_view();
  settings.overlays.symmetry_plane = false;
  const Changed rest = difference(picture(alone, settings), picture(both, settings));
  EXPECT_EQ(rest.count, right.count);
  EXPECT_GE(rest.low.x(), right.low.x());
}

// A soft tool, here a box of triangles, is drawn opaque, in the right position, lit as bodies are, and blue.
TEST_F(SolidToolPicture, ASoftMeshIsDrawnWhereItsVerticesAre) {
  auto triangles = std::make_shared<std::vector<TriangleCorners>>();
  for (const auto& [a, b, c, d] :
       {std::array{0U, 2U, 3U, 1U}, std::array{4U, 5U, 7U, 6U}, std::array{0U, 1U, 5U, 4U},
        std::array{2U, 6U, 7U, 3U}, std::array{0U, 4U, 6U, 2U}, std::array{1U, 3U, 7U, 5U}}) {
    triangles->push_back({a, b, c});
    triangles->push_back({a, c, d});
  }
  Snapshot snapshot = scene_with(ImplicitShape(BoxShape{half_m}), oblique);
  const ToolFrame frame = tool_frame(snapshot);
  const Box box{-half_m, half_m};
  snapshot = without_bodies(std::move(snapshot));
  snapshot.tool.body = std::make_shared<ToolBody>(ToolBody{ImplicitShape(BoxShape{half_m}), SoftTool{}});
  BodySnapshot& body = snapshot.bodies.emplace_back();
  body.mesh.triangles = triangles;
  for (int corner = 0; corner < 8; ++corner) {
    // Bit k of a corner's number is set if the corner is on the positive side along axis k.
    const Vector3 local(corner & 1 ? half_m.x() : -half_m.x(), corner & 2 ? half_m.y() : -half_m.y(),
                        corner & 4 ? half_m.z() : -half_m.z());
    const Eigen::Vector3f at = (frame.origin_m + frame.axes * local).cast<float>();
    body.mesh.x.push_back(at.x());
    body.mesh.y.push_back(at.y());
    body.mesh.z.push_back(at.z());
  }
  ViewSettings settings = plain_view();
  settings.overlays.lattice = settings.overlays.control_net = settings.overlays.fixed_nodes = true;
  Snapshot nothing = snapshot;
  nothing.bodies.clear();
  const Changed seen = difference(picture(nothing, settings), picture(snapshot, settings));
  expect_same_bounds(seen, projected_tool(box, frame));
  EXPECT_GT(seen.count, 300);
  EXPECT_GT(seen.bluer, 0.9 * seen.count);  // the colour of tools
  // The picture moves with the tool.
  for (float& y : snapshot.bodies[0].mesh.y) y += 0.01F;
  ToolFrame higher = frame;
  higher.origin_m.y() += 0.01;
  expect_same_bounds(difference(picture(nothing, settings), picture(snapshot, settings)),
                     projected_tool(box, higher));
}

TEST_F(SolidToolPicture, ASoftToolShowsNothingBesideItsBody) {
  Snapshot snapshot = scene_with(ImplicitShape(BoxShape{half_m}), upright);
  snapshot.tool.body = std::make_shared<ToolBody>(ToolBody{ImplicitShape(BoxShape{half_m}), SoftTool{}});
  EXPECT_EQ(tool_pixels(snapshot).count, 0);
}

TEST_F(SolidToolPicture, FollowsAnotherBody) {
  const Changed small = tool_pixels(scene_with(ImplicitShape(BoxShape{half_m}), upright));
  const Changed large = tool_pixels(scene_with(ImplicitShape(BoxShape{2.0 * half_m}), upright));
  EXPECT_GT(large.count, 3 * small.count);
  EXPECT_EQ(tool_pixels(scene_with(ImplicitShape(BoxShape{half_m}), upright)).count, small.count);
}

TEST(SolidTool, SamplesAreTakenAllOverIt) {
  const Snapshot snapshot = scene_with(ImplicitShape(BoxShape{{0.002, 0.002, 0.060}}), oblique);
  const ViewSettings settings = plain_view();
  const auto areas =
      scene_area(snapshot, settings, make_frame_view(settings, sample_width_px, sample_height_px), {});
  const Viewport viewport = make_viewport(sample_width_px, sample_height_px, settings.panel_px);
  const ToolFrame frame = tool_frame(snapshot);
  for (const double z : {-0.060, 0.060}) {
    const auto pixel = project(settings.camera, viewport, frame.origin_m + frame.axes.col(2) * z);
    const double x = pixel->x(), y = sample_height_px - pixel->y();
    EXPECT_TRUE(std::any_of(areas.begin(), areas.end(), [&](const PixelArea& a) {
      return x >= a.x && x <= a.x + a.width && y >= a.y && y <= a.y + a.height;
    })) << z;
  }
}

TEST(SolidTool, TheForceStartsWhereTheBoxEnds) {
  Snapshot snapshot =
      scene_with(ImplicitShape(BoxShape{half_m}), turned({0.01, 0.02, 0.03}, 0.5 * M_PI, Vector3::UnitZ()));
  snapshot.force_n = {0.0, 1.0, 0.0};
  // After a quarter turn about z, the box's half side along x, 4 mm, points up.
  const auto arrow = force_arrow(snapshot, {});
  ASSERT_TRUE(arrow);
  EXPECT_LT((arrow->start_m - Vector3(0.01, 0.024, 0.03)).norm(), 1e-12);
}

}  // namespace
}  // namespace spoonbill
