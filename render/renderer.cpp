#include "render/renderer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "render/gl/functions.h"
#include "render/gl/render_target.h"
#include "render/imgui_pass.h"
#include "render/passes/body_meshes.h"
#include "render/passes/frame_view.h"
#include "render/passes/scene_passes.h"

namespace spoonbill {

// GL objects point at the function table, so everything lives in one place that never moves.
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
    if (Status target = fit_target(settings.samples); !target) return target;
    const FrameView view = make_frame_view(settings, target_->width_px(), target_->height_px());
    const double detail = settings.detail * pixels_per_metre(settings.camera, view.viewport);
    if (Status bodies = bodies_.update(snapshot, detail, settings.keep_level); !bodies) return bodies;
    if (Status tool = scene_->follow(snapshot.tool); !tool) return tool;
    scene_->draw_shadows(view, snapshot, settings, bodies_);
    scene_->draw(view, snapshot, settings, bodies_, *target_);
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
  Status fit_target(int samples) {
    const int width = context_->width_px(), height = context_->height_px();
    const bool fits = target_ && target_->width_px() == width && target_->height_px() == height &&
                      target_->samples() == samples;
    if (fits) return {};
    target_.reset();
    auto target = RenderTarget::make(gl_, width, height, samples);
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
