#include <gtest/gtest.h>

#include <algorithm>

#include "render/passes/scene_passes.h"
#include "tests/render/sample_scene.h"

namespace spoonbill {
namespace {

constexpr int width = 1280, height = 720;

ViewSettings framed_scene(const Snapshot& snapshot) {
  ViewSettings settings;
  settings.camera = frame(look_from({}, StandardView::perspective), drawn_bounds(snapshot),
                          make_viewport(width, height, settings.panel_px));
  return settings;
}

std::vector<TessellatedSurface> tessellated_bodies(const Snapshot& snapshot) {
  std::vector<TessellatedSurface> surfaces(1);
  const SurfaceSnapshot& surface = snapshot.bodies[0].surface;
  EXPECT_TRUE(surfaces[0].update(surface, choose_sampling_level(surface, 6000.0, {})).ok());
  return surfaces;
}

std::vector<PixelArea> areas_of(const Snapshot& snapshot, const ViewSettings& settings) {
  return scene_area(snapshot, settings, make_frame_view(settings, width, height),
                    tessellated_bodies(snapshot));
}

bool holds(const std::vector<PixelArea>& areas, double x, double y) {
  return std::any_of(areas.begin(), areas.end(), [&](const PixelArea& a) {
    return x >= a.x && x <= a.x + a.width && y >= a.y && y <= a.y + a.height;
  });
}

int pixels(const std::vector<PixelArea>& areas) {
  int sum = 0;
  for (const PixelArea& area : areas) sum += area.width * area.height;
  return sum;
}

TEST(SceneArea, HoldsEveryCornerOfTheBodyWithRoomForMarks) {
  const Snapshot snapshot = sample_scene({.bend_rad = 0.8});
  const ViewSettings settings = framed_scene(snapshot);
  const auto areas = areas_of(snapshot, settings);
  const Viewport viewport = make_viewport(width, height, settings.panel_px);
  const auto surfaces = tessellated_bodies(snapshot);
  const GridSamples<float>& at = surfaces[0].samples();
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    const auto pixel = project(settings.camera, viewport, {at.x[i], at.y[i], at.z[i]});
    ASSERT_TRUE(pixel);
    const double x = pixel->x(), y = height - pixel->y();
    for (const double aside : {-12.0, 12.0}) {
      EXPECT_TRUE(holds(areas, x + aside, y)) << x << ' ' << y;
      EXPECT_TRUE(holds(areas, x, y + aside)) << x << ' ' << y;
    }
  }
}

TEST(SceneArea, LeavesOutWhatABentBodyLeavesFree) {
  const Snapshot snapshot = sample_scene({.bend_rad = 0.8});
  const auto areas = areas_of(snapshot, framed_scene(snapshot));
  int left = width, right = 0, bottom = height, top = 0;
  for (const PixelArea& area : areas) {
    EXPECT_FALSE(area.empty());
    left = std::min(left, area.x);
    right = std::max(right, area.x + area.width);
    bottom = std::min(bottom, area.y);
    top = std::max(top, area.y + area.height);
  }
  EXPECT_GE(left, 0);
  EXPECT_LE(right, width);
  EXPECT_GE(bottom, 0);
  EXPECT_LE(top, height);
  EXPECT_LT(pixels(areas), 0.8 * (right - left) * (top - bottom));
}

TEST(SceneArea, HoldsTheStageThatIsShown) {
  const Snapshot snapshot = sample_scene();
  ViewSettings settings = framed_scene(snapshot);
  settings.overlays.tool = settings.overlays.force = false;
  auto stages = std::make_shared<ContactStages>();
  const Vector3 high = snapshot.tool.proxy.position_m + Vector3(0.0, 0.02, 0.0);
  stages->spheres.push_back({{high, 0.004}, {0, 0, 0}, 0, false, true});
  settings.stages = stages;
  const auto holds_centre = [&] {
    const auto centre = project(settings.camera, make_viewport(width, height, settings.panel_px), high);
    return centre && holds(areas_of(snapshot, settings), centre->x(), height - centre->y());
  };
  EXPECT_FALSE(holds_centre());
  settings.overlays.contact_stage = ContactStage::spheres;
  EXPECT_TRUE(holds_centre());
  settings.overlays.sphere_level = 1;
  EXPECT_FALSE(holds_centre());
}

TEST(SceneArea, IsTheWholePictureWhereTheBodyReachesBehindTheEye) {
  const Snapshot snapshot = sample_scene();
  ViewSettings settings = framed_scene(snapshot);
  settings.camera.distance_m = 0.02;
  EXPECT_EQ(pixels(areas_of(snapshot, settings)), width * height);
}

}  // namespace
}  // namespace spoonbill
