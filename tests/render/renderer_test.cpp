#include "render/renderer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "render/gl/context.h"
#include "render/image.h"
#include "render/overlay/overlays.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/render/compare.h"
#include "tests/render/sample_scene.h"

namespace spoonbill {
namespace {

// Largest difference allowed in any block between two renderings of the same view; see
// worst_block_difference().
constexpr double tolerance = 2.0;

constexpr const char* font_path = "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf";

class Rendering : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = OsmesaContext::make(sample_width_px, sample_height_px);
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(context).value();
    auto renderer = Renderer::make(*context_);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::make_unique<Renderer>(std::move(renderer).value());
    snapshot_ = sample_scene({.bend_rad = 0.4});
    const Box box = drawn_bounds(snapshot_);
    settings_.ground_y_m = ground_below(box);
    settings_.camera = frame(look_from({}, StandardView::perspective), box,
                             make_viewport(sample_width_px, sample_height_px, {}));
  }

  Image picture() { return picture(snapshot_, settings_); }

  Image picture(const Snapshot& snapshot, const ViewSettings& settings,
                const ImDrawData* interface = nullptr) {
    Image image;
    const Status drawn = renderer_->draw(snapshot, settings, interface);
    EXPECT_TRUE(drawn.ok()) << drawn.error().message;
    renderer_->read_pixels(image);
    return image;
  }

  double change(const std::function<void(ViewSettings&)>& edit) {
    ViewSettings edited = settings_;
    edit(edited);
    return worst_block_difference(picture(), picture(snapshot_, edited))->worst;
  }

  std::unique_ptr<OsmesaContext> context_;
  std::unique_ptr<Renderer> renderer_;
  Snapshot snapshot_;
  ViewSettings settings_;
};

TEST_F(Rendering, ShowsALitBodyOverTheBackground) {
  const Image image = picture();
  EXPECT_EQ(image.width, sample_width_px);
  EXPECT_EQ(image.height, sample_height_px);
  std::set<int> shades;
  for (int y = 0; y < sample_height_px; ++y) {
    for (int x = 0; x < sample_width_px; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      EXPECT_EQ(p[3], 255);
      if (p[0] > p[2] + 25) shades.insert(p[0]);
    }
  }
  EXPECT_GT(shades.size(), 40u) << "clay is warm, and shaded rather than flat";
}

TEST_F(Rendering, TheTopRowComesFirst) {
  Snapshot nothing;
  settings_.overlays = {};
  settings_.overlays.tool = settings_.overlays.ground_grid = settings_.overlays.scale_bar = false;
  const Image image = picture(nothing, settings_);
  EXPECT_LT(image.pixel(10, 2)[0] + 20, image.pixel(10, sample_height_px - 3)[0])
      << "the floor is the brighter end";
}

TEST_F(Rendering, TheSameSnapshotGivesTheSamePixels) {
  const Image first = picture();
  EXPECT_EQ(first, picture());

  auto context = OsmesaContext::make(sample_width_px, sample_height_px);
  ASSERT_TRUE(context);
  auto other = Renderer::make(*context.value());
  ASSERT_TRUE(other);
  ASSERT_TRUE(other->draw(snapshot_, settings_, nullptr).ok());
  Image image;
  other->read_pixels(image);
  EXPECT_EQ(first, image);
}

TEST_F(Rendering, ALightMovedByFiveDegreesIsNoticed) {
  const Eigen::AngleAxisd turn(5.0 * M_PI / 180.0, Vector3::UnitY());
  const double moved = change([&](ViewSettings& s) { s.toward_key_light = turn * s.toward_key_light; });
  EXPECT_GT(moved, tolerance);
}

TEST_F(Rendering, StudiosDiffer) {
  ASSERT_EQ(studios().size(), 3u);
  for (const Studio& studio : studios().subspan(1)) {
    EXPECT_GT(change([&](ViewSettings& s) { s.studio = studio; }), tolerance) << studio.name;
  }
  EXPECT_GT(change([](ViewSettings& s) { s.studio_turn_rad = 5.0 * M_PI / 180.0; }), tolerance);
}

