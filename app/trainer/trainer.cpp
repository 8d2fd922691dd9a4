#include "app/trainer/trainer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <utility>

#include "app/frames/session_frames.h"
#include "app/panel/task_rows.h"
#include "app/report/quantity_text.h"
#include "app/session/task_goal.h"
#include "haptic/safe_device.h"
#include "render/gl/context.h"
#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

using FrameClock = std::chrono::steady_clock;

constexpr std::chrono::microseconds training_frame_time{16667};
constexpr double workspace_radius_m = 0.4;
constexpr double keyed_turn_rad = 2.0 * std::numbers::pi / 180.0;
constexpr double keyed_depth_m = 0.002;
constexpr double finger_depth_m = 0.006;  // of a press without the wheel

struct TrainingKey {
  const char* chord;
  const char* text;
};

constexpr auto spoon_keys = std::to_array<TrainingKey>({
    {"Mouse", "Moves the spoon, forward, back, up and down"},
    {"Wheel, Up, Down", "Lift or lower the front of the spoon"},
    {"Shift+wheel, Left, Right", "Turn the spoon about its handle"},
    {"Alt+wheel, Page Up, Page Down", "Move the spoon away or toward you"},
});
constexpr auto finger_keys = std::to_array<TrainingKey>({
    {"Mouse", "Moves the finger over the skin"},
    {"Left button", "Press; the wheel presses deeper, a drag moves the pressed finger"},
    {"M", "Mark the place of the lump while you press"},
});
constexpr auto common_keys = std::to_array<TrainingKey>({
    {"Enter", "Begin, or try again"},
    {"Esc", "Give up the attempt"},
    {"G", "Guidance on or off, from the next attempt"},
    {"Right button", "Orbit; with Shift pan"},
    {"Space", "Force off at once; with Shift on"},
    {"F1", "These keys"},
    {"Ctrl+Q", "Quit"},
});

DeviceSpecification find_training_device() {
  DeviceSpecification device = VirtualDevice::default_specification();
  device.workspace_radius_m = workspace_radius_m;
  return device;
}

const char* name_of_end(TaskEnd end) {
  return task_end_names[static_cast<std::size_t>(end)];
}

std::string describe_end(const Task& task, const TaskResult& result) {
  const std::string score = decimals_text(result.score(task), 0) + " of 100";
  switch (result.end) {
    case TaskEnd::success:
      return "Done: " + score;
    case TaskEnd::lost:
      return task.has_spoon() ? "Food was lost" : "That was not the lump";
    default:
      return "Out of time";
  }
}

}  // namespace

Result<std::unique_ptr<Trainer>> Trainer::make(const TrainerSettings& settings) {
  // Wrong files are reported before a window opens.
  auto setting = read_training_setting(settings.choice);
  if (!setting) return setting.error();
  auto window = EditWindow::make(settings.width, settings.height, std::nullopt);
  if (!window) return window.error();
  std::unique_ptr<Trainer> trainer(new Trainer(settings, std::move(window).value()));
  if (!settings.log.empty()) {
    auto log = FrameLog::open(settings.log);
    if (!log) return log.error();
    trainer->log_ = std::move(log).value();
  }
  return trainer;
}

Trainer::Trainer(TrainerSettings settings, EditWindow window)
    : settings_(std::move(settings)),
      window_(std::move(window)),
      budget_(std::chrono::duration<double>(training_frame_time).count()) {}

Trainer::~Trainer() {
  if (preparing_.valid()) preparing_.wait();
}

Status Trainer::run() {
  retain_freed_memory();
  if (auto cap = SpaceMouse::open()) space_mouse_.emplace(std::move(cap).value());
  prepare();
  window_.window().show();
  auto last = FrameClock::now();
  while (!is_finished_) {
    const auto now = FrameClock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    if (Status drawn = frame(seconds); !drawn) return drawn;
    last_frame_s_ = std::chrono::duration<double>(FrameClock::now() - now).count();
    budget_.add_frame(last_frame_s_);
    std::this_thread::sleep_until(now + training_frame_time);
  }
  give_up();
  return {};
}

// Prepares the next attempt on another thread, because laying the food takes seconds.
void Trainer::prepare() {
  stage_ = Stage::preparing;
  live_.reset();  // before the next session needs memory
  TrainingChoice choice = settings_.choice;
  choice.seed += static_cast<std::uint32_t>(attempt_count_);
  if (settings_.choose_guidance) choice.guidance = settings_.choose_guidance();
  if (!guides_) choice.guidance = 0.0;
  preparing_ =
      std::async(std::launch::async, [choice, set = settings_.instruction_set]() -> Result<Prepared> {
        auto setting = read_training_setting(choice);
        if (!setting) return setting.error();
        auto session =
            make_training_session(setting.value(), choice.task.string(), find_training_device(), set);
        if (!session) return session.error();
        return Prepared{std::move(setting).value(), std::make_unique<Session>(std::move(session).value())};
      });
}

