#include "tests/app/edit_window.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace spoonbill {

void EditWindow::SetUp() {
  auto display = VirtualDisplay::start(1300, 760);
  ASSERT_TRUE(display) << display.error().message;
  display_ = std::move(display).value();
  setenv("XDG_STATE_HOME", place_.text("state").c_str(), 1);
}

void EditWindow::start(const std::vector<std::string>& arguments, const std::string& command) {
  std::filesystem::remove(log_file());
  std::string line = "exec \"" SPOONBILL_PROGRAM "\" " + command;
  for (const std::string& argument : arguments) line += " \"" + argument + "\"";
  editor_ = fork();
  ASSERT_GE(editor_, 0);
  if (editor_ == 0) {
    setenv("SPOONBILL_FRAME_LOG", log_file().c_str(), 1);
    setenv("DISPLAY", display_->name().c_str(), 1);
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  ASSERT_TRUE(wait_for([&] { return hands("search --onlyvisible --name Spoonbill windowfocus --sync"); }));
  ASSERT_TRUE(wait_frames(2));
}

Json EditWindow::shown() const {
  std::ifstream log(log_file());
  std::string line, last;
  while (std::getline(log, line) && !log.eof()) last = line;
  return last.empty() ? Json::object() : json_of(last);
}

bool EditWindow::wait_frames(int count) const {
  const Json before = shown();
  const int from = before.empty() ? 0 : before["frame"].get<int>();
  return wait_shown([&](const Json& frame) { return frame["frame"].get<int>() > from + count; });
}

bool EditWindow::wait_ticks(int count) const {
  const int from = shown()["tick"].get<int>();
  return wait_shown([&](const Json& frame) { return frame["tick"].get<int>() >= from + count; });
}

bool EditWindow::move_to(int x, int y) const {
  if (!hands("mousemove " + std::to_string(x) + " " + std::to_string(y))) return false;
  return wait_shown(
             [&](const Json& frame) { return frame["pointer_x_px"] == x && frame["pointer_y_px"] == y; }) &&
         wait_frames(1) && wait_shown([](const Json& frame) {
           return frame["pressing"].get<bool>() || frame["hand_lag_m"].get<double>() < 2e-4;
         });
}

bool EditWindow::press_button() const {
  return hands("mousedown 1") && wait_shown([](const Json& frame) { return frame["pressing"].get<bool>(); });
}

bool EditWindow::release_button() const {
  return hands("mouseup 1") && wait_shown([](const Json& frame) { return !frame["pressing"].get<bool>(); });
}

void EditWindow::press(const std::string& keys) const {
  std::string down, up;
  std::istringstream words(keys);
  for (std::string key; words >> key;) {
    down += "keydown " + key + " ";
    up = "keyup " + key + " " + up;
  }
  EXPECT_TRUE(hands(down));
  EXPECT_TRUE(wait_frames(2));
  EXPECT_TRUE(hands(up));
  EXPECT_TRUE(wait_frames(2));
}

bool EditWindow::press_while(const std::string& key, const std::string& field) const {
  constexpr int most_strokes = 10;
  for (int stroke = 0; stroke < most_strokes && shown()[field].get<bool>(); ++stroke) {
    if (!hands("key " + key) || !wait_frames(3)) return false;
  }
  return wait_shown([&](const Json& frame) { return !frame[field].get<bool>(); });
}

bool EditWindow::hands(const std::string& what) const {
  const std::string command = "DISPLAY=" + display_->name() + " xdotool " + what + " >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

Document EditWindow::saved(const std::string& name, std::filesystem::file_time_type older) const {
  EXPECT_TRUE(hands("key ctrl+s"));
  EXPECT_TRUE(wait_for([&] { return std::filesystem::last_write_time(place_.path(name)) > older; }));
  auto document = read_document(place_.path(name));
  EXPECT_TRUE(document) << document.error().message;
  return std::move(document).value();
}

void EditWindow::save_and_quit(const std::string& name) {
  saved(name, time_of(name));
  EXPECT_TRUE(hands("key ctrl+q"));
  EXPECT_EQ(wait_for_end(), 0);
}

int EditWindow::wait_for_end() {
  int status = 0;
  const bool ended = wait_for([&] { return waitpid(editor_, &status, WNOHANG) == editor_; });
  if (ended) editor_ = -1;
  return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void EditWindow::kill_editor() {
  if (editor_ <= 0) return;
  kill(editor_, SIGKILL);
  waitpid(editor_, nullptr, 0);
  editor_ = -1;
}

}  // namespace spoonbill
