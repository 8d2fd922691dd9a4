#include "app/edit/editor.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "app/assets_folder.h"
#include "app/files/state_folder.h"
#include "app/panel/panel.h"
#include "app/panel/session_panel.h"
#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "haptic/safe_device.h"
#include "render/gl/context.h"
#include "render/overlay/overlays.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::microseconds frame_time{16667};

std::filesystem::path model_of(const EditSettings& settings) {
  if (!settings.model.empty()) return settings.model;
  return std::filesystem::path(assets_folder) / "models" / "spoon-handle.json";
}

// All that can be read of the materials that come with the program, by name.
std::vector<Material> read_presets() {
  std::vector<Material> presets;
  std::error_code problem;
  const auto folder = std::filesystem::path(assets_folder) / "materials";
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    auto material = read_material(entry.path());
    if (material) presets.push_back(std::move(material).value());
  }
  std::sort(presets.begin(), presets.end(),
            [](const Material& a, const Material& b) { return a.name < b.name; });
  return presets;
}

// Above the model, where it touches nothing.
Vector3 resting_place(const Surface& surface) {
  const Box box = bounding_box(surface.net);
  Vector3 place = box.centre();
  place.y() = box.high.y() + 0.25 * box.size();
  return place;
}

}  // namespace

Result<std::unique_ptr<Editor>> Editor::make(const EditSettings& settings) {
  const std::filesystem::path model = model_of(settings);
  const auto document = read_document(model);
  if (!document) return document.error();
  auto view = view_from_json(document->view, model.string());
  if (!view) return view.error();
  auto window = EditWindow::make(settings.width, settings.height, settings.scale);
  if (!window) return window.error();
  LiveSettings live_settings;
  live_settings.instruction_set = settings.instruction_set;
  live_settings.real_time = settings.real_time;
  HandTarget start;
  start.pose.position_m = resting_place(document->scene.bodies[0].surface);
  auto device = SteeredDevice::make(Hand{}, start);
  if (!device) return device.error();
  const std::shared_ptr<TargetMailbox> mailbox = device.value()->mailbox();
  auto live = LiveSession::start(document.value(), model.string(), live_settings, std::move(device).value());
  if (!live) return live.error();
  auto state = state_folder();
  std::optional<std::filesystem::path> folder;
  if (state) folder = state.value();
  std::unique_ptr<Editor> editor(new Editor(settings, std::move(window).value(), std::move(live).value(),
                                            mailbox, start, view.value(),
                                            EditedDocument(folder, settings.model)));
  if (!state) editor->messages_.add_problem(state.error().message);
  if (!settings.log.empty()) {
    auto log = FrameLog::open(settings.log);
    if (!log) return log.error();
    editor->log_ = std::move(log).value();
  }
  return editor;
}

Editor::Editor(const EditSettings& settings, EditWindow window, std::unique_ptr<LiveSession> live,
               std::shared_ptr<TargetMailbox> mailbox, const HandTarget& start, ViewChoice view,
               EditedDocument document)
    : settings_(settings),
      window_(std::move(window)),
      live_(std::move(live)),
      view_(std::move(view)),
      document_(std::move(document)),
      presets_(read_presets()),
      hand_(Vector3::Zero()),
      inputs_(std::move(mailbox), start, hand_) {}

Status Editor::run() {
  try {
    return run_frames();
  } catch (const FailedAssertion& failure) {
    // The live session ends with the editor and autosaves what the last tick left.
    return Error{std::string(failure.what()) + "; unsaved work is autosaved, and `edit` offers it again"};
  }
}

Status Editor::run_frames() {
  retain_freed_memory();
  start();
  window_.window().show();
  auto last = Clock::now();
  while (!left_) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (Status drawn = frame(seconds); !drawn) return drawn;
    budget_.add_frame(std::chrono::duration<double>(Clock::now() - now).count());
    std::this_thread::sleep_until(now + frame_time);
  }
  live_->set_autosave(std::nullopt);
  live_->stop();
  return {};
}

void Editor::start() {
  const LiveFrame& frame = live_->frame();
  body_ = drawn_bounds(frame.snapshot);
  hand_ = MouseHand(body_.centre());
  shown_ = view_settings(0.0);
  if (auto cap = SpaceMouse::open()) space_mouse_.emplace(std::move(cap).value());
  if (frame.snapshot.planes.empty()) {
    messages_.add(
        {Notice::Kind::information, "Nothing is held: P fixes the model behind the tool. F1 shows the keys"});
  }
  look_for_left_over();
  if (settings_.recording.empty()) return;
  live_->start_recording(settings_.recording, view_);
  asked_.emplace_back(std::nullopt);
}

Status Editor::frame(double seconds) {
  if (Status begun = window_.begin_frame(); !begun) return begun;
  const LiveFrame& frame = live_->frame();
  take_news(frame, seconds);
  take_keys(frame);
  if (Status laid = lay_out(frame, seconds); !laid) return laid;
  take_pointer(frame, seconds);
  if (space_mouse_) inputs_.update(*space_mouse_, seconds);
  budget_.apply(shown_);
  if (Status drawn = window_.end_frame(frame.snapshot, shown_); !drawn) return drawn;
  if (log_) log_->add(shown_frame(frame));
  if (screenshot_due_) write_screenshot();
  if (window_.window().should_close() && !unsaved_.asking()) {
    window_.window().set_should_close(false);
    leave(Leave::quit);
  }
  return {};
}

