#include "app/edit/editor.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "app/assets_folder.h"
#include "app/files/content_hash.h"
#include "app/files/documents.h"
#include "app/files/state_folder.h"
#include "app/live/journal.h"
#include "app/panel/panel.h"
#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "haptic/safe_device.h"
#include "render/gl/context.h"
#include "render/image.h"
#include "render/overlay/overlays.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::microseconds frame_time{16667};

std::filesystem::path find_model(const EditSettings& settings) {
  if (!settings.model.empty()) return settings.model;
  return std::filesystem::path(assets_folder) / "models" / "spoon-handle.json";
}

// Reads the materials that come with the program, sorted by name; skips unreadable ones.
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

// Returns a position above the body where the tool does not touch it.
Vector3 rest_position(const Body& body) {
  const Box box = find_bounds(body);
  Vector3 position = box.centre();
  position.y() = box.high.y() + 0.25 * box.size();
  return position;
}

constexpr double drag_growth_per_px = 0.01;

bool is_key_down(int key) {
  return ImGui::IsKeyDown(key);
}

// Draws a line from the tool straight down to the ground, with a cross there, so that one sees how deep in
// the picture the tool is.
void draw_plumb_line(const Snapshot& snapshot, const ViewSettings& view, int width_px, int height_px) {
  const Viewport viewport = make_viewport(width_px, height_px, view.panel_px);
  const Vector3& from_m = snapshot.tool.proxy.position_m;
  const Vector3 foot_m(from_m.x(), view.ground_y_m, from_m.z());
  constexpr double arm_m = 0.004;
  const auto colour = IM_COL32(palette::tool.r, palette::tool.g, palette::tool.b, 200);
  const auto line = [&](const Vector3& start_m, const Vector3& end_m) {
    const auto start = project(view.camera, viewport, start_m), end = project(view.camera, viewport, end_m);
    if (!start || !end) return;
    ImGui::GetBackgroundDrawList()->AddLine(
        ImVec2(static_cast<float>(start->x()), static_cast<float>(start->y())),
        ImVec2(static_cast<float>(end->x()), static_cast<float>(end->y())), colour, 1.5F);
  };
  line(from_m, foot_m);
  for (const Vector3& arm : {Vector3(arm_m, 0.0, 0.0), Vector3(0.0, 0.0, arm_m)})
    line(foot_m - arm, foot_m + arm);
}

double scale_by_drag(double value, double moved_px, Range<double> range) {
  return std::clamp(value * std::exp(drag_growth_per_px * moved_px), range.low, range.high);
}

// Returns the action of a stroke with modifier keys: Shift smooths, Ctrl inverts push and pull.
ToolAction action_for_stroke(ToolAction action, const Pointer& pointer) {
  if (pointer.shift) return ToolAction::smooth;
  return pointer.ctrl ? row_of(action).inverse : action;
}

constexpr int numbered_files_limit = 9999;

std::filesystem::path parent_folder(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

// Returns the first of NAME-0001.ENDING, NAME-0002.ENDING... that does not exist; NAME-9999.ENDING if all
// exist.
std::filesystem::path find_free_file(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& ending) {
  std::filesystem::path file;
  std::error_code ignored;
  for (int number = 1; number <= numbered_files_limit; ++number) {
    std::array<char, 16> digits{};
    std::snprintf(digits.data(), digits.size(), "-%04d", number);
    std::string file_name = name;
    file_name.append(digits.data()).append(ending);
    file = folder / file_name;
    if (!std::filesystem::exists(file, ignored)) break;
  }
  return file;
}

std::string document_stem(const std::filesystem::path& file) {
  return file.empty() ? "untitled" : file.stem().string();
}

}  // namespace

