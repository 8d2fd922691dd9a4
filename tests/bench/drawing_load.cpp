#include "tests/bench/drawing_load.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "render/camera.h"
#include "render/gl/context.h"
#include "render/renderer.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

DrawingLoad::DrawingLoad(std::vector<Snapshot> snapshots)
    : snapshots_(std::move(snapshots)), thread_([this] { draw(); }) {}

DrawingLoad::~DrawingLoad() {
  stop_ = true;
  thread_.join();
}

void DrawingLoad::draw() {
  constexpr int width_px = 1280, height_px = 720;
  auto context = OsmesaContext::make(width_px, height_px);
  if (!context) {
    failed_ = true;
    return;
  }
  auto renderer = Renderer::make(*context.value());
  if (!renderer) {
    failed_ = true;
    return;
  }
  ViewSettings settings;
  const Box box = drawn_bounds(snapshots_.front());
  settings.ground_y_m = ground_below(box);
  settings.camera =
      frame(look_from({}, StandardView::perspective), box, make_viewport(width_px, height_px, {}));
  auto next = std::chrono::steady_clock::now();
  while (!stop_) {
    const auto turn = static_cast<std::size_t>(frames_) % snapshots_.size();
    if (!renderer->draw(snapshots_[turn], settings, nullptr)) failed_ = true;
    ++frames_;
    next = std::max(next + std::chrono::microseconds(16667), std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

}  // namespace spoonbill