Status Trainer::adopt_prepared() {
  auto prepared = preparing_.get();
  if (!prepared) return prepared.error();
  const bool is_first = !setting_;
  setting_ = std::move(prepared->setting);
  session_ = std::move(prepared->session);
  write_snapshot(*session_, shown_.snapshot);
  write_facts(*session_, shown_.facts);
  // The tool is at the origin before the first tick.
  if (!has_spoon()) shown_.snapshot.tool.proxy.position_m = setting_->scene.start_m;
  framing_ = find_task_framing(setting_->task, *session_);
  if (is_first) view_ = session_->view;
  view_.goal = session_->view.goal;
  stage_ = Stage::ready;
  return {};
}

Status Trainer::begin_attempt() {
  HandTarget start;
  start.pose.position_m = setting_->scene.start_m;
  start.buttons = has_spoon() ? 0u : button_hover;
  auto device = SteeredDevice::make(Hand{}, start);
  if (!device) return device.error();
  std::unique_ptr<RecordingWriter> recording;
  if (!settings_.recording.empty()) {
    const RecordingHeader header{session_->device, setting_->document(), setting_->identity};
    auto created = RecordingWriter::create(settings_.recording, header, settings_.output);
    if (!created) return created.error();
    recording = std::make_unique<RecordingWriter>(std::move(created).value());
  }
  finger_mouse_ = FingerMouse(start.pose.position_m);
  InputSource& mouse = has_spoon() ? static_cast<InputSource&>(spoon_mouse_) : finger_mouse_;
  inputs_.emplace(device.value()->mailbox(), start, mouse);
  LiveSettings live_settings;
  live_settings.instruction_set = settings_.instruction_set;
  auto live =
      LiveSession::start(std::move(session_), live_settings, std::move(device).value(), std::move(recording));
  if (!live) return live.error();
  live_ = std::move(live).value();
  stage_ = Stage::running;
  return {};
}

void Trainer::end_attempt() {
  live_->stop();
  finger_mouse_ = FingerMouse(Vector3::Zero());
  ++attempt_count_;
  stage_ = Stage::ended;
  const Session* const session = live_->session();
  if (session == nullptr) return messages_.add_problem("the attempt was interrupted; it is not logged");
  last_attempt_ = TrainedAttempt{*setting_, session->watch->result(), state_hash(*session)};
  write_snapshot(*session, shown_.snapshot);
  write_facts(*session, shown_.facts);
  view_.goal =
      std::make_shared<const GoalMarks>(make_goal(setting_->task, setting_->scene, *shown_.facts.training));
  if (!settings_.log_attempt) return;
  if (Status logged = settings_.log_attempt(*last_attempt_); !logged) {
    messages_.add_problem(logged.error().message);
  }
}

void Trainer::give_up() {
  if (stage_ != Stage::running) return;
  live_->leave_recording_unpublished();
  live_->stop();
  finger_mouse_ = FingerMouse(Vector3::Zero());
  stage_ = Stage::ended;
  last_attempt_.reset();
}

Status Trainer::frame(double seconds) {
  if (Status started = window_.begin_frame(); !started) return started;
  constexpr std::chrono::seconds at_once{0};
  if (stage_ == Stage::preparing && preparing_.wait_for(at_once) == std::future_status::ready) {
    if (Status adopted = adopt_prepared(); !adopted) return adopted;
  }
  handle_keys();
  if (stage_ == Stage::running) follow_attempt(seconds);
  if (Status laid_out = lay_out(seconds); !laid_out) return laid_out;
  move_hand(seconds);
  ViewSettings view = find_view();
  budget_.apply(view);
  if (Status drawn = window_.end_frame(shown_.snapshot, view); !drawn) return drawn;
  if (log_) log_->add(shown_frame());
  if (window_.window().should_close()) is_finished_ = true;
  return {};
}

