#include "app/edit/edit_window.h"

#include <backends/imgui_impl_glfw.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/panel/font_file.h"

namespace spoonbill {
namespace {

// Whole and half steps: letters are sharp at these.
double stepped(double scale) {
  return std::clamp(std::round(2.0 * scale) / 2.0, 1.0, 4.0);
}

}  // namespace

struct EditWindow::Backend {
  explicit Backend(GLFWwindow* window) { ImGui_ImplGlfw_InitForOther(window, true); }
  ~Backend() { ImGui_ImplGlfw_Shutdown(); }
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
};

Result<EditWindow> EditWindow::make(int width, int height, std::optional<double> scale) {
  auto window = GlfwWindow::make(width, height, "Spoonbill");
  if (!window) return window.error();
  const double at = stepped(scale.value_or(window.value()->scale()));
  auto interface = InterfaceContext::make(font_file, at);
  if (!interface) return interface.error();
  auto renderer = Renderer::make(*window.value());
  if (!renderer) return renderer.error();
  renderer->upload_fonts(interface->fonts());
  return EditWindow(std::move(window).value(), std::move(interface).value(), std::move(renderer).value(), at,
                    scale);
}

EditWindow::EditWindow(std::unique_ptr<GlfwWindow> window, InterfaceContext interface, Renderer renderer,
                       double scale, std::optional<double> chosen_scale)
    : window_(std::move(window)),
      interface_(std::move(interface)),
      renderer_(std::move(renderer)),
      scale_(scale),
      chosen_scale_(chosen_scale) {
  interface_.make_current();
  backend_ = std::make_unique<Backend>(window_->native());
}

EditWindow::EditWindow(EditWindow&&) noexcept = default;
EditWindow::~EditWindow() = default;

Status EditWindow::begin_frame() {
  window_->poll_events();
  const double wanted = stepped(chosen_scale_.value_or(window_->scale()));
  if (wanted != scale_) {
    if (Status rescaled = interface_.rescale(wanted); !rescaled) return rescaled;
    renderer_.upload_fonts(interface_.fonts());
    scale_ = wanted;
  }
  interface_.make_current();
  ImGui_ImplGlfw_NewFrame();
  interface_.begin_frame(window_->width_px(), window_->height_px());
  return {};
}

Status EditWindow::end_frame(const Snapshot& snapshot, const ViewSettings& view) {
  const ImDrawData& interface = interface_.end_frame();
  if (window_->is_minimised()) return {};
  if (Status drawn = renderer_.draw(snapshot, view, &interface); !drawn) return drawn;
  renderer_.present();
  return {};
}

}  // namespace spoonbill