TEST_F(Rendering, ShadowsDarkenInEveryStudio) {
  settings_.overlays = {};
  settings_.overlays.ground_grid = settings_.overlays.scale_bar = settings_.overlays.force = false;
  for (const Studio& studio : studios()) {
    settings_.studio = studio;
    settings_.shadow = true;
    const Image with = picture();
    settings_.shadow = false;
    const Image without = picture();
    int darker = 0;
    for (std::size_t i = 0; i < with.rgba.size(); ++i) {
      ASSERT_LE(with.rgba[i], without.rgba[i] + 2) << studio.name;
      if (with.rgba[i] + 8 < without.rgba[i]) ++darker;
    }
    EXPECT_GT(darker, 1000) << studio.name;
  }
}

TEST_F(Rendering, MissingReflectionsAreNoticed) {
  for (const char* material : {"steel-304", "abs"}) {
    snapshot_.bodies[0].material.name = material;
    EXPECT_GT(change([](ViewSettings& s) { s.reflections = false; }), tolerance) << material;
  }
}

TEST_F(Rendering, MissingOcclusionIsNoticed) {
  snapshot_.bodies.push_back(snapshot_.bodies[0]);
  for (float& y : snapshot_.bodies[1].surface.y) y += 0.012f;
  EXPECT_GT(change([](ViewSettings& s) { s.occlusion = false; }), tolerance);
}

// No pixel of a plain skin differs from the next one by more than one step of eight bits, where the skin
// changes by less than that per pixel.
TEST_F(Rendering, SmoothGradientsHaveNoSteps) {
  settings_.overlays = {};
  settings_.overlays.tool = settings_.overlays.fixed_nodes = settings_.overlays.ground_grid =
      settings_.overlays.scale_bar = settings_.overlays.fixing_planes = settings_.overlays.force = false;
  settings_.shadow = false;
  settings_.camera.distance_m *= 0.3;
  settings_.is_transparent = true;
  snapshot_.bodies[0].material.name = "polypropylene";
  const Image image = picture();
  constexpr int run = 8;
  int smooth = 0;
  for (int y = 0; y < sample_height_px; ++y) {
    for (int x = 0; x + run < sample_width_px; x += run) {
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](int k) { return static_cast<int>(image.pixel(x + k, y)[c]); };
        int largest = 0;
        bool rises = true, falls = true, inside = true;
        for (int k = 0; k < run; ++k) {
          inside &= image.pixel(x + k, y)[3] == 255 && image.pixel(x + k + 1, y)[3] == 255;
          const int step = at(k + 1) - at(k);
          largest = std::max(largest, std::abs(step));
          rises &= step >= 0;
          falls &= step <= 0;
        }
        const int change = std::abs(at(run) - at(0));
        if (!inside || !(rises || falls) || change == 0 || change > run / 2) continue;
        ++smooth;
        EXPECT_LE(largest, 1) << x << " " << y;
      }
    }
  }
  EXPECT_GT(smooth, 1000);
}

TEST_F(Rendering, EveryOverlayShows) {
  snapshot_.bodies[0].lattice.touched[0] = 1;
  snapshot_.symmetric = true;
  snapshot_.symmetry = {Vector3::Zero(), Vector3::UnitZ()};
  snapshot_.mirrored_proxy = snapshot_.tool.proxy;
  const std::vector<std::pair<const char*, bool Overlays::*>> switches = {
      {"fixed nodes", &Overlays::fixed_nodes},
      {"touched nodes", &Overlays::touched_nodes},
      {"lattice", &Overlays::lattice},
      {"control net", &Overlays::control_net},
      {"force", &Overlays::force},
      {"contact normals", &Overlays::contact_normals},
      {"fixing planes", &Overlays::fixing_planes},
      {"plane of symmetry", &Overlays::symmetry_plane},
      {"tool", &Overlays::tool},
      {"ground grid", &Overlays::ground_grid},
      {"scale bar", &Overlays::scale_bar}};
  for (const auto& [name, overlay] : switches) {
    EXPECT_GT(
        change([&, overlay = overlay](ViewSettings& s) { s.overlays.*overlay = !(s.overlays.*overlay); }),
        tolerance)
        << name;
  }
}

