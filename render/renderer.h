// Draws snapshots. A context has one renderer, which must be used on the thread of the context.
//
//   auto context = OsmesaContext::make(1280, 720);
//   auto renderer = Renderer::make(*context.value());
//   renderer->upload_fonts(*ImGui::GetIO().Fonts);                  // once, with a panel
//   renderer->draw(snapshot, settings, ImGui::GetDrawData());       // each frame
//   renderer->read_pixels(image);                                   // or renderer->present()
//
// The picture depends only on snapshot, settings and interface: the same input gives the same pixels for any
// number of drawing threads. There are two exceptions, which retain something from earlier frames. With
// ViewSettings::keep_level the tessellation may be slightly finer or coarser, and the edge of the fixed part
// and the visibility of some vertices are those of earlier shapes. A deforming mesh keeps the sharp edges of
// its first shape, and its groups of triangles that hide light from each other.
#pragma once

#include <imgui.h>

#include <memory>
#include <string>

#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/gl/context.h"
#include "render/image.h"
#include "render/view_settings.h"

namespace spoonbill {

// The interface font in its two sizes.
struct InterfaceFonts {
  ImFont* body = nullptr;  // owned by the atlas
  ImFont* heading = nullptr;
};

// Adds both sizes (in pixels) of a TrueType file to the atlas, with the characters of units and labels: Greek
// letters, superscripts, degrees, and arrows if the font has them. Upload the atlas afterwards. Errors: a
// missing or unreadable file; the message names the file and the package that provides it.
Result<InterfaceFonts> add_interface_fonts(ImFontAtlas& atlas, const std::string& path, float body_px,
                                           float heading_px);

class Renderer {
 public:
  // Makes the context current and builds everything that does not depend on a snapshot. The context must
  // outlive the renderer and be current when the renderer is destroyed.
  static Result<Renderer> make(GlContext& context);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Uploads the font atlas. Call before the first ImGui::NewFrame() and whenever fonts change.
  void upload_fonts(ImFontAtlas& atlas);

  // Draws a frame in the current size of the context; `interface` may be null. A surface that cannot be drawn
  // is an error and leaves the frame incomplete.
  Status draw(const Snapshot& snapshot, const ViewSettings& settings, const ImDrawData* interface);

  // Copies the last frame as RGBA8 in sRGB, top row first.
  void read_pixels(Image& image) const;

  // Shows the last frame in the window of the context; does nothing without a window.
  void present();

 private:
  class Parts;
  explicit Renderer(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace spoonbill
