#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/edit/editor.h"

namespace spoonbill {
namespace {

constexpr Range<double> strength_range_m{0.0002, 0.02};
constexpr double drag_growth_per_px = 0.01;

bool is_held(int key) {
  return ImGui::IsKeyDown(key);
}

double dragged(double value, double moved_px, Range<double> range) {
  return std::clamp(value * std::exp(drag_growth_per_px * moved_px), range.low, range.high);
}

// What a stroke does that begins with these keys held: Shift smooths, Ctrl inverts push and pull.
ToolAction action_for_stroke(ToolAction action, const Pointer& pointer) {
  if (pointer.shift) return ToolAction::smooth;
  return pointer.ctrl ? row_of(action).inverse : action;
}

}  // namespace

Pointer Editor::read_pointer() const {
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
  return pointer;
}

void Editor::take_keys(const LiveFrame& frame) {
  const std::vector<GlfwWindow::KeyPress> presses = window_.window().consume_key_presses();
  if (unsaved_.asking() || left_over_.asking()) return;
  for (const GlfwWindow::KeyPress& press : presses) {
    // While a name is typed only Esc is a command.
    if (ImGui::GetIO().WantTextInput && press.key != GLFW_KEY_ESCAPE) continue;
    for (const KeyBinding& binding : key_bindings()) {
      const bool meant =
          binding.key == press.key && binding.ctrl == press.ctrl && binding.shift == press.shift;
      if (!meant) continue;
      if (binding.action == EditAction::choose_tool) {
        set_tool(frame, binding.kind, binding.tool_action);
      } else {
        act(binding.action, frame);
      }
    }
  }
}

void Editor::take_pointer(const LiveFrame& frame, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  const Pointer pointer = read_pointer();
  const Viewport viewport = make_viewport(window_.width_px(), window_.height_px(), shown_.panel_px);
  const bool over_picture = !io.WantCaptureMouse && std::isfinite(io.MousePos.x) && io.MousePos.x >= 0.0F;
  if (is_held(GLFW_KEY_F) && !io.WantTextInput) return drag_setting(pointer, frame);
  const CameraMotion motion = camera_motion(settings_.navigation, pointer, hand_.on_model());
  if (over_picture && motion != CameraMotion::none && !hand_.pressing()) {
    return move_camera(pointer, motion, viewport);
  }
  if (over_picture && pointer.wheel != 0.0 && !hand_.pressing()) {
    view_.camera = zoomed(shown_.camera, pointer.wheel);
    view_.shows_whole_body = false;
    show_camera();
  }
  if (pointer.left && ImGui::IsMouseClicked(0)) stroke_began_here_ = over_picture;
  if (!pointer.left) stroke_began_here_ = false;
  if (over_picture || hand_.pressing()) stroke(pointer, frame, viewport, seconds);
}

void Editor::drag_setting(const Pointer& pointer, const LiveFrame& frame) {
  if (pointer.moved_px.x() == 0.0) return;
  if (pointer.shift) {
    strength_m_ = dragged(strength_m_, pointer.moved_px.x(), strength_range_m);
    return;
  }
  Tool tool = frame.facts.tool;
  if (tool.kind == ToolKind::point) return;
  tool.radius_m = dragged(tool.radius_m, pointer.moved_px.x(), field_of(&Tool::radius_m).form.slider.range);
  ask(Command(SetTool{tool}));
}

void Editor::move_camera(const Pointer& pointer, CameraMotion motion, const Viewport& viewport) {
  if (pointer.moved_px.isZero()) return;
  view_.camera = moved(shown_.camera, motion, pointer.moved_px, viewport);
  view_.shows_whole_body = false;
  show_camera();
}

void Editor::show_camera() {
  live_->set_view(view_to_json(view_));
  ask(ChangeView{camera_command(view_)});
}

void Editor::stroke(const Pointer& pointer, const LiveFrame& frame, const Viewport& viewport,
                    double seconds) {
  const bool held = pointer.left && stroke_began_here_;
  Tool tool = frame.facts.tool;
  const ToolAction wanted = action_for_stroke(tool.action, pointer);
  if (held && !hand_.pressing() && wanted != tool.action && !before_stroke_) {
    before_stroke_ = tool;
    tool.action = wanted;
    ask(Command(SetTool{tool}));
  }
  if (!held && before_stroke_) {
    ask(Command(SetTool{*before_stroke_}));
    before_stroke_.reset();
  }
  if (!hand_.pressing()) pick_.update(frame.snapshot);
  const double radius = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  hand_.set_frame(
      {pointer, held, shown_.camera, viewport, &pick_, {radius, strength_m_, row_of(tool.action).grips}});
  inputs_.update(hand_, seconds);
}

void Editor::act(EditAction action, const LiveFrame& frame) {
  switch (action) {
    case EditAction::show_keys:
      keys_shown_ = !keys_shown_;
      break;
    case EditAction::new_document:
      leave(Leave::fresh);
      break;
    case EditAction::new_lump:
      leave(Leave::lump);
      break;
    case EditAction::open:
      leave(Leave::open);
      break;
    case EditAction::quit:
      leave(Leave::quit);
      break;
    case EditAction::save:
      leave_when_saved_ = false;
      save();
      break;
    case EditAction::export_model:
      files_.ask(FilePurpose::export_model, export_name());
      break;
    case EditAction::save_as:
      leave_when_saved_ = false;
      files_.ask(FilePurpose::save_model, document_.file());
      break;
    case EditAction::undo:
      ask(UndoStroke{});
      break;
    case EditAction::redo:
      ask(RedoStroke{});
      break;
    case EditAction::cancel:
      if (files_.asking()) {
        files_.close();
      } else if (lumps_.asking()) {
        lumps_.close();
      } else if (keys_shown_) {
        keys_shown_ = false;
      } else {
        hand_.let_go();
        ask(CancelStroke{});
      }
      break;
    case EditAction::toggle_symmetry: {
      Symmetry symmetry = frame.facts.symmetry;
      symmetry.on = !symmetry.on;
      ask(Command(SetSymmetry{symmetry}));
      break;
    }
    case EditAction::toggle_recording:
      toggle_recording(frame);
      break;
    case EditAction::screenshot:
      screenshot_due_ = true;
      break;
    case EditAction::place_plane:
      place_plane(frame);
      break;
    case EditAction::remove_planes:
      ask(Command(RemovePlanes{}));
      break;
    case EditAction::keep_shape:
      ask(Command(KeepShape{}));
      break;
    default:
      act_on_view(action);
  }
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
  ask(Command(SetTool{tool}));
}

// Across the model's longest direction, at the tool; the shorter part is held.
void Editor::place_plane(const LiveFrame& frame) {
  const Vector3 size = body_.extent();
  int axis = 0;
  size.maxCoeff(&axis);
  FixingPlane plane;
  plane.point_m = frame.snapshot.tool.proxy.position_m;
  const double middle = 0.5 * (body_.low[axis] + body_.high[axis]);
  plane.normal = Vector3::Zero();
  plane.normal[axis] = plane.point_m[axis] <= middle ? 1.0 : -1.0;
  ask(Command(PlacePlane{plane}));
}

void Editor::set_overlays(const MenuChoice& choice) {
  const Json before = overlays_command(view_.overlays, view_.see_through_body);
  const Json after = overlays_command(choice.overlays, choice.see_through_body);
  if (after == before) return;
  view_.overlays = choice.overlays;
  view_.see_through_body = choice.see_through_body;
  ask(ChangeView{after});
}

}  // namespace spoonbill