Result<std::unique_ptr<Editor>> Editor::make(const EditSettings& settings) {
  const std::filesystem::path model = find_model(settings);
  // The hash is computed before the file is read, so that a change during reading is noticed.
  const auto content = file_content_hash(settings.model);
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
  start.pose.position_m = rest_position(document->scene.bodies[0]);
  auto device = SteeredDevice::make(Hand{}, start);
  if (!device) return device.error();
  const std::shared_ptr<TargetMailbox> mailbox = device.value()->mailbox();
  auto live = LiveSession::start(document.value(), model.string(), live_settings, std::move(device).value());
  if (!live) return live.error();
  live.value()->set_known_content(content);
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
      inputs_(std::move(mailbox), start, hand_),
      budget_(std::chrono::duration<double>(frame_time).count(), settings.quality) {}

Status Editor::run() {
  try {
    return run_frames();
  } catch (const FailedAssertion& failure) {
    // The destructor of the live session autosaves the state of the last tick.
    return Error{ErrorCode::internal, std::string(failure.what()) +
                                          "; unsaved work is autosaved, and `edit` will offer to recover it"};
  }
}

Status Editor::run_frames() {
  retain_freed_memory();
  start();
  window_.window().show();
  auto last = Clock::now();
  while (!is_finished_) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (Status drawn = frame(seconds); !drawn) return drawn;
    last_frame_s_ = std::chrono::duration<double>(Clock::now() - now).count();
    budget_.add_frame(last_frame_s_);
    std::this_thread::sleep_until(now + frame_time);
  }
  const auto kept = document_.discard_changes(*live_);
  live_->stop();
  if (!kept) return kept.error();
  return {};
}

void Editor::start() {
  const LiveFrame& frame = live_->frame();
  body_bounds_ = drawn_bounds(frame.snapshot);
  hand_ = MouseHand(body_bounds_.centre());
  shown_ = view_settings(0.0);
  if (auto cap = SpaceMouse::open()) space_mouse_.emplace(std::move(cap).value());
  if (frame.snapshot.planes.empty()) {
    messages_.add({Notice::Kind::information,
                   "Nothing is fixed: P adds a fixing plane at the tool. F1 lists the keys"});
  }
  offer_recovery();
  if (settings_.recording.empty()) return;
  live_->start_recording(settings_.recording, view_);
  pending_jobs_.emplace_back(std::nullopt);
}

Status Editor::frame(double seconds) {
  if (Status started = window_.begin_frame(); !started) return started;
  const LiveFrame& frame = live_->frame();
  receive_updates(frame, seconds);
  handle_keys(frame);
  if (Status laid_out = lay_out(frame, seconds); !laid_out) return laid_out;
  handle_pointer(frame, seconds);
  if (space_mouse_) inputs_.update(*space_mouse_, seconds);
  if (screenshot_ == Screenshot::scene) {
    const auto picture = window_.end_frame_as_picture(frame.snapshot, drawn_);
    if (!picture) return picture.error();
    write_screenshot(picture.value());
    return {};
  }
  budget_.apply(drawn_);
  if (Status drawn = window_.end_frame(frame.snapshot, drawn_); !drawn) return drawn;
  if (log_) log_->add(shown_frame(frame));
  if (screenshot_ == Screenshot::window) {
    Image picture;
    window_.read_pixels(picture);
    write_screenshot(picture);
  }
  if (window_.window().should_close() && !unsaved_.is_open() && !conflict_.is_open()) {
    window_.window().set_should_close(false);
    finish_document(NextStep::quit);
  }
  return {};
}

ShownFrame Editor::shown_frame(const LiveFrame& frame) const {
  ShownFrame shown;
  shown.tick = frame.snapshot.tick;
  shown.session = frame.session;
  shown.edit_count = frame.edit_count;
  shown.recording = frame.recording;
  shown.in_stroke = frame.facts.in_stroke;
  shown.can_undo = frame.facts.can_undo;
  shown.can_redo = frame.facts.can_redo;
  shown.pressing = hand_.is_pressing();
  shown.last_frame_ms = 1e3 * last_frame_s_;
  shown.prompt = file_prompt_.is_open()    ? "file"
                 : shape_prompt_.is_open() ? "shape"
                 : is_question_open()      ? "question"
                                           : "";
  if (file_prompt_.is_open()) shown.typed = file_prompt_.typed();
  for (const Question* question : {&unsaved_, &recovery_, &conflict_}) {
    if (question->is_open()) shown.answers_px = question->button_centres_px();
  }
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  if (ImGui::IsMousePosValid(&pointer)) {
    shown.pointer_x_px = pointer.x;
    shown.pointer_y_px = pointer.y;
  }
  shown.hand_lag_m = (frame.snapshot.tool.device.position_m - hand_.target_m()).norm();
  return shown;
}