ShownFrame Trainer::shown_frame() const {
  constexpr std::array<const char*, 4> stage_names = {"preparing", "ready", "running", "ended"};
  ShownFrame shown;
  shown.tick = shown_.snapshot.tick;
  shown.recording = shown_.recording;
  shown.last_frame_ms = 1e3 * last_frame_s_;
  shown.pressing = finger_mouse_.is_pressing();
  if (live_) shown.missed = live_->figures().missed;
  shown.stage = stage_names[static_cast<std::size_t>(stage_)];
  if (const auto& training = shown_.facts.training) {
    shown.end = name_of_end(training->progress.end);
    shown.wanted_m = training->wanted.position_m;
  }
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  if (ImGui::IsMousePosValid(&pointer)) {
    shown.pointer_x_px = pointer.x;
    shown.pointer_y_px = pointer.y;
  }
  return shown;
}

void Trainer::handle_keys() {
  keyed_ = {};
  for (const GlfwWindow::KeyPress& press : window_.window().consume_key_presses()) {
    handle_key(press.key, press.ctrl, press.shift);
  }
}

void Trainer::handle_key(int key, bool ctrl, bool shift) {
  switch (key) {
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      shows_keys_ = false;
      if (stage_ == Stage::ended) prepare();
      if (stage_ != Stage::ready) break;
      if (Status begun = begin_attempt(); !begun) {
        messages_.add_problem(begun.error().message);
        prepare();
      }
      break;
    case GLFW_KEY_ESCAPE:
      if (shows_keys_) {
        shows_keys_ = false;
      } else {
        give_up();
      }
      break;
    case GLFW_KEY_SPACE:
      if (!live_ || stage_ != Stage::running) break;
      if (!shift) {
        live_->cut_force();
      } else if (!live_->ask(SwitchForce{true})) {
        messages_.add_problem("The haptic thread is busy: try again");
      }
      break;
    case GLFW_KEY_G:
      guides_ = !guides_;
      messages_.add({Notice::Kind::information, guides_ ? "Guidance is on from the next attempt"
                                                        : "Guidance is off from the next attempt"});
      break;
    case GLFW_KEY_F1:
      shows_keys_ = !shows_keys_;
      break;
    case GLFW_KEY_Q:
      is_finished_ |= ctrl;
      break;
    case GLFW_KEY_UP:
      keyed_.keyed_pitch_rad += keyed_turn_rad;
      break;
    case GLFW_KEY_DOWN:
      keyed_.keyed_pitch_rad -= keyed_turn_rad;
      break;
    case GLFW_KEY_RIGHT:
      keyed_.keyed_roll_rad += keyed_turn_rad;
      break;
    case GLFW_KEY_LEFT:
      keyed_.keyed_roll_rad -= keyed_turn_rad;
      break;
    case GLFW_KEY_PAGE_DOWN:
      keyed_.keyed_depth_m += keyed_depth_m;
      break;
    case GLFW_KEY_PAGE_UP:
      keyed_.keyed_depth_m -= keyed_depth_m;
      break;
    default:
      break;
  }
}

// Receives the newest state of the attempt, and ends it when the task has ended.
void Trainer::follow_attempt(double seconds) {
  for (Notice& notice : live_->consume_notices()) messages_.add(std::move(notice));
  live_->consume_forces(forces_n_);
  plots_.add(forces_n_, live_->figures(), seconds);
  shown_ = live_->frame();
  if (shown_.facts.training && shown_.facts.training->progress.end != TaskEnd::under_way) {
    return end_attempt();
  }
  GoalMarks goal = make_goal(setting_->task, setting_->scene, *shown_.facts.training);
  add_wanted_pose(setting_->scene, *shown_.facts.training, goal);
  view_.goal = std::make_shared<const GoalMarks>(std::move(goal));
}

void Trainer::move_hand(double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  Pointer pointer = read_pointer();
  pointer.wheel += io.MouseWheelH;  // some systems turn the wheel with Shift sideways
  const bool is_over_picture = !io.WantCaptureMouse && std::isfinite(io.MousePos.x) && io.MousePos.x >= 0.0F;
  const ViewSettings view = find_view();
  const Viewport viewport = make_viewport(window_.width_px(), window_.height_px(), view.panel_px);
  const CameraMotion motion = camera_motion(NavigationPreset::rhino, pointer, false);
  if (is_over_picture && motion != CameraMotion::none) {
    view_.camera = move_camera_by(view.camera, motion, pointer.moved_px, viewport);
    view_.shows_whole_body = false;
    return;
  }
  if (stage_ != Stage::running) return;
  if (has_spoon()) {
    move_spoon(pointer, is_over_picture, seconds);
  } else {
    move_finger(pointer, is_over_picture, seconds);
  }
  if (space_mouse_) inputs_->update(*space_mouse_, seconds);
}

