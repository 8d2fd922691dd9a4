// The editor in a window, for tests that use it by mouse and keys.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/exchange/json.h"
#include "tests/app/workplace.h"
#include "tests/render/virtual_display.h"

namespace spoonbill {

// The editor in a window of 1280 x 720 pixels, controlled by X events from xdotool. Software drawing on a
// loaded machine takes up to a second per frame, so every test waits until the frame log shows a state, not
// for a fixed time.
class EditWindow : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override { kill_editor(); }

  // Starts a command of the program that opens a window.
  void start(const std::vector<std::string>& arguments, const std::string& command = "edit");
  std::filesystem::path log_file() const { return place_.path("frames.log"); }

  // Returns the last frame shown, with the fields of ShownFrame; empty before the first frame.
  Json shown() const;
  // Waits until a frame satisfies the condition.
  template <class Condition>
  bool wait_shown(Condition condition) const {
    return wait_for([&] {
      const Json frame = shown();
      return !frame.empty() && condition(frame);
    });
  }
  // Waits until `count` further frames were started and shown. They show the effects of all earlier events.
  bool wait_frames(int count) const;
  // Waits until `count` further ticks were computed, which takes longer on a loaded machine.
  bool wait_ticks(int count) const;

  // Moves the pointer and waits until the editor has seen it there. Unless the button is pressed, also waits
  // until the device has reached the position that the mouse sets.
  bool move_to(int x, int y) const;
  // Presses or releases the left button and waits until the editor has seen it.
  bool press_button() const;
  bool release_button() const;
  // Holds the keys down until frames have seen them, because a text field reads only the present state of the
  // keys.
  void press(const std::string& keys) const;
  // Presses a key until this field of the frames is false.
  bool press_while(const std::string& key, const std::string& field) const;
  // Runs xdotool with these arguments.
  bool hands(const std::string& what) const;

  template <class Condition>
  bool wait_for(Condition condition) const {
    using namespace std::chrono_literals;
    const auto give_up = std::chrono::steady_clock::now() + 300s;
    while (std::chrono::steady_clock::now() < give_up) {
      if (condition()) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  }

  // Saves the document and reads the file once it is newer than `older`.
  Document saved(const std::string& name, std::filesystem::file_time_type older) const;
  std::filesystem::file_time_type time_of(const std::string& name) const {
    return std::filesystem::last_write_time(place_.path(name));
  }

  // Saves the document, so that the editor does not ask, and quits. The recording is then complete.
  void save_and_quit(const std::string& name);
  // Waits until the editor has ended; returns its exit code.
  int wait_for_end();
  void kill_editor();

  Workplace place_;
  std::unique_ptr<VirtualDisplay> display_;
  pid_t editor_ = -1;
};

}  // namespace spoonbill