void Editor::receive_updates(const LiveFrame& frame, double seconds) {
  for (Notice& notice : live_->consume_notices()) messages_.add(std::move(notice));
  live_->consume_forces(forces_n_);
  plots_.add(forces_n_, live_->figures(), seconds);
  handle_completed_jobs(frame);
  if (frame.session != session_) {
    session_ = frame.session;
    body_bounds_ = drawn_bounds(frame.snapshot);
  }
  if (const auto saved = live_->consume_saved_document()) {
    document_.note_saved(*saved, *live_);
    // The step that waits for the save, such as quitting, is taken only if the saved document has the last
    // edit.
    if (continues_after_save_ && frame.edit_count <= saved->edit_count) start_next_step(next_step_);
  }
  if (auto conflict = live_->consume_save_conflict()) ask_about_conflict(std::move(*conflict));
}

// Jobs are completed in the order of their requests.
void Editor::handle_completed_jobs(const LiveFrame& frame) {
  for (; completed_jobs_ < frame.completed_jobs && !pending_jobs_.empty(); ++completed_jobs_) {
    const bool failed = ((frame.failed_jobs >> (completed_jobs_ % 64)) & 1U) != 0;
    const std::optional<PendingOpen> opened = pending_jobs_.front();
    pending_jobs_.erase(pending_jobs_.begin());
    if (!opened) continue;
    if (failed && opened->recovered) begin_without_recovery();
    if (failed) continue;
    view_ = opened->view;
    if (opened->recovered) {
      document_.begin_recovered(*live_);
    } else {
      report_kept(document_.switch_to(opened->file, *live_));
      live_->set_known_content(opened->content);
      offer_recovery();
    }
  }
}

Framing Editor::framing() const {
  return {body_bounds_, level_height_m(live_->last_frame().facts.ground), ground_below(body_bounds_)};
}

ViewSettings Editor::view_settings(double top_px) const {
  const int width = window_.width_px();
  const int height = window_.height_px();
  const Rectangle panel = panel_rectangle(width, height, window_.scale(), top_px);
  return make_view_settings(view_, framing(), width, height, panel, window_.scale());
}

Status Editor::lay_out(const LiveFrame& frame, double seconds) {
  screenshot_ = std::exchange(asked_screenshot_, Screenshot::none);
  const Theme& theme = window_.theme();
  ImGui::PushFont(theme.fonts.body);
  MenuState state{
      frame.facts.can_undo,    frame.facts.can_redo, frame.recording,
      frame.facts.symmetry.on, frame.facts.force_on, static_cast<int>(frame.snapshot.planes.size()),
      settings_.navigation,    view_.overlays,       view_.see_through_body};
  const MenuChoice choice = draw_menu(state);
  settings_.navigation = choice.navigation;
  for (const EditAction action : choice.actions) act(action, frame);
  set_overlays(choice);
  shown_ = view_settings(choice.height_px);
  drawn_ = shown_;
  if (screenshot_ == Screenshot::scene) {
    drawn_ =
        make_view_settings(view_, framing(), window_.width_px(), window_.height_px(), {}, window_.scale());
  }
  lay_out_labels(frame, drawn_);
  lay_out_panel(frame);
  const int width = window_.width_px();
  const int height = window_.height_px();
  const auto left = static_cast<float>(shown_.panel_px.x + shown_.panel_px.width);
  messages_.draw(theme, ImVec2(left, static_cast<float>(height)), seconds);
  plots_.draw(theme, ImVec2(static_cast<float>(width), choice.height_px),
              frame.snapshot.device.force_limit_n);
  if (shows_keys_) shows_keys_ = draw_keys(theme);
  lay_out_prompts();
  ImGui::PopFont();
  return {};
}

void Editor::lay_out_labels(const LiveFrame& frame, ViewSettings& view) {
  stage_finder_.fill(frame.snapshot, view);
  const int width = window_.width_px();
  const int height = window_.height_px();
  draw_labels(overlay_labels(frame.snapshot, view, width, height), view, width, height,
              *window_.theme().fonts.body, *ImGui::GetBackgroundDrawList());
  if (hand_.is_pressing()) draw_plumb_line(frame.snapshot, view, width, height);
}