// The scale bar on the ground is drawn even if a body hides it.
TEST_F(Rendering, TheScaleBarShowsBeforeABody) {
  const Viewport viewport = make_viewport(sample_width_px, sample_height_px, {});
  settings_.overlays = Overlays{};
  settings_.overlays.scale_bar = false;
  const auto covered_bar = [&]() -> std::optional<Eigen::Vector2d> {
    const auto bar = ground_scale_bar(settings_.camera, viewport, settings_.ground_y_m);
    if (!bar) return std::nullopt;
    const auto at = project(settings_.camera, viewport, 0.7 * bar->start_m + 0.3 * bar->end_m);
    if (!at) return std::nullopt;
    const Image image = picture();
    const std::uint8_t* p = image.pixel(static_cast<int>(at->x()), static_cast<int>(at->y()));
    return p[0] > p[2] + 25 ? at : std::nullopt;
  };
  std::optional<Eigen::Vector2d> at;
  for (int step = 0; step < 40 && !at; ++step) {
    settings_.camera.target_m.y() += 2e-3;
    at = covered_bar();
  }
  ASSERT_TRUE(at) << "no view has the body before the bar";
  const auto darkest = [&] {
    const Image image = picture();
    int least = 255;
    for (int y = -3; y <= 3; ++y) {
      least = std::min<int>(least, image.pixel(static_cast<int>(at->x()), static_cast<int>(at->y()) + y)[0]);
    }
    return least;
  };
  const int of_the_body = darkest();
  settings_.overlays.scale_bar = true;
  EXPECT_LT(darkest(), of_the_body - 40);
}

TEST_F(Rendering, EveryStageOfAContactShows) {
  settings_.stages = sample_stages(snapshot_);
  const auto shown = [&](ContactStage stage, int level) {
    return change([&](ViewSettings& s) {
      s.overlays.contact_stage = stage;
      s.overlays.sphere_level = level;
    });
  };
  EXPECT_GT(shown(ContactStage::hulls, 0), tolerance);
  for (int level = 0; level <= finest_stage_level; ++level) {
    EXPECT_GT(shown(ContactStage::spheres, level), tolerance) << level;
  }
  EXPECT_GT(shown(ContactStage::triangles, 0), tolerance);
  EXPECT_GT(shown(ContactStage::contacts, 0), tolerance);
  EXPECT_EQ(shown(ContactStage::none, 0), 0.0);
  settings_.stages = nullptr;
  EXPECT_EQ(shown(ContactStage::contacts, 0), 0.0);
}

TEST_F(Rendering, AStageOutsideTheBodyIsDrawnWhole) {
  auto stages = std::make_shared<ContactStages>();
  const Vector3 far = snapshot_.tool.proxy.position_m + Vector3(0.0, 0.02, 0.0);
  stages->spheres.push_back({{far, 0.006}, {0, 0, 0}, 0, false, true});
  settings_.stages = stages;
  settings_.overlays.contact_stage = ContactStage::spheres;
  settings_.overlays.tool = settings_.overlays.force = false;
  const Image shell = picture();
  settings_.stages = nullptr;
  const Image without = picture();
  const auto centre = project(settings_.camera, make_viewport(sample_width_px, sample_height_px, {}), far);
  ASSERT_TRUE(centre);
  const int x = static_cast<int>(centre->x()), y = static_cast<int>(centre->y());
  int redder = 0;
  for (int k = -4; k <= 4; ++k) {
    const auto redness = [&](const Image& image) {
      return image.pixel(x + k, y)[0] - image.pixel(x + k, y)[1];
    };
    redder += redness(shell) > redness(without) ? 1 : 0;
  }
  EXPECT_EQ(redder, 9) << "a shell of its colour";
}

TEST_F(Rendering, TheMirroredToolShowsFarFromTheOther) {
  settings_.overlays.symmetry_plane = false;
  const Image without = picture();
  snapshot_.symmetric = true;
  snapshot_.mirrored_proxy = snapshot_.tool.proxy;
  const Box body = drawn_bounds(snapshot_);
  snapshot_.mirrored_proxy.position_m = body.low - 0.2 * body.extent();
  EXPECT_GT(worst_block_difference(without, picture())->worst, tolerance);
}

