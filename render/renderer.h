// Draws snapshots. One renderer a context; it lives on the context's thread.
//
//   auto context = OsmesaContext::make(1280, 720);
//   auto renderer = Renderer::make(*context.value());
//   renderer->upload_fonts(*ImGui::GetIO().Fonts);                  // once, with a panel
//   renderer->draw(snapshot, settings, ImGui::GetDrawData());       // each frame
//   renderer->read_pixels(image);                                   // or renderer->present()
//
// The picture depends on snapshot, settings and interface alone: the same input gives the same pixels, on any
// number of drawing threads, except that with ViewSettings::keep_level the tessellation may keep a slightly
// finer or coarser level from the frame before.
#pragma once

#include <imgui.h>

#include <memory>

#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/gl/context.h"
#include "render/image/image.h"
#include "render/view_settings.h"

namespace spoonbill {

class Renderer {
 public:
  // Makes the context current and builds everything that does not depend on a snapshot. The context must
  // outlive the renderer and be current where the renderer is destroyed.
  static Result<Renderer> make(GlContext& context);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Call before the first ImGui::NewFrame() and whenever fonts changed.
  void upload_fonts(ImFontAtlas& atlas);

  // Draws a frame of the context's present size; `interface` may be null. A surface that cannot be drawn is
  // an error and leaves the frame unfinished.
  Status draw(const Snapshot& snapshot, const ViewSettings& settings, const ImDrawData* interface);

  // The last frame, RGBA8 in sRGB, top row first.
  void read_pixels(Image& image) const;

  // Shows the last frame in the context's window; does nothing without a window.
  void present();

 private:
  class Parts;
  explicit Renderer(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace spoonbill