void Editor::lay_out_panel(const LiveFrame& frame) {
  if (shown_.panel_px.width <= 0.0) return;
  PanelModel model = make_panel_model(frame.facts, frame.snapshot, shown_);
  const LoopFigures figures = live_->figures();
  model.title = document_.title(frame);
  model.presets = presets_;
  model.rate_hz = figures.rate_hz;
  model.rate_is_nominal = false;
  model.force_on = frame.facts.force_on;
  model.safety_text = safety_text(frame.safety_flags);
  model.drawing_text = budget_.text();
  model.press = press_settings_;
  PanelAnswer answer = draw_panel(model, window_.theme(), shown_.panel_px);
  if (answer.press) press_settings_ = *answer.press;
  if (!answer.refusal.empty()) messages_.add_problem(std::move(answer.refusal));
  for (Request& request : answer.requests) {
    if (const auto* change = std::get_if<ChangeView>(&request)) {
      if (Status applied = apply_view_command(change->command, "panel", view_); !applied) continue;
    }
    send(std::move(request));
  }
}

void Editor::lay_out_prompts() {
  if (const auto file = file_prompt_.draw()) {
    if (file_prompt_.purpose() == FilePurpose::open_model) {
      open(*file);
    } else if (file_prompt_.purpose() == FilePurpose::export_model) {
      export_to(*file);
    } else {
      save_as(*file);
    }
  }
  if (const auto shape = shape_prompt_.draw()) open_shape(*shape);
  if (const auto answer = unsaved_.draw()) {
    if (*answer == 0) {
      continues_after_save_ = true;
      save();
    } else if (*answer == 1) {
      start_next_step(next_step_);
    } else {
      next_step_ = NextStep::none;
    }
  }
  if (const auto answer = recovery_.draw()) {
    if (*answer == 0) {
      recover();
    } else {
      begin_without_recovery();
    }
  }
  if (const auto answer = conflict_.draw()) {
    if (*answer == 0) {
      save_as(conflict_file_, Replaced::any);
    } else if (*answer == 1) {
      file_prompt_.ask(FilePurpose::save_model, conflict_file_);
    } else {
      next_step_ = NextStep::none;
      continues_after_save_ = false;
    }
  }
}

void Editor::send(Request request) {
  if (const auto* force = std::get_if<SwitchForce>(&request); force != nullptr && !force->on) {
    return live_->cut_force();
  }
  if (live_->ask(std::move(request))) return;
  messages_.add_problem("The haptic thread is busy: try again");
}

void Editor::handle_keys(const LiveFrame& frame) {
  const std::vector<GlfwWindow::KeyPress> presses = window_.window().consume_key_presses();
  const bool is_asking = is_question_open();
  for (const GlfwWindow::KeyPress& press : presses) {
    // While text is typed, Esc is the only key that acts as a command.
    if (ImGui::GetIO().WantTextInput && press.key != GLFW_KEY_ESCAPE) continue;
    for (const KeyBinding& binding : key_bindings()) {
      const bool matches =
          binding.key == press.key && binding.ctrl == press.ctrl && binding.shift == press.shift;
      if (!matches || (is_asking && binding.action != EditAction::cut_force)) continue;
      if (binding.action == EditAction::choose_tool) {
        set_tool(frame, binding.kind, binding.tool_action);
      } else {
        act(binding.action, frame);
      }
    }
  }
}

void Editor::handle_pointer(const LiveFrame& frame, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  const Pointer pointer = read_pointer();
  const Viewport viewport = make_viewport(window_.width_px(), window_.height_px(), shown_.panel_px);
  const bool over_picture = !io.WantCaptureMouse && std::isfinite(io.MousePos.x) && io.MousePos.x >= 0.0F;
  if (is_key_down(GLFW_KEY_F) && !io.WantTextInput) return drag_setting(pointer, frame);
  const CameraMotion motion = camera_motion(settings_.navigation, pointer, hand_.on_model());
  if (over_picture && motion != CameraMotion::none && !hand_.is_pressing()) {
    return move_camera(pointer, motion, viewport);
  }
  if (over_picture && pointer.wheel != 0.0 && !hand_.is_pressing()) {
    view_.camera = zoom_camera(shown_.camera, pointer.wheel);
    view_.shows_whole_body = false;
    show_camera();
  }
  if (pointer.left && ImGui::IsMouseClicked(0)) stroke_began_here_ = over_picture;
  if (!pointer.left) stroke_began_here_ = false;
  if (over_picture || hand_.is_pressing()) stroke(pointer, frame, viewport, seconds);
}

