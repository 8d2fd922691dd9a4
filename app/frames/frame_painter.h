// Paints snapshots with the panel beside them, offscreen. One owner; the thread that made it.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "app/panel/interface_context.h"
#include "app/panel/panel_model.h"
#include "app/view/shown_stages.h"
#include "app/view/view_choice.h"
#include "engine/base/geometry.h"
#include "render/gl/context.h"
#include "render/image.h"
#include "render/renderer.h"

namespace spoonbill {

// What the camera and the ground go by: the box around the control nets of a snapshot, taken before the body
// was touched.
Box framed_box(const Snapshot& start);

// How a frame of this size shows the choice, with room for the panel. Its picture does not depend on the
// frames before.
ViewSettings frame_view(const ViewChoice& choice, const Box& framed, int width_px, int height_px);

class FramePainter {
 public:
  // Dear ImGui knows one current context in a process: painters on several threads share `interface_turn`,
  // which each holds while it lays out its interface. Null for a painter that is alone.
  static Result<FramePainter> make(int width_px, int height_px, std::mutex* interface_turn = nullptr);

  FramePainter(FramePainter&&) noexcept = default;
  FramePainter& operator=(FramePainter&&) = delete;
  ~FramePainter();

  // The panel is left out where the frame is too small for it.
  Status paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel, Image& image);

 private:
  FramePainter(std::unique_ptr<OsmesaContext> context, InterfaceContext interface, Renderer renderer,
               std::mutex* interface_turn)
      : context_(std::move(context)),
        interface_(std::move(interface)),
        renderer_(std::move(renderer)),
        interface_turn_(interface_turn) {}
  const ImDrawData& lay_out(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel);

  std::unique_ptr<OsmesaContext> context_;
  std::optional<InterfaceContext> interface_;  // empty only in its last moment
  Renderer renderer_;                          // after the context, which it needs to the end
  std::mutex* interface_turn_;
  ShownStages stages_;
};

}  // namespace spoonbill