ShownFrame Editor::shown_frame(const LiveFrame& frame) const {
  ShownFrame shown;
  shown.tick = frame.snapshot.tick;
  shown.session = frame.session;
  shown.deed = frame.deed;
  shown.recording = frame.recording;
  shown.in_stroke = frame.facts.in_stroke;
  shown.can_undo = frame.facts.can_undo;
  shown.can_redo = frame.facts.can_redo;
  shown.pressing = hand_.pressing();
  shown.prompt = files_.asking()                            ? "file"
                 : lumps_.asking()                          ? "lump"
                 : unsaved_.asking() || left_over_.asking() ? "question"
                                                            : "";
  if (files_.asking()) shown.typed = files_.typed();
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  if (ImGui::IsMousePosValid(&pointer)) {
    shown.pointer_x_px = pointer.x;
    shown.pointer_y_px = pointer.y;
  }
  shown.hand_lag_m = (frame.snapshot.tool.device.position_m - hand_.target_m()).norm();
  return shown;
}

void Editor::take_news(const LiveFrame& frame, double seconds) {
  for (Notice& notice : live_->take_notices()) messages_.add(std::move(notice));
  live_->take_forces(forces_n_);
  plots_.add(forces_n_, live_->figures(), seconds);
  take_answers(frame);
  if (frame.session != session_) {
    session_ = frame.session;
    body_ = drawn_bounds(frame.snapshot);
  }
  if (const auto saved = live_->take_saved()) {
    document_.note_saved(*saved, *live_);
    // An earlier save's answer is not the one that is waited for.
    if (leave_when_saved_ && frame.deed <= saved->deed) leave_now(leaving_);
  }
}

// Work is answered in the order in which it was asked for.
void Editor::take_answers(const LiveFrame& frame) {
  for (; works_ < frame.works && !asked_.empty(); ++works_) {
    const bool failed = ((frame.failed_works >> (works_ % 64)) & 1U) != 0;
    const std::optional<AskedOpen> asked = asked_.front();
    asked_.erase(asked_.begin());
    if (!asked) continue;
    if (failed && asked->recovered) begin_without_left_over();
    if (failed) continue;
    view_ = asked->view;
    if (asked->recovered) {
      document_.begin_recovered(*live_);
    } else {
      document_.turn_to(asked->file, *live_);
      look_for_left_over();
    }
  }
}

ViewSettings Editor::view_settings(double top_px) const {
  const int width = window_.width_px();
  const int height = window_.height_px();
  const Rectangle panel = panel_rectangle(width, height, window_.scale(), top_px);
  return settings_for(view_, body_, width, height, panel, window_.scale());
}

Status Editor::lay_out(const LiveFrame& frame, double seconds) {
  const Theme& theme = window_.theme();
  ImGui::PushFont(theme.fonts.body);
  MenuState state{frame.facts.can_undo,
                  frame.facts.can_redo,
                  frame.recording,
                  frame.facts.symmetry.on,
                  static_cast<int>(frame.snapshot.planes.size()),
                  settings_.navigation,
                  view_.overlays,
                  view_.see_through_body};
  const MenuChoice choice = draw_menu(state);
  settings_.navigation = choice.navigation;
  for (const EditAction action : choice.actions) act(action, frame);
  set_overlays(choice);
  shown_ = view_settings(choice.height_px);
  stages_.fill(frame.snapshot, shown_);
  const int width = window_.width_px();
  const int height = window_.height_px();
  draw_labels(overlay_labels(frame.snapshot, shown_, width, height), shown_, width, height, *theme.fonts.body,
              *ImGui::GetBackgroundDrawList());
  lay_out_panel(frame);
  const auto left = static_cast<float>(shown_.panel_px.x + shown_.panel_px.width);
  messages_.draw(theme, ImVec2(left, static_cast<float>(height)), seconds);
  plots_.draw(theme, ImVec2(static_cast<float>(width), choice.height_px),
              frame.snapshot.device.force_limit_n);
  if (keys_shown_) keys_shown_ = draw_keys(theme);
  lay_out_questions();
  ImGui::PopFont();
  return {};
}

void Editor::lay_out_panel(const LiveFrame& frame) {
  if (shown_.panel_px.width <= 0.0) return;
  PanelModel model = panel_of(frame.facts, frame.snapshot, shown_);
  const LoopFigures figures = live_->figures();
  model.title = document_.title(frame);
  model.presets = presets_;
  model.rate_hz = figures.rate_hz;
  model.rate_is_nominal = false;
  model.safety_text = safety_text(frame.safety_flags);
  model.drawing_text = budget_.text();
  PanelAnswer answer = draw_panel(model, window_.theme(), shown_.panel_px);
  if (!answer.refusal.empty()) messages_.add_problem(std::move(answer.refusal));
  for (Request& request : answer.requests) {
    if (const auto* change = std::get_if<ChangeView>(&request)) {
      if (Status seen = apply_view_command(change->command, "panel", view_); !seen) continue;
    }
    ask(std::move(request));
  }
}

void Editor::lay_out_questions() {
  if (const auto file = files_.draw()) {
    if (files_.purpose() == FilePurpose::open_model) {
      open(*file);
    } else if (files_.purpose() == FilePurpose::export_model) {
      export_to(*file);
    } else {
      save_as(*file);
    }
  }
  if (const auto lump = lumps_.draw()) open_lump(*lump);
  if (const auto answer = unsaved_.draw()) {
    if (*answer == 0) {
      leave_when_saved_ = true;
      save();
    } else if (*answer == 1) {
      leave_now(leaving_);
    } else {
      leaving_ = Leave::none;
    }
  }
  if (const auto answer = left_over_.draw()) {
    if (*answer == 0) {
      recover();
    } else {
      document_.discard_left_over();
      document_.begin(*live_);
    }
  }
}

void Editor::ask(Request request) {
  if (live_->ask(std::move(request))) return;
  messages_.add_problem("The haptic thread is busy: ask again");
}

}  // namespace spoonbill