void Editor::drag_setting(const Pointer& pointer, const LiveFrame& frame) {
  if (pointer.moved_px.x() == 0.0) return;
  if (pointer.shift) {
    press_settings_.strength_m =
        scale_by_drag(press_settings_.strength_m, pointer.moved_px.x(), press_strength_range_m);
    return;
  }
  Tool tool = frame.facts.tool;
  if (tool.kind == ToolKind::point) return;
  tool.radius_m =
      scale_by_drag(tool.radius_m, pointer.moved_px.x(), field_of(&Tool::radius_m).form.slider.range);
  send(Command(SetTool{tool}));
}

void Editor::move_camera(const Pointer& pointer, CameraMotion motion, const Viewport& viewport) {
  if (pointer.moved_px.isZero()) return;
  view_.camera = move_camera_by(shown_.camera, motion, pointer.moved_px, viewport);
  view_.shows_whole_body = false;
  show_camera();
}

void Editor::show_camera() {
  live_->set_view(view_to_json(view_));
  send(ChangeView{camera_command(view_)});
}

void Editor::stroke(const Pointer& pointer, const LiveFrame& frame, const Viewport& viewport,
                    double seconds) {
  const bool is_stroking = pointer.left && stroke_began_here_;
  Tool tool = frame.facts.tool;
  const ToolAction stroke_action = action_for_stroke(tool.action, pointer);
  if (is_stroking && !hand_.is_pressing() && stroke_action != tool.action && !before_stroke_) {
    before_stroke_ = tool;
    tool.action = stroke_action;
    send(Command(SetTool{tool}));
  }
  if (!is_stroking && before_stroke_) {
    send(Command(SetTool{*before_stroke_}));
    before_stroke_.reset();
  }
  if (!hand_.is_pressing()) pick_.update(frame.snapshot);
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  hand_.set_frame({pointer,
                   is_stroking,
                   shown_.camera,
                   viewport,
                   &pick_,
                   {radius, press_settings_.strength_m, row_of(tool.action).grips}});
  inputs_.update(hand_, seconds);
}

void Editor::act(EditAction action, const LiveFrame& frame) {
  switch (action) {
    case EditAction::show_keys:
      shows_keys_ = !shows_keys_;
      break;
    case EditAction::new_document:
      finish_document(NextStep::spoon_handle);
      break;
    case EditAction::new_shape:
      finish_document(NextStep::new_shape);
      break;
    case EditAction::open:
      finish_document(NextStep::open);
      break;
    case EditAction::quit:
      finish_document(NextStep::quit);
      break;
    case EditAction::save:
      continues_after_save_ = false;
      save();
      break;
    case EditAction::export_model:
      file_prompt_.ask(FilePurpose::export_model, default_export_file());
      break;
    case EditAction::save_as:
      continues_after_save_ = false;
      file_prompt_.ask(FilePurpose::save_model, document_.file());
      break;
    case EditAction::undo:
      send(UndoStroke{});
      break;
    case EditAction::redo:
      send(RedoStroke{});
      break;
    case EditAction::cancel:
      if (file_prompt_.is_open()) {
        file_prompt_.close();
      } else if (shape_prompt_.is_open()) {
        shape_prompt_.close();
      } else if (shows_keys_) {
        shows_keys_ = false;
      } else {
        hand_.release_press();
        send(CancelStroke{});
      }
      break;
    case EditAction::cut_force:
      send(SwitchForce{false});
      break;
    case EditAction::allow_force:
      send(SwitchForce{true});
      break;
    case EditAction::toggle_symmetry: {
      Symmetry symmetry = frame.facts.symmetry;
      symmetry.on = !symmetry.on;
      send(Command(SetSymmetry{symmetry}));
      break;
    }
    case EditAction::toggle_reach: {
      Tool tool = frame.facts.tool;
      tool.reach = tool.reach == ToolReach::local ? ToolReach::whole : ToolReach::local;
      say(tool.reach == ToolReach::local ? "Reach: local" : "Reach: whole body");
      send(Command(SetTool{tool}));
      break;
    }
    case EditAction::toggle_touch: {
      Tool tool = frame.facts.tool;
      tool.sideways = tool.sideways == ToolGlide::hold ? ToolGlide::slide : ToolGlide::hold;
      say(tool.sideways == ToolGlide::hold ? "The pressed tool holds what it touches"
                                           : "The pressed tool slides");
      send(Command(SetTool{tool}));
      break;
    }
    case EditAction::toggle_recording:
      toggle_recording(frame);
      break;
    case EditAction::screenshot:
      asked_screenshot_ = Screenshot::scene;
      break;
    case EditAction::window_screenshot:
      asked_screenshot_ = Screenshot::window;
      break;
    case EditAction::place_plane:
      place_plane(frame);
      break;
    case EditAction::remove_planes:
      send(Command(RemovePlanes{}));
      break;
    case EditAction::keep_shape:
      send(Command(KeepShape{}));
      break;
    default:
      act_on_view(action);
  }
}