TEST_F(Rendering, ShadowSamplesAndGhostShow) {
  EXPECT_GT(change([](ViewSettings& s) { s.shadow = false; }), tolerance);
  EXPECT_GT(change([](ViewSettings& s) { s.samples = 0; }), tolerance);
  EXPECT_GT(change([](ViewSettings& s) { s.see_through_body = true; }), tolerance);
}

TEST_F(Rendering, MaterialsDiffer) {
  const Image clay = picture();
  for (const char* material : {"steel-304", "jelly"}) {
    snapshot_.bodies[0].material.name = material;
    EXPECT_GT(worst_block_difference(clay, picture())->worst, 10.0) << material;
  }
}

// The silhouette is smooth: between background and body there are pixels of intermediate colours.
TEST_F(Rendering, FourSamplesSmoothTheEdges) {
  settings_.overlays = {};
  settings_.overlays.fixed_nodes = settings_.overlays.fixing_planes = settings_.overlays.ground_grid = false;
  ViewSettings rough = settings_;
  rough.samples = 0;
  const Image smooth_image = picture(), rough_image = picture(snapshot_, rough);
  const auto steepest_row_steps = [](const Image& image) {
    int steps = 0;
    for (int x = 250; x < 300; ++x) {
      int largest = 0;
      for (int y = 1; y < sample_height_px; ++y) {
        largest = std::max(largest, std::abs(image.pixel(x, y)[2] - image.pixel(x, y - 1)[2]));
      }
      steps += largest;
    }
    return steps;
  };
  EXPECT_LT(steepest_row_steps(smooth_image), 0.95 * steepest_row_steps(rough_image));
}

// With fewer pixels, edges are less sharp, and nothing is elsewhere.
TEST_F(Rendering, FewerPixelsShowTheSame) {
  settings_.samples = 0;
  settings_.panel_px = {0.0, 0.0, 0.2 * sample_width_px, 1.0 * sample_height_px};
  const Image whole = picture();
  ViewSettings fewer = settings_;
  for (const double resolution : {0.5, 0.77}) {
    fewer.resolution = resolution;
    const double difference = worst_block_difference(whole, picture(snapshot_, fewer))->worst;
    EXPECT_GT(difference, 0.1);
    EXPECT_LT(difference, 25.0) << resolution;  // 18 at the edge of the tool
  }
}

// Pixels of an earlier frame beside the areas of this one do not show.
TEST_F(Rendering, FewerPixelsShowNothingOfEarlierFrames) {
  settings_.samples = 0;
  settings_.resolution = 0.5;
  settings_.keep_level = false;
  ViewSettings moved = settings_;
  moved.camera.yaw_rad += 0.6;
  moved.camera.distance_m *= 1.7;
  const Image alone = picture(snapshot_, moved);
  picture();
  EXPECT_EQ(picture(snapshot_, moved), alone);
}

TEST_F(Rendering, ABrokenSurfaceOrSettingIsAnErrorNotACrash) {
  ViewSettings odd = settings_;
  odd.samples = 3;
  EXPECT_FALSE(renderer_->draw(snapshot_, odd, nullptr).ok());
  snapshot_.bodies[0].surface.y.clear();
  EXPECT_FALSE(renderer_->draw(snapshot_, settings_, nullptr).ok());
  snapshot_.bodies.clear();
  EXPECT_TRUE(renderer_->draw(snapshot_, settings_, nullptr).ok());
}

TEST_F(Rendering, AWildPoseDrawsNothingButEndsNothing) {
  for (float& x : snapshot_.bodies[0].surface.x) x = std::numeric_limits<float>::quiet_NaN();
  snapshot_.tool.proxy.position_m = Vector3::Constant(1e9);
  EXPECT_TRUE(renderer_->draw(snapshot_, settings_, nullptr).ok());
}

