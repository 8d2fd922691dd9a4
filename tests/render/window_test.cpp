#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>
#include <utility>

#include "engine/base/geometry.h"
#include "render/gl/context.h"
#include "render/gl/glfw_window.h"
#include "render/renderer.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/render/compare.h"
#include "tests/render/sample_scene.h"
#include "tests/render/virtual_display.h"

namespace spoonbill {
namespace {

constexpr int width = 640, height = 360;

// Largest difference allowed in any block between the pictures of two rasterisers; the comparison with the
// approved pictures has the same limit.
constexpr double tolerance = 2.0;

ViewSettings settings_for(const Snapshot& snapshot, int width_px, int height_px) {
  ViewSettings settings;
  const Box box = drawn_bounds(snapshot);
  settings.ground_y_m = ground_below(box);
  settings.camera =
      frame(look_from({}, StandardView::perspective), box, make_viewport(width_px, height_px, {}));
  return settings;
}

Image drawn_by(Renderer& renderer, const Snapshot& snapshot, int width_px, int height_px) {
  Image image;
  const Status drawn = renderer.draw(snapshot, settings_for(snapshot, width_px, height_px), nullptr);
  EXPECT_TRUE(drawn.ok()) << drawn.error().message;
  renderer.read_pixels(image);
  return image;
}

Image drawn_offscreen(const Snapshot& snapshot) {
  auto context = OsmesaContext::make(width, height);
  EXPECT_TRUE(context);
  auto renderer = Renderer::make(*context.value());
  EXPECT_TRUE(renderer);
  return drawn_by(renderer.value(), snapshot, width, height);
}

// Waits for the condition while handling events. The display answers with a delay; five minutes are enough
// under any load.
template <class Condition>
bool comes_true(GlfwWindow& window, const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(300);
  while (!condition() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    window.poll_events();
  }
  return condition();
}

class Window : public ::testing::Test {
 protected:
  void SetUp() override {
    auto display = VirtualDisplay::start(1600, 1000);
    ASSERT_TRUE(display) << display.error().message;
    display_ = std::move(display).value();
  }

  void open() {
    auto window = GlfwWindow::make(width, height, "Spoonbill");
    ASSERT_TRUE(window) << window.error().message;
    window_ = std::move(window).value();
    auto renderer = Renderer::make(*window_);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::make_unique<Renderer>(std::move(renderer).value());
    window_->show();
  }

  // Returns true once the display shows the picture. Draws repeatedly, as an interface does: Mesa may notice
  // a new size only after the first frame.
  bool shows(const Image& picture) {
    return comes_true(*window_, [&] {
      renderer_->present();
      return display_->screenshot(picture.width, picture.height) == picture;
    });
  }

  Snapshot snapshot_ = sample_scene({.bend_rad = 0.4});
  std::unique_ptr<VirtualDisplay> display_;
  std::unique_ptr<GlfwWindow> window_;
  std::unique_ptr<Renderer> renderer_;  // must be destroyed before the window
};

TEST_F(Window, DrawsAndShowsWhatIsDrawnOffscreen) {
  const Image offscreen = drawn_offscreen(snapshot_);
  open();
  ASSERT_TRUE(comes_true(*window_, [&] { return window_->width_px() == width; }));
  const Image drawn = drawn_by(*renderer_, snapshot_, width, height);
  ASSERT_TRUE(worst_block_difference(offscreen, drawn));
  EXPECT_LT(worst_block_difference(offscreen, drawn)->worst, tolerance);
  EXPECT_TRUE(shows(drawn));
}

TEST_F(Window, TheFrameFollowsTheWindowsSize) {
  open();
  window_->resize(800, 450);
  ASSERT_TRUE(
      comes_true(*window_, [&] { return window_->width_px() == 800 && window_->height_px() == 450; }));
  EXPECT_EQ(window_->width(), 800);
  EXPECT_EQ(window_->height(), 450);
  const Image image = drawn_by(*renderer_, snapshot_, 800, 450);
  EXPECT_EQ(image.width, 800);
  EXPECT_EQ(image.height, 450);
  EXPECT_TRUE(shows(image));
}

TEST_F(Window, ADenseDisplayGetsMorePixels) {
  display_->set_dots_per_inch(192);
  open();
  EXPECT_EQ(window_->scale(), 2.0);
  EXPECT_TRUE(comes_true(*window_, [&] { return window_->width_px() == 2 * width; }));
}

TEST_F(Window, OnlyOneIsOpenAtATime) {
  open();
  EXPECT_EQ(GlfwWindow::make(width, height, "second").error().code, ErrorCode::in_use);
  renderer_.reset();
  window_.reset();
  open();
}

TEST_F(Window, AWishToCloseCanBePutAside) {
  open();
  EXPECT_FALSE(window_->should_close());
  window_->set_should_close(true);
  EXPECT_TRUE(window_->should_close());
}

TEST(WindowWithoutDisplay, SaysWhatWorksWithoutOne) {
  unsetenv("DISPLAY");
  const auto window = GlfwWindow::make(width, height, "Spoonbill");
  ASSERT_FALSE(window);
  EXPECT_EQ(window.error().code, ErrorCode::unavailable);
  const std::string& message = window.error().message;
  EXPECT_NE(message.find("spoonbill replay"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(WindowWithoutDisplay, ImpossibleSizesAreRefused) {
  EXPECT_FALSE(GlfwWindow::make(0, 10, "Spoonbill"));
  EXPECT_FALSE(GlfwWindow::make(10, 100000, "Spoonbill"));
}

}  // namespace
}  // namespace spoonbill