void Editor::say(const char* text) {
  messages_.add({Notice::Kind::information, text});
}

void Editor::act_on_view(EditAction action) {
  Camera camera = view_.camera;
  switch (action) {
    case EditAction::view_front:
      camera = look_from(camera, StandardView::front);
      break;
    case EditAction::view_right:
      camera = look_from(camera, StandardView::right);
      break;
    case EditAction::view_top:
      camera = look_from(camera, StandardView::top);
      break;
    case EditAction::view_perspective:
      camera = look_from(camera, StandardView::perspective);
      break;
    default:
      break;
  }
  view_.camera = camera;
  view_.shows_whole_body = true;
  show_camera();
}

void Editor::set_tool(const LiveFrame& frame, ToolKind kind, ToolAction tool_action) {
  Tool tool = frame.facts.tool;
  tool.kind = kind;
  tool.action = tool_action;
  send(Command(SetTool{tool}));
}

// Adds a fixing plane at the tool, perpendicular to the longest direction of the model. The plane fixes the
// shorter part of the model.
void Editor::place_plane(const LiveFrame& frame) {
  const Vector3 size = body_bounds_.extent();
  int axis = 0;
  size.maxCoeff(&axis);
  FixingPlane plane;
  plane.point_m = frame.snapshot.tool.proxy.position_m;
  const double centre = 0.5 * (body_bounds_.low[axis] + body_bounds_.high[axis]);
  plane.normal = Vector3::Zero();
  plane.normal[axis] = plane.point_m[axis] <= centre ? 1.0 : -1.0;
  send(Command(PlacePlane{plane}));
}

void Editor::set_overlays(const MenuChoice& choice) {
  const Json before = overlays_command(view_.overlays, view_.see_through_body);
  const Json after = overlays_command(choice.overlays, choice.see_through_body);
  if (after == before) return;
  view_.overlays = choice.overlays;
  view_.see_through_body = choice.see_through_body;
  send(ChangeView{after});
}

void Editor::finish_document(NextStep step) {
  next_step_ = step;
  if (!document_.has_unsaved_changes(live_->last_frame())) return start_next_step(step);
  unsaved_.ask("Save the changes to " + document_stem(document_.file()) + "?" +
               (document_.is_recovered()
                    ? "\nWithout saving, the recovered work stays in the folder of autosaves."
                    : ""));
}

void Editor::start_next_step(NextStep step) {
  next_step_ = NextStep::none;
  continues_after_save_ = false;
  if (step == NextStep::quit) is_finished_ = true;
  if (step == NextStep::spoon_handle) open_spoon_handle();
  if (step == NextStep::new_shape) shape_prompt_.ask();
  if (step == NextStep::open) file_prompt_.ask(FilePurpose::open_model, document_.file());
}

void Editor::open(const std::filesystem::path& file) {
  const auto content = file_content_hash(file);
  auto document = read_document(file);
  if (!document) return messages_.add_problem(document.error().message);
  auto view = view_from_json(document->view, file.string());
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), file.string())) return;
  pending_jobs_.emplace_back(PendingOpen{file, view.value(), false, content});
}

void Editor::open_spoon_handle() {
  const std::filesystem::path file = std::filesystem::path(assets_folder) / "models" / "spoon-handle.json";
  auto document = read_document(file);
  if (!document) return messages_.add_problem(document.error().message);
  auto view = view_from_json(document->view, file.string());
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), file.string())) return;
  pending_jobs_.emplace_back(PendingOpen{{}, view.value()});
}

