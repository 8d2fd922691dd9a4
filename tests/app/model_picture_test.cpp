// Tests the views of pictures of models.
#include "app/frames/model_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

const std::string bundled_handle = std::string(SPOONBILL_ASSETS) + "/models/spoon-handle.json";

// Returns the part of the picture's half width or height that the surface reaches at most.
double reach(const ShownModel& model, const ViewSettings& view, const PictureSettings& picture) {
  const Viewport viewport = make_viewport(picture.width_px, picture.height_px, {});
  double most = 0.0;
  const SurfaceSnapshot& surface = model.snapshot.bodies[0].surface;
  TessellatedSurface drawn;
  EXPECT_TRUE(drawn.update(surface, uniform_sampling_level(surface, 8)));
  const GridSamples<float>& at = drawn.samples();
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    const auto pixel = project(view.camera, viewport, {at.x[i], at.y[i], at.z[i]});
    if (!pixel) return 10.0;
    most = std::max({most, std::abs(pixel->x() / (0.5 * picture.width_px) - 1.0),
                     std::abs(pixel->y() / (0.5 * picture.height_px) - 1.0)});
  }
  return most;
}

TEST(ModelPicture, FillsMostOfThePictureFromEverySide) {
  const ShownModel model = read_shown_model(bundled_handle, {}, {}).value();
  for (const char* side : {"perspective", "front", "right", "top", "120,-40"}) {
    PictureSettings picture;
    picture.direction = parse_view_direction(side).value();
    EXPECT_NEAR(reach(model, make_picture_view(model, picture), picture), 0.8, 0.01) << side;
  }
}

// The handle is much longer than wide. While it turns, it stays in the picture and keeps its size.
TEST(ModelPicture, TurnsAtTheSameDistance) {
  const ShownModel model = read_shown_model(bundled_handle, {}, {}).value();
  const PictureSettings picture;
  const std::vector<ViewSettings> views = make_turntable(model, picture, 12);
  ASSERT_EQ(views.size(), 12u);
  double most = 0.0;
  for (const ViewSettings& view : views) {
    EXPECT_EQ(view.camera.distance_m, views[0].camera.distance_m);
    EXPECT_EQ(view.camera.target_m, views[0].camera.target_m);
    most = std::max(most, reach(model, view, picture));
  }
  EXPECT_NEAR(most, 0.8, 0.1);
  EXPECT_GT(views[3].camera.yaw_rad, views[2].camera.yaw_rad);
}

TEST(ModelPicture, StudiosAreParsed) {
  EXPECT_EQ(parse_studio("dark")->studio.name, "dark");
  EXPECT_NEAR(parse_studio("contrast,-30")->turn_rad, -M_PI / 6.0, 1e-12);
  for (const char* wrong : {"", "darkness", "dark,", "dark,x", "dark,361", ",30", "dark,nan"})
    EXPECT_FALSE(parse_studio(wrong)) << wrong;
}

TEST(ModelPicture, StandsOnALevelGroundOnly) {
  ShownModel model = read_shown_model(bundled_handle, {}, {}).value();
  const double lowest_m = make_picture_view(model, {}).ground_y_m;
  model.ground = Ground{{0.0, -0.05, 0.0}, Vector3::UnitY(), 0.3};
  EXPECT_EQ(make_picture_view(model, {}).ground_y_m, -0.05);
  model.ground->normal = Vector3(0.1, 1.0, 0.0).normalized();
  EXPECT_EQ(make_picture_view(model, {}).ground_y_m, lowest_m);
}

// The tool of the document rests on the highest point and stays in the picture.
TEST(ModelPicture, ShowsTheToolOnTop) {
  ShownModel model = read_shown_model(bundled_handle, {}, {}).value();
  const double highest_m = drawn_bounds(model.snapshot).high.y();
  rest_tool_on_top(model);
  const ToolSnapshot& tool = model.snapshot.tool;
  ASSERT_GT(tool.radius_m, 0.0);
  EXPECT_NEAR(tool.proxy.position_m.y() - tool.radius_m, highest_m, 0.1e-3);
  PictureSettings picture;
  picture.overlays.tool = true;
  const ViewSettings view = make_picture_view(model, picture);
  const Viewport viewport = make_viewport(picture.width_px, picture.height_px, {});
  const auto top = project(view.camera, viewport, tool.proxy.position_m + tool.radius_m * Vector3::UnitY());
  ASSERT_TRUE(top);
  EXPECT_GT(top->y(), 0.0);
  EXPECT_LT(make_picture_view(model, {}).camera.distance_m, view.camera.distance_m);
}

// A turning model keeps the tool in all pictures.
TEST(ModelPicture, TurnsWithTheTool) {
  ShownModel model = read_shown_model(bundled_handle, {}, {}).value();
  model.snapshot.tool.radius_m = 0.03;
  rest_tool_on_top(model);
  PictureSettings picture;
  picture.overlays.tool = true;
  const ToolSnapshot& tool = model.snapshot.tool;
  const Viewport viewport = make_viewport(picture.width_px, picture.height_px, {});
  for (const ViewSettings& view : make_turntable(model, picture, 6)) {
    const auto top = project(view.camera, viewport, tool.proxy.position_m + tool.radius_m * Vector3::UnitY());
    ASSERT_TRUE(top);
    EXPECT_GT(top->y(), 0.0);
  }
}

}  // namespace
}  // namespace spoonbill
