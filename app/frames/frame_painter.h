// Paints snapshots with the panel beside them, offscreen. One owner; the thread that made it.
#pragma once

#include <memory>

#include "app/panel/interface_context.h"
#include "app/panel/panel_model.h"
#include "app/view/view_choice.h"
#include "render/gl/osmesa_context.h"
#include "render/image/image.h"
#include "render/renderer.h"

namespace spoonbill {

class FramePainter {
 public:
  // `start` is what the camera and the ground go by: the body as it was before it was touched.
  static Result<FramePainter> make(int width_px, int height_px, const Snapshot& start);

  FramePainter(FramePainter&&) noexcept = default;
  FramePainter& operator=(FramePainter&&) = delete;

  // How a frame of this size shows the choice, with room for the panel.
  ViewSettings view_of(const ViewChoice& choice) const;

  // The panel is left out where the frame is too small for it.
  Status paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel, Image& image);

 private:
  FramePainter(std::unique_ptr<OsmesaContext> context, InterfaceContext interface, Renderer renderer,
               const BoundingBox& body)
      : context_(std::move(context)),
        interface_(std::move(interface)),
        renderer_(std::move(renderer)),
        body_(body) {}
  const ImDrawData& lay_out(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel);

  std::unique_ptr<OsmesaContext> context_;
  InterfaceContext interface_;
  Renderer renderer_;  // after the context, which it needs to the end
  BoundingBox body_;
};

}  // namespace spoonbill