void Trainer::move_spoon(const Pointer& pointer, bool is_over_picture, double seconds) {
  const ViewSettings view = find_view();
  SpoonInput input = keyed_;
  input.pointer = pointer;
  input.is_over_picture = is_over_picture;
  input.camera = view.camera;
  input.viewport = make_viewport(window_.width_px(), window_.height_px(), view.panel_px);
  spoon_mouse_.set_input(input);
  inputs_->update(spoon_mouse_, seconds);
}

void Trainer::move_finger(const Pointer& pointer, bool is_over_picture, double seconds) {
  if (pointer.left && ImGui::IsMouseClicked(0)) press_began_here_ = is_over_picture;
  if (!pointer.left) press_began_here_ = false;
  if (!finger_mouse_.is_pressing()) pick_.update(shown_.snapshot);
  const ViewSettings view = find_view();
  const MouseStroke stroke{setting_->task.lump.tool_radius_m, finger_depth_m, false};
  const bool is_marking = ImGui::IsKeyDown(GLFW_KEY_M);
  finger_mouse_.set_frame(
      {pointer, pointer.left && press_began_here_, view.camera,
       make_viewport(window_.width_px(), window_.height_px(), view.panel_px), &pick_, stroke},
      is_marking);
  inputs_->update(finger_mouse_, seconds);
}

ViewSettings Trainer::find_view() const {
  const int width = window_.width_px(), height = window_.height_px();
  const Rectangle panel = panel_rectangle(width, height, window_.scale());
  return make_view_settings(view_, framing_, width, height, panel, window_.scale());
}

Status Trainer::lay_out(double seconds) {
  const Theme& theme = window_.theme();
  const ViewSettings view = find_view();
  const int width = window_.width_px(), height = window_.height_px();
  ImGui::PushFont(theme.fonts.body);
  draw_labels(overlay_labels(shown_.snapshot, view, width, height), view, width, height, *theme.fonts.body,
              *ImGui::GetBackgroundDrawList());
  if (setting_ && view.panel_px.width > 0.0) {
    PanelModel model = make_panel_model(shown_.facts, shown_.snapshot, view);
    model.time_s = shown_.facts.training->progress.time_s;
    model.task = make_task_rows(setting_->task, setting_->hand, *shown_.facts.training);
    if (live_) {
      model.rate_hz = live_->figures().rate_hz;
      model.rate_is_nominal = false;
      model.safety_text = safety_text(shown_.safety_flags);
    }
    draw_panel(model, theme, view.panel_px);
  }
  if (live_) {
    plots_.draw(theme, ImVec2(static_cast<float>(width), 0.0F), shown_.snapshot.device.force_limit_n);
  }
  messages_.draw(
      theme, ImVec2(static_cast<float>(view.panel_px.x + view.panel_px.width), static_cast<float>(height)),
      seconds);
  draw_banner();
  if (shows_keys_) draw_key_list();
  ImGui::PopFont();
  return {};
}

void Trainer::draw_banner() const {
  std::string text;
  if (stage_ == Stage::preparing) text = has_spoon() ? "Laying the food ..." : "Hiding the lump ...";
  if (stage_ == Stage::ready) text = "Press Enter to begin";
  if (stage_ == Stage::ended) {
    text = last_attempt_ ? describe_end(setting_->task, last_attempt_->result) : "Given up";
    text += ". Enter: try again";
  }
  if (text.empty()) return;
  const Theme& theme = window_.theme();
  const float left = theme.metrics.panel_width_px;
  const ImVec2 top(0.5F * (left + static_cast<float>(window_.width_px())), 2.0F * theme.metrics.padding_px);
  ImGui::SetNextWindowPos(top, ImGuiCond_Always, ImVec2(0.5F, 0.0F));
  ImGui::Begin("Banner", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushFont(theme.fonts.heading);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopFont();
  ImGui::End();
}

void Trainer::draw_key_list() {
  const Theme& theme = window_.theme();
  const ImVec2 corner(theme.metrics.panel_width_px + theme.metrics.padding_px,
                      4.0F * theme.metrics.padding_px + theme.metrics.heading_px);
  ImGui::SetNextWindowPos(corner, ImGuiCond_Always);
  ImGui::Begin("Keys", &shows_keys_,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    const auto row = [](const TrainingKey& key) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextColored(colour::accent, "%s", key.chord);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(key.text);
    };
    if (has_spoon()) {
      for (const TrainingKey& key : spoon_keys) row(key);
    } else {
      for (const TrainingKey& key : finger_keys) row(key);
    }
    for (const TrainingKey& key : common_keys) row(key);
    ImGui::EndTable();
  }
  ImGui::End();
}

}  // namespace spoonbill
