// The editor: a live session in a window. Each frame it reads the person's hands, asks the session for what
// they want, and draws the newest tick. One owner; the program's main thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/edit/edit_window.h"
#include "app/edit/edited_document.h"
#include "app/edit/file_prompt.h"
#include "app/edit/frame_log.h"
#include "app/edit/lump_prompt.h"
#include "app/edit/menu.h"
#include "app/edit/message_line.h"
#include "app/edit/mouse_hand.h"
#include "app/edit/plots.h"
#include "app/edit/prompts.h"
#include "app/view/shown_stages.h"
#include "app/view/view_choice.h"
#include "engine/base/geometry.h"
#include "haptic/space_mouse.h"
#include "haptic/virtual_device.h"
#include "render/view_settings.h"

namespace spoonbill {

struct EditSettings {
  std::filesystem::path model;  // empty: the spoon handle that comes with the program, as an untitled one
  int width = 1280;
  int height = 720;
  std::optional<double> scale;
  NavigationPreset navigation = NavigationPreset::rhino;
  std::filesystem::path recording;  // begins with the session; empty for none
  std::filesystem::path log;        // a FrameLog; empty for none
  InstructionSet instruction_set = best_instruction_set();
  bool real_time = true;
};

class Editor {
 public:
  // Refused: no display, a model that cannot be read or simulated.
  static Result<std::unique_ptr<Editor>> make(const EditSettings& settings);

  // Until the person leaves. An error ends the window, never the recording or the autosaved work.
  Status run();

  // What was said while there was a window to say it in, for those who read the terminal.
  LoopFigures figures() const { return live_->figures(); }

 private:
  // What happens once unsaved changes are dealt with.
  enum class Leave { none, quit, open, fresh, lump };
  // Work that was asked of the session and has not been answered.
  struct AskedOpen {
    std::filesystem::path file;
    ViewChoice view;
    bool recovered = false;
  };

  Editor(const EditSettings& settings, EditWindow window, std::unique_ptr<LiveSession> live,
         std::shared_ptr<TargetMailbox> mailbox, const HandTarget& start, ViewChoice view,
         EditedDocument document);

  Status run_frames();
  Status frame(double seconds);
  void start();
  ShownFrame shown_frame(const LiveFrame& frame) const;
  void take_news(const LiveFrame& frame, double seconds);
  void take_answers(const LiveFrame& frame);
  Status lay_out(const LiveFrame& frame, double seconds);
  void lay_out_panel(const LiveFrame& frame);
  void lay_out_questions();
  ViewSettings view_settings(double top_px) const;

  // editor_input.cpp
  Pointer read_pointer() const;
  void take_keys(const LiveFrame& frame);
  void take_pointer(const LiveFrame& frame, double seconds);
  void drag_setting(const Pointer& pointer, const LiveFrame& frame);
  void move_camera(const Pointer& pointer, CameraMotion motion, const Viewport& viewport);
  void stroke(const Pointer& pointer, const LiveFrame& frame, const Viewport& viewport, double seconds);
  void act(EditAction action, const LiveFrame& frame);
  void act_on_view(EditAction action);
  void set_tool(const LiveFrame& frame, ToolKind kind, ToolAction tool_action);
  void set_overlays(const MenuChoice& choice);
  void place_plane(const LiveFrame& frame);
  void show_camera();

  // editor_files.cpp
  void leave(Leave how);
  void leave_now(Leave how);
  void open(const std::filesystem::path& file);
  void open_fresh();
  void open_lump(const LumpChoice& choice);
  void recover();
  void save();
  void save_as(const std::filesystem::path& file);
  std::filesystem::path export_name() const;
  void export_to(const std::filesystem::path& file);
  void toggle_recording(const LiveFrame& frame);
  void write_screenshot();
  void look_for_left_over();
  void begin_without_left_over();

  void ask(Request request);

  EditSettings settings_;
  EditWindow window_;
  std::unique_ptr<LiveSession> live_;
  ViewChoice view_;
  EditedDocument document_;
  std::vector<Material> presets_;

  Box body_;
  std::uint64_t session_ = 0;
  ViewSettings shown_;
  ShownStages stages_;
  SurfacePick pick_;
  MouseHand hand_;
  std::optional<SpaceMouse> space_mouse_;
  HandInputs inputs_;  // hand_ and space_mouse_
  double strength_m_ = 0.004;
  std::optional<Tool> before_stroke_;  // while Ctrl inverts push and pull, or Shift smooths
  bool stroke_began_here_ = false;     // the press began on the picture, not on the panel
  FrameBudget budget_;
  LivePlots plots_;
  MessageLine messages_;
  std::vector<float> forces_n_;
  std::optional<FrameLog> log_;

  FilePrompt files_;
  LumpPrompt lumps_;
  Question unsaved_{"Unsaved changes", "Save", "Do not save", "Stay"};
  Question left_over_{"Unsaved work", "Recover it", "Discard it"};
  Leave leaving_ = Leave::none;
  bool leave_when_saved_ = false;
  bool left_ = false;
  bool keys_shown_ = false;
  bool screenshot_due_ = false;
  std::vector<std::optional<AskedOpen>> asked_;  // nothing stands for a recording
  std::uint64_t works_ = 0;
};

}  // namespace spoonbill
