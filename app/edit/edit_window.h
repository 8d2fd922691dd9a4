// The editor's window: GL context, interface and renderer at the display's scale, and a log of the frames
// shown.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/edit/mouse.h"
#include "app/panel/interface_context.h"
#include "engine/base/result.h"
#include "render/gl/glfw_window.h"
#include "render/image.h"
#include "render/renderer.h"

namespace spoonbill {

// The window and all that draws in it. One owner: the program's main thread.
class EditWindow {
 public:
  // Opens a hidden window. `scale` overrides the display's scale, which some displays do not report. Returns
  // an error if there is no display, no GL or no font.
  static Result<EditWindow> make(int width, int height, std::optional<double> scale);

  EditWindow(EditWindow&&) noexcept;
  EditWindow& operator=(EditWindow&&) = delete;
  ~EditWindow();

  GlfwWindow& window() { return *window_; }
  const Theme& theme() const { return interface_.theme(); }
  double scale() const { return scale_; }
  int width_px() const { return window_->width_px(); }
  int height_px() const { return window_->height_px(); }

  // Handles events and begins the interface's frame. Returns an error if the fonts cannot be read at a new
  // scale.
  Status begin_frame();
  // Ends the frame, draws the scene and presents it.
  Status end_frame(const Snapshot& snapshot, const ViewSettings& view);

  // Ends a frame without showing it. Returns a picture of the scene and its labels, without the interface.
  Result<Image> end_frame_as_picture(const Snapshot& snapshot, const ViewSettings& view);

  // Reads the pixels of the last frame.
  void read_pixels(Image& image) const { renderer_.read_pixels(image); }

 private:
  struct Backend;  // connects ImGui to the window's events
  EditWindow(std::unique_ptr<GlfwWindow> window, InterfaceContext interface, Renderer renderer, double scale,
             std::optional<double> chosen_scale);

  std::unique_ptr<GlfwWindow> window_;
  InterfaceContext interface_;
  Renderer renderer_;
  std::unique_ptr<Backend> backend_;
  double scale_;
  std::optional<double> chosen_scale_;
};

// Returns the state of the mouse in this frame, as the interface has it.
Pointer read_pointer();

// State of the editor in a frame. Each member is written to the log under its own name; a line of the log
// also has the number of the frame.
struct ShownFrame {
  std::uint64_t tick = 0;
  std::uint64_t session = 0;     // number of sessions started after the first
  std::uint64_t edit_count = 0;  // number of commands so far plus number of ticks with contact
  bool recording = false;
  bool in_stroke = false;
  bool can_undo = false;
  bool can_redo = false;
  double last_frame_ms = 0.0;  // time that the frame before took, without the wait for the next
  bool pressing = false;       // true during a press of the left button that began on the picture
  std::string prompt;          // prompt that is open: "file", "shape", "question", or empty
  std::string typed;           // text of the file prompt
  std::vector<std::array<double, 2>> answers_px;  // button centres of the open question
  double pointer_x_px = 0.0;
  double pointer_y_px = 0.0;
  double hand_lag_m = 0.0;  // distance between the device and the position that the mouse sets
  // Stage of a training window: "preparing", "ready", "running" or "ended"; empty in the editor.
  std::string stage;
  std::uint64_t missed = 0;            // ticks that an attempt has missed
  std::string end;                     // name of the TaskEnd, empty in the editor
  Vector3 wanted_m = Vector3::Zero();  // position of the bowl or the finger that the person wants
};

// Log of the frames shown, one JSON object per line. `spoonbill edit` writes it if the environment contains
// SPOONBILL_FRAME_LOG=FILE. A program that controls the window from outside reads the state of the window
// from the log. One owner: the thread that draws.
class FrameLog {
 public:
  // Opens the log and replaces an existing file. Returns an error if the file cannot be written.
  static Result<FrameLog> open(const std::filesystem::path& file);

  // Adds a line for a frame that was presented. On return the line is in the file. A full disk is not
  // reported.
  void add(const ShownFrame& shown);

 private:
  explicit FrameLog(std::ofstream out) : out_(std::move(out)) {}

  std::ofstream out_;
  std::uint64_t frames_ = 0;
};

}  // namespace spoonbill
