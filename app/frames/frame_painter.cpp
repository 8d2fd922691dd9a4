#include "app/frames/frame_painter.h"

#include <utility>

#include "app/panel/font_file.h"
#include "app/panel/panel.h"
#include "render/overlay/labels.h"

namespace spoonbill {
namespace {

BoundingBox box_of(const Snapshot& snapshot) {
  BoundingBox box;
  for (const SurfaceSnapshot& surface : snapshot.surfaces) {
    for (std::size_t i = 0; i < surface.x.size(); ++i) {
      box.include({surface.x[i], surface.y[i], surface.z[i]});
    }
  }
  return box;
}

}  // namespace

Result<FramePainter> FramePainter::make(int width_px, int height_px, const Snapshot& start) {
  auto context = OsmesaContext::make(width_px, height_px);
  if (!context) return context.error();
  auto interface = InterfaceContext::make(font_file, panel_scale(height_px));
  if (!interface) return interface.error();
  auto renderer = Renderer::make(*context.value());
  if (!renderer) return renderer.error();
  renderer->upload_fonts(interface->fonts());
  return FramePainter(std::move(context).value(), std::move(interface).value(), std::move(renderer).value(),
                      box_of(start));
}

ViewSettings FramePainter::view_of(const ViewChoice& choice) const {
  const int width = context_->width_px();
  const int height = context_->height_px();
  return settings_for(choice, body_, width, height, picture_panel_rectangle(width, height),
                      interface_scale_for(height));
}

Status FramePainter::paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel,
                           Image& image) {
  if (Status drawn = renderer_.draw(snapshot, view, &lay_out(snapshot, view, panel)); !drawn) return drawn;
  renderer_.read_pixels(image);
  return {};
}

const ImDrawData& FramePainter::lay_out(const Snapshot& snapshot, const ViewSettings& view,
                                        const PanelModel& panel) {
  const int width = context_->width_px();
  const int height = context_->height_px();
  interface_.begin_frame(width, height);
  draw_labels(overlay_labels(snapshot, view, width, height), view, width, height,
              *interface_.theme().fonts.body, *ImGui::GetBackgroundDrawList());
  // Nobody can press anything in a picture.
  if (view.panel_px.width > 0.0) draw_panel(panel, interface_.theme(), view.panel_px);
  return interface_.end_frame();
}

}  // namespace spoonbill