void Editor::open_shape(const StockShapeChoice& choice) {
  const auto material = shipped_material("modelling-clay");
  if (!material) return messages_.add_problem(material.error().message);
  auto document = make_stock_shape_document(choice, material.value());
  if (!document) return shape_prompt_.refuse(document.error().message);
  const auto view = view_from_json(document->view, "the new shape");
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), "the new shape")) return;
  pending_jobs_.emplace_back(PendingOpen{{}, view.value()});
}

void Editor::offer_recovery() {
  if (document_.is_open_elsewhere()) {
    messages_.add_problem(document_.file().filename().string() +
                          " is also open in another window: each window asks before it overwrites what the "
                          "other saved");
  }
  const auto found = document_.recovered_document();
  if (!found) {
    messages_.add_problem(found.error().message);
    return begin_without_recovery();
  }
  if (!found.value()) return document_.begin(*live_);
  recovery_.ask("An earlier session of " + document_stem(document_.file()) +
                " ended without saving, and its work differs from the saved file.\nBoth are kept, "
                "whichever you continue with.");
}

void Editor::begin_without_recovery() {
  const auto kept = document_.set_recovered_aside();
  // Autosaving does not begin after an error, because it would overwrite the recovered document.
  if (!kept) return messages_.add_problem(kept.error().message);
  report_kept(std::optional(kept.value()));
  document_.begin(*live_);
}

void Editor::report_kept(const Result<std::optional<std::filesystem::path>>& kept) {
  if (!kept) return messages_.add_problem(kept.error().message);
  if (kept.value())
    messages_.add({Notice::Kind::information, "the unsaved work is kept as " + kept.value()->string()});
}

void Editor::recover() {
  auto found = document_.recovered_document();
  if (!found || !found.value()) return begin_without_recovery();
  auto view = view_from_json(found.value()->view, "the recovered document");
  if (!view || !live_->open(std::move(*found.value()), "the recovered document")) {
    return begin_without_recovery();
  }
  pending_jobs_.emplace_back(PendingOpen{document_.file(), view.value(), true});
}

void Editor::save() {
  if (document_.file().empty()) return file_prompt_.ask(FilePurpose::save_model, "untitled.json");
  save_as(document_.file());
}

bool Editor::is_question_open() const {
  return unsaved_.is_open() || recovery_.is_open() || conflict_.is_open();
}

void Editor::ask_about_conflict(std::filesystem::path file) {
  conflict_file_ = std::move(file);
  conflict_.ask(conflict_file_.filename().string() +
                " holds something that this window neither read nor saved.\nReplace it? A copy stays as " +
                conflict_file_.filename().string() + ".bak.");
}

void Editor::save_as(const std::filesystem::path& file, Replaced replaced) {
  live_->set_view(view_to_json(view_));
  live_->save(file, replaced);
  send(MarkFile{FileMarkKind::document, make_mark_name(document_stem(file))});
}

// Returns a STEP file beside the document as the suggested name; the user may type another extension.
std::filesystem::path Editor::default_export_file() const {
  return parent_folder(document_.file()) / (document_stem(document_.file()) + ".step");
}

void Editor::export_to(const std::filesystem::path& file) {
  if (!Exporter::has_export_extension(file)) {
    return messages_.add_problem("not exported: the file name must end in " +
                                 std::string(Exporter::extensions_text()));
  }
  live_->save(file);
}

void Editor::toggle_recording(const LiveFrame& frame) {
  if (frame.recording) {
    live_->stop_recording();
    return;
  }
  const bool is_requested =
      std::any_of(pending_jobs_.begin(), pending_jobs_.end(), [](const auto& job) { return !job; });
  if (is_requested) return;
  const std::filesystem::path file =
      find_free_file(parent_folder(document_.file()), document_stem(document_.file()), ".recording.jsonl");
  if (!live_->start_recording(file, view_)) return;
  pending_jobs_.emplace_back(std::nullopt);
  messages_.add({Notice::Kind::information, "recording to " + file.filename().string()});
}

void Editor::write_screenshot(const Image& picture) {
  const std::filesystem::path file =
      find_free_file(parent_folder(document_.file()), document_stem(document_.file()), ".png");
  if (Status written = write_png(file, picture, {NamedBy::program}); !written) {
    return messages_.add_problem(written.error().message);
  }
  messages_.add({Notice::Kind::information, "wrote " + file.filename().string()});
  send(MarkFile{FileMarkKind::picture, make_mark_name(file.stem().string())});
}

}  // namespace spoonbill
