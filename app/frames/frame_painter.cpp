#include "app/frames/frame_painter.h"

#include <utility>

#include "app/panel/font_file.h"
#include "app/panel/panel.h"
#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

std::unique_lock<std::mutex> take_turn(std::mutex* interface_turn) {
  return interface_turn != nullptr ? std::unique_lock(*interface_turn) : std::unique_lock<std::mutex>();
}

}  // namespace

Box framed_box(const Snapshot& start) {
  Box box;
  for (const BodySnapshot& body : start.bodies) {
    const SurfaceSnapshot& surface = body.surface;
    for (std::size_t i = 0; i < surface.x.size(); ++i) {
      box.include({surface.x[i], surface.y[i], surface.z[i]});
    }
    for (std::size_t i = 0; i < body.mesh.x.size(); ++i) {
      box.include({body.mesh.x[i], body.mesh.y[i], body.mesh.z[i]});
    }
  }
  return box;
}

ViewSettings frame_view(const ViewChoice& choice, const Box& framed, int width_px, int height_px) {
  ViewSettings view =
      settings_for(choice, framed, width_px, height_px, picture_panel_rectangle(width_px, height_px),
                   interface_scale_for(height_px));
  view.keep_level = false;
  return view;
}

Result<FramePainter> FramePainter::make(int width_px, int height_px, std::mutex* interface_turn) {
  const auto turn = take_turn(interface_turn);
  auto context = OsmesaContext::make(width_px, height_px);
  if (!context) return context.error();
  auto interface = InterfaceContext::make(font_file, panel_scale(height_px));
  if (!interface) return interface.error();
  auto renderer = Renderer::make(*context.value());
  if (!renderer) return renderer.error();
  renderer->upload_fonts(interface->fonts());
  return FramePainter(std::move(context).value(), std::move(interface).value(), std::move(renderer).value(),
                      interface_turn);
}

FramePainter::~FramePainter() {
  if (!context_) return;  // moved from
  const auto turn = take_turn(interface_turn_);
  interface_.reset();
}

Status FramePainter::paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel,
                           Image& image) {
  ViewSettings shown = view;
  stages_.fill(snapshot, shown);
  if (Status drawn = renderer_.draw(snapshot, shown, &lay_out(snapshot, shown, panel)); !drawn) return drawn;
  renderer_.read_pixels(image);
  return {};
}

const ImDrawData& FramePainter::lay_out(const Snapshot& snapshot, const ViewSettings& view,
                                        const PanelModel& panel) {
  const int width = context_->width_px();
  const int height = context_->height_px();
  const auto turn = take_turn(interface_turn_);
  interface_->begin_frame(width, height);
  draw_labels(overlay_labels(snapshot, view, width, height), view, width, height,
              *interface_->theme().fonts.body, *ImGui::GetBackgroundDrawList());
  // Nobody can press anything in a picture.
  if (view.panel_px.width > 0.0) draw_panel(panel, interface_->theme(), view.panel_px);
  return interface_->end_frame();
}

}  // namespace spoonbill
