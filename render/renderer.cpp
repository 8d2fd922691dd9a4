#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/file.h"
#include "render/gl/pipeline.h"
#include "render/gl/render_target.h"
#include "render/imgui_pass.h"
#include "render/passes/frame_view.h"
#include "render/passes/mesh_buffers.h"
#include "render/passes/scene_passes.h"

namespace spoonbill {
namespace {

constexpr std::size_t font_bytes_limit = std::size_t{256} << 20;

// Character ranges: Latin-1, Greek, general punctuation, superscripts, arrows and mathematical signs. The
// array must persist, because ImGui stores a pointer to it.
constexpr ImWchar glyph_ranges[] = {0x0020, 0x00ff, 0x0370, 0x03ff, 0x2010, 0x2030, 0x2070, 0x209f,
                                    0x2190, 0x2194, 0x2212, 0x2212, 0x2248, 0x2265, 0};

ImFont* add_size(ImFontAtlas& atlas, const std::string& file, float size_px) {
  ImFontConfig config;
  config.OversampleH = 2;
  config.OversampleV = 1;
  // The atlas gets a copy of the file, because it reads the file only after this function has returned.
  void* copy = IM_ALLOC(file.size());
  std::memcpy(copy, file.data(), file.size());
  return atlas.AddFontFromMemoryTTF(copy, static_cast<int>(file.size()), size_px, &config, glyph_ranges);
}

PixelSize choose_scene_size(PixelSize frame, const ViewSettings& settings) {
  if (settings.samples > 0) return frame;
  SPOONBILL_ASSERT(settings.resolution >= 0.5 && settings.resolution <= 1.0);
  const auto part = [&](int size_px) {
    return std::max(1, static_cast<int>(std::ceil(settings.resolution * size_px)));
  };
  return {part(frame.width_px), part(frame.height_px)};
}

// Returns the view of the scene layer. Its lines and marks cover as much of the picture as in the frame.
FrameView make_scene_view(const FrameView& frame, PixelSize scene) {
  FrameView view = frame;
  const double part_x = static_cast<double>(scene.width_px) / frame.viewport.width_px;
  const double part_y = static_cast<double>(scene.height_px) / frame.viewport.height_px;
  const Rectangle& free_px = frame.viewport.free_px;
  view.viewport = {scene.width_px,
                   scene.height_px,
                   {part_x * free_px.x, part_y * free_px.y, part_x * free_px.width, part_y * free_px.height}};
  view.interface_scale *= static_cast<float>(part_x);
  view.pixel_depth_ratio *= static_cast<float>(part_x);
  return view;
}

}  // namespace

Result<InterfaceFonts> add_interface_fonts(ImFontAtlas& atlas, const std::string& path, float body_px,
                                           float heading_px) {
  const auto file = read_file(path, font_bytes_limit);
  constexpr std::uint8_t truetype[4] = {0, 1, 0, 0};
  if (!file || file->size() < sizeof(truetype) ||
      std::memcmp(file->data(), truetype, sizeof(truetype)) != 0) {
    return Error{ErrorCode::unreadable,
                 path + ": no readable TrueType font; install fonts-roboto-unhinted or name another file"};
  }
  return InterfaceFonts{add_size(atlas, file.value(), body_px), add_size(atlas, file.value(), heading_px)};
}

// The parts of a renderer in one object that never moves, because GL objects refer to the function table.
class Renderer::Parts {
 public:
  Parts(GlContext& context, const GlFunctions& functions)
      : context_(&context), gl_(functions), bodies_(gl_) {}

  Status build() {
    auto scene = ScenePasses::make(gl_);
    if (!scene) return scene.error();
    scene_.emplace(std::move(scene).value());
    auto interface = ImGuiPass::make(gl_);
    if (!interface) return interface.error();
    interface_.emplace(std::move(interface).value());
    return {};
  }

  void upload_fonts(ImFontAtlas& atlas) { interface_->upload_fonts(atlas); }

  Status draw(const Snapshot& snapshot, const ViewSettings& settings, const ImDrawData* interface) {
    if (Status current = context_->make_current(); !current) return current;
    if (Status target = fit_target(settings); !target) return target;
    const FrameView view = make_frame_view(settings, target_->width_px(), target_->height_px());
    const FrameView scene_view = make_scene_view(view, target_->scene_size());
    const double detail = settings.detail * pixels_per_metre(settings.camera, view.viewport);
    if (Status bodies = bodies_.update(
            snapshot, detail,
            {settings.keep_level, settings.occlusion, settings.overlays.fixed_nodes, settings.overlays.tool});
        !bodies) {
      return bodies;
    }
    if (Status looks = scene_->prepare(snapshot, settings); !looks) return looks;
    if (Status tool = scene_->update_tool(snapshot.tool); !tool) return tool;
    scene_->draw_shadows(view, snapshot, settings, bodies_);
    scene_->draw(view, scene_view, snapshot, settings, bodies_, *target_);
    if (interface != nullptr) interface_->draw(*interface);
    return {};
  }

  void read_pixels(Image& image) const {
    if (target_) target_->read(image);
  }

  void present() {
    if (!target_ || !context_->has_window()) return;
    target_->copy_to_window();
    context_->swap();
  }

 private:
  Status fit_target(const ViewSettings& settings) {
    const PixelSize frame{context_->width_px(), context_->height_px()};
    const PixelSize scene = choose_scene_size(frame, settings);
    const bool fits = target_ && target_->width_px() == frame.width_px &&
                      target_->height_px() == frame.height_px && target_->scene_size() == scene &&
                      target_->samples() == settings.samples;
    if (fits) return {};
    target_.reset();
    auto target =
        RenderTarget::make(gl_, frame, scene, settings.samples, context_->has_window() ? GL_BGRA : GL_RGBA);
    if (!target) return target.error();
    target_.emplace(std::move(target).value());
    return {};
  }

  GlContext* context_;
  GlFunctions gl_;
  BodyMeshes bodies_;
  std::optional<RenderTarget> target_;
  std::optional<ScenePasses> scene_;
  std::optional<ImGuiPass> interface_;
};

Result<Renderer> Renderer::make(GlContext& context) {
  if (Status current = context.make_current(); !current) return current.error();
  const auto functions = load_gl_functions(context);
  if (!functions) return functions.error();
  auto parts = std::make_unique<Parts>(context, functions.value());
  if (Status built = parts->build(); !built) return built.error();
  return Renderer(std::move(parts));
}

Renderer::Renderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

void Renderer::upload_fonts(ImFontAtlas& atlas) {
  parts_->upload_fonts(atlas);
}

Status Renderer::draw(const Snapshot& snapshot, const ViewSettings& settings, const ImDrawData* interface) {
  return parts_->draw(snapshot, settings, interface);
}

void Renderer::read_pixels(Image& image) const {
  parts_->read_pixels(image);
}

void Renderer::present() {
  parts_->present();
}

}  // namespace spoonbill
