// Questions that must be answered before anything else: each draws a modal window while it is asked. One
// owner; the thread that draws.
#pragma once

#include <optional>
#include <string>

namespace spoonbill {

// A question with up to three answers.
class Question {
 public:
  Question(const char* title, const char* first, const char* second, const char* third = nullptr)
      : title_(title), answers_{first, second, third} {}

  void ask(std::string text) {
    text_ = std::move(text);
    asking_ = appearing_ = true;
  }
  bool asking() const { return asking_; }

  // Between begin_frame() and end_frame(). The number of the answer, 0 to 2, once.
  std::optional<int> draw();

 private:
  const char* title_;
  const char* answers_[3];
  std::string text_;
  bool asking_ = false;
  bool appearing_ = false;
};

}  // namespace spoonbill
