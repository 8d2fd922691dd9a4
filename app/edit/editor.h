// The editor: a live session in a window. Each frame it reads the user's input, sends requests to the session
// and draws the newest tick.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/edit/edit_window.h"
#include "app/edit/edited_document.h"
#include "app/edit/live_display.h"
#include "app/edit/menu.h"
#include "app/edit/mouse.h"
#include "app/edit/prompts.h"
#include "app/panel/panel.h"
#include "app/session/view_choice.h"
#include "engine/base/geometry.h"
#include "haptic/space_mouse.h"
#include "haptic/virtual_device.h"
#include "render/view_settings.h"

namespace spoonbill {

// Settings of the editor.
struct EditSettings {
  std::filesystem::path model;  // model to open; default: the spoon handle, as an untitled document
  int width = 1280;
  int height = 720;
  std::optional<double> scale;
  NavigationPreset navigation = NavigationPreset::rhino;
  std::filesystem::path recording;      // file that records the session from its start; empty for none
  std::filesystem::path log;            // file of the log of the frames shown; empty for none
  std::optional<FrameQuality> quality;  // of all frames; default: chosen to hold 60 frames per second
  InstructionSet instruction_set = best_instruction_set();
  bool real_time = true;
};

// The window with its session and document. One owner: the program's main thread.
class Editor {
 public:
  // Opens the window. Returns an error if there is no display, or if the model cannot be read or simulated.
  static Result<std::unique_ptr<Editor>> make(const EditSettings& settings);

  // Runs until the user quits. An error closes the window, but keeps the recording and the autosaved work.
  Status run();

  // Returns the figures of the haptic loop, valid after run() too.
  LoopFigures figures() const { return live_->figures(); }

 private:
  // Action that follows once unsaved changes are saved or discarded.
  enum class NextStep { none, quit, open, spoon_handle, new_shape };
  // A document that the session was asked to open and has not opened yet.
  struct PendingOpen {
    std::filesystem::path file;
    ViewChoice view;
    bool recovered = false;
    std::optional<std::uint64_t> content = {};  // content_hash() of the file when it was read
  };

  Editor(const EditSettings& settings, EditWindow window, std::unique_ptr<LiveSession> live,
         std::shared_ptr<TargetMailbox> mailbox, const HandTarget& start, ViewChoice view,
         EditedDocument document);

  Status run_frames();
  Status frame(double seconds);
  void start();
  ShownFrame shown_frame(const LiveFrame& frame) const;
  void receive_updates(const LiveFrame& frame, double seconds);
  void handle_completed_jobs(const LiveFrame& frame);
  Status lay_out(const LiveFrame& frame, double seconds);
  void lay_out_labels(const LiveFrame& frame, ViewSettings& view);
  void lay_out_panel(const LiveFrame& frame);
  void lay_out_prompts();
  Framing framing() const;
  ViewSettings view_settings(double top_px) const;

  // The following functions handle the user's input.
  void handle_keys(const LiveFrame& frame);
  void handle_pointer(const LiveFrame& frame, double seconds);
  void drag_setting(const Pointer& pointer, const LiveFrame& frame);
  void move_camera(const Pointer& pointer, CameraMotion motion, const Viewport& viewport);
  void stroke(const Pointer& pointer, const LiveFrame& frame, const Viewport& viewport, double seconds);
  void act(EditAction action, const LiveFrame& frame);
  void act_on_view(EditAction action);
  void say(const char* text);
  void set_tool(const LiveFrame& frame, ToolKind kind, ToolAction tool_action);
  void set_overlays(const MenuChoice& choice);
  void place_plane(const LiveFrame& frame);
  void show_camera();

  // The following functions handle files.
  void finish_document(NextStep step);
  void start_next_step(NextStep step);
  void open(const std::filesystem::path& file);
  void open_spoon_handle();
  void open_shape(const StockShapeChoice& choice);
  void recover();
  void save();
  void save_as(const std::filesystem::path& file, Replaced replaced = Replaced::known);
  void ask_about_conflict(std::filesystem::path file);
  bool is_question_open() const;
  std::filesystem::path default_export_file() const;
  void export_to(const std::filesystem::path& file);
  void toggle_recording(const LiveFrame& frame);
  void write_screenshot(const Image& picture);
  void offer_recovery();
  void begin_without_recovery();
  void report_kept(const Result<std::optional<std::filesystem::path>>& kept);

  void send(Request request);

  EditSettings settings_;
  EditWindow window_;
  std::unique_ptr<LiveSession> live_;
  ViewChoice view_;
  EditedDocument document_;
  std::vector<Material> presets_;

  Box body_bounds_;
  std::uint64_t session_ = 0;
  ViewSettings shown_;
  ViewSettings drawn_;  // `shown_`, or without a panel where the frame is for a screenshot of the scene
  StageFinder stage_finder_;
  SurfacePick pick_;
  MouseHand hand_;
  std::optional<SpaceMouse> space_mouse_;
  HandInputs inputs_;  // refers to hand_ and space_mouse_
  PressSettings press_settings_;
  std::optional<Tool> before_stroke_;  // tool to restore after a stroke with Ctrl or Shift
  bool stroke_began_here_ = false;     // true if the left button was pressed on the picture
  FrameBudget budget_;
  double last_frame_s_ = 0.0;  // time that the last frame took, without the wait for the next
  LivePlots plots_;
  MessageLine messages_;
  std::vector<float> forces_n_;
  std::optional<FrameLog> log_;

  FilePrompt file_prompt_;
  ShapePrompt shape_prompt_;
  Question unsaved_{"Unsaved changes", "Save", "Don't save", "Cancel"};
  Question recovery_{"Unsaved work", "Recover", "Open the saved version"};
  Question conflict_{"Another version on the disk", "Replace", "Save as", "Cancel"};
  std::filesystem::path conflict_file_;
  NextStep next_step_ = NextStep::none;
  bool continues_after_save_ = false;
  bool is_finished_ = false;
  bool shows_keys_ = false;
  enum class Screenshot { none, scene, window };
  Screenshot asked_screenshot_ = Screenshot::none;  // to be taken of the next frame
  Screenshot screenshot_ = Screenshot::none;        // taken of this frame
  // Jobs that the session has not completed, in the order of the requests. nullopt stands for the start of a
  // recording.
  std::vector<std::optional<PendingOpen>> pending_jobs_;
  std::uint64_t completed_jobs_ = 0;
};

}  // namespace spoonbill
