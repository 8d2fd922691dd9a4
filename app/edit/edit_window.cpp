#include "app/edit/edit_window.h"

#include <backends/imgui_impl_glfw.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/panel/interface_context.h"
#include "engine/exchange/json.h"

namespace spoonbill {
namespace {

// Rounds the scale to a multiple of 0.5 from 1 to 4. Letters are sharp at these scales.
double round_scale(double scale) {
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
  const double at = round_scale(scale.value_or(window.value()->scale()));
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
  const double new_scale = round_scale(chosen_scale_.value_or(window_->scale()));
  if (new_scale != scale_) {
    if (Status rescaled = interface_.rescale(new_scale); !rescaled) return rescaled;
    renderer_.upload_fonts(interface_.fonts());
    scale_ = new_scale;
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

Result<Image> EditWindow::end_frame_as_picture(const Snapshot& snapshot, const ViewSettings& view) {
  // The labels of the scene are in the background list; the other lists are windows.
  ImDrawData scene = interface_.end_frame();
  ImDrawList* const labels = ImGui::GetBackgroundDrawList();
  ImDrawList** const end = scene.CmdLists + scene.CmdListsCount;
  scene.CmdListsCount = std::find(scene.CmdLists, end, labels) != end ? 1 : 0;
  scene.CmdLists = scene.CmdListsCount > 0 ? std::find(scene.CmdLists, end, labels) : nullptr;
  if (Status drawn = renderer_.draw(snapshot, view, &scene); !drawn) return drawn.error();
  Image picture;
  renderer_.read_pixels(picture);
  return picture;
}

Pointer read_pointer() {
  const ImGuiIO& io = ImGui::GetIO();
  Pointer pointer;
  pointer.position_px = {io.MousePos.x, io.MousePos.y};
  pointer.moved_px = {io.MouseDelta.x, io.MouseDelta.y};
  pointer.wheel = io.MouseWheel;
  pointer.left = io.MouseDown[0];
  pointer.right = io.MouseDown[1];
  pointer.middle = io.MouseDown[2];
  pointer.ctrl = io.KeyCtrl;
  pointer.shift = io.KeyShift;
  pointer.alt = io.KeyAlt;
  return pointer;
}

Result<FrameLog> FrameLog::open(const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::trunc);
  if (!out) {
    return Error{ErrorCode::unwritable,
                 file.string() + " cannot be written: check the folder and its permissions"};
  }
  return FrameLog(std::move(out));
}

void FrameLog::add(const ShownFrame& shown) {
  const Json line = {{"frame", ++frames_},
                     {"tick", shown.tick},
                     {"session", shown.session},
                     {"edit", shown.edit_count},
                     {"recording", shown.recording},
                     {"in_stroke", shown.in_stroke},
                     {"can_undo", shown.can_undo},
                     {"can_redo", shown.can_redo},
                     {"last_frame_ms", shown.last_frame_ms},
                     {"pressing", shown.pressing},
                     {"prompt", shown.prompt},
                     {"typed", shown.typed},
                     {"answers_px", shown.answers_px},
                     {"pointer_x_px", shown.pointer_x_px},
                     {"pointer_y_px", shown.pointer_y_px},
                     {"hand_lag_m", shown.hand_lag_m},
                     {"stage", shown.stage},
                     {"missed", shown.missed},
                     {"end", shown.end},
                     {"wanted_m", {shown.wanted_m.x(), shown.wanted_m.y(), shown.wanted_m.z()}}};
  out_ << line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n" << std::flush;
}

}  // namespace spoonbill