TEST_F(Rendering, TheInterfaceDrawsText) {
  if (!std::filesystem::exists(font_path)) GTEST_SKIP() << "needs fonts-roboto-unhinted";
  ImGuiContext* interface = ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.DisplaySize = {sample_width_px, sample_height_px};
  const auto fonts = add_interface_fonts(*io.Fonts, font_path, 15.0f, 19.0f);
  ASSERT_TRUE(fonts);
  renderer_->upload_fonts(*io.Fonts);
  ImGui::NewFrame();
  ImGui::GetForegroundDrawList()->AddRectFilled({0, 0}, {200, 60}, IM_COL32(255, 255, 255, 255));
  ImGui::GetForegroundDrawList()->AddText(fonts->heading, 19.0f, {10, 10}, IM_COL32(0, 0, 0, 255),
                                          "Spoonbill");
  ImGui::Render();
  const Image image = picture(snapshot_, settings_, ImGui::GetDrawData());
  ImGui::DestroyContext(interface);
  int dark = 0;
  for (int y = 8; y < 30; ++y) {
    for (int x = 8; x < 100; ++x) dark += image.pixel(x, y)[0] < 64 ? 1 : 0;
  }
  EXPECT_GT(dark, 100);
  EXPECT_LT(dark, 1000);
  EXPECT_EQ(image.pixel(150, 50)[0], 255) << "the plate is opaque white";
}

// A large rectangle covers what was drawn before it, is covered by what follows, and ends at its clip.
TEST_F(Rendering, TheInterfacesRectanglesFillTheirPixels) {
  if (!std::filesystem::exists(font_path)) GTEST_SKIP() << "needs fonts-roboto-unhinted";
  const Image without = picture();
  ImGuiContext* interface = ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.DisplaySize = {sample_width_px, sample_height_px};
  ASSERT_TRUE(add_interface_fonts(*io.Fonts, font_path, 15.0f, 19.0f));
  renderer_->upload_fonts(*io.Fonts);
  ImGui::NewFrame();
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddRectFilled({30, 40}, {70, 60}, IM_COL32(0, 0, 255, 255));
  list.PushClipRect({20, 20}, {120, 90});
  list.AddRectFilled({10, 30}, {200, 80}, IM_COL32(10, 200, 30, 255));
  list.PopClipRect();
  list.AddRectFilled({50, 50}, {60, 60}, IM_COL32(255, 0, 0, 255));
  list.AddRectFilled({80, 35}, {110, 75}, IM_COL32(255, 255, 255, 128));
  ImGui::Render();
  const Image with = picture(snapshot_, settings_, ImGui::GetDrawData());
  ImGui::DestroyContext(interface);
  const auto colour_at = [](const Image& image, int x, int y) {
    const std::uint8_t* const pixel = image.pixel(x, y);
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  for (const auto& [x, y] : {std::pair(20, 30), std::pair(119, 79), std::pair(35, 45), std::pair(20, 79)})
    EXPECT_EQ(colour_at(with, x, y), (std::array<int, 3>{10, 200, 30})) << x << ", " << y;
  for (const auto& [x, y] : {std::pair(19, 50), std::pair(120, 50), std::pair(50, 29), std::pair(50, 80)})
    EXPECT_EQ(colour_at(with, x, y), colour_at(without, x, y)) << x << ", " << y;
  EXPECT_EQ(colour_at(with, 55, 55), (std::array<int, 3>{255, 0, 0}));
  EXPECT_NEAR(colour_at(with, 90, 50)[0], 133, 2);
}

TEST(InterfaceFonts, AMissingFileIsAnError) {
  ImFontAtlas atlas;
  const auto fonts = add_interface_fonts(atlas, "/nonexistent/font.ttf", 15.0f, 19.0f);
  ASSERT_FALSE(fonts);
  EXPECT_EQ(fonts.error().code, ErrorCode::unreadable);
  EXPECT_NE(fonts.error().message.find("/nonexistent/font.ttf"), std::string::npos);
}

TEST(OsmesaContext, ImpossibleSizesAreRefused) {
  EXPECT_FALSE(OsmesaContext::make(0, 10));
  EXPECT_FALSE(OsmesaContext::make(10, 100000));
}

}  // namespace
}  // namespace spoonbill
