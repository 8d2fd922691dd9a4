// Modal prompts: a question, a file, a stock shape. Each prompt draws a window until the user answers. One
// owner: the thread that draws.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/files/documents.h"

namespace spoonbill {

// A question with up to three answers.
class Question {
 public:
  Question(const char* title, const char* first, const char* second, const char* third = nullptr)
      : title_(title), answers_{first, second, third} {}

  void ask(std::string text) {
    text_ = std::move(text);
    is_open_ = appearing_ = true;
  }
  bool is_open() const { return is_open_; }
  // Centres of the buttons in the last frame, in pixels from the left and the top; empty if no question is
  // open.
  const std::vector<std::array<double, 2>>& button_centres_px() const { return button_centres_px_; }

  // Draws the question, between begin_frame() and end_frame(). Returns the index of the answer, 0 to 2, once.
  std::optional<int> draw();

 private:
  const char* title_;
  const char* answers_[3];
  std::string text_;
  std::vector<std::array<double, 2>> button_centres_px_;
  bool is_open_ = false;
  bool appearing_ = false;
};

// Purpose of the file prompt.
enum class FilePurpose { open_model, save_model, export_model };

// Prompt for a file: a text field and a list of the folder's models.
class FilePrompt {
 public:
  // Makes the next draw() open the prompt, showing this file or folder.
  void ask(FilePurpose purpose, const std::filesystem::path& start);
  void close() { is_open_ = false; }
  bool is_open() const { return is_open_; }
  FilePurpose purpose() const { return purpose_; }
  const char* typed() const { return text_.data(); }

  // Draws the prompt, between begin_frame() and end_frame(). Returns the chosen file once.
  std::optional<std::filesystem::path> draw();

 private:
  void list_folder();
  std::optional<std::filesystem::path> confirm_text();

  FilePurpose purpose_ = FilePurpose::open_model;
  bool is_open_ = false;
  bool appearing_ = false;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> entries_;  // subfolders, then .json files of the folder
  std::array<char, 1024> text_{};
  std::string problem_;
};

// Prompt for a new stock shape: its kind and sizes.
class ShapePrompt {
 public:
  // Makes the next draw() open the prompt, showing the previous choice.
  void ask();
  void close() { is_open_ = false; }
  bool is_open() const { return is_open_; }
  // Reopens the prompt with the reason why the chosen shape cannot be made.
  void refuse(std::string problem);

  // Draws the prompt, between begin_frame() and end_frame(). Returns the choice once.
  std::optional<StockShapeChoice> draw();

 private:
  void draw_fields();

  bool is_open_ = false;
  bool appearing_ = false;
  StockShapeChoice choice_ = default_stock_shape(0);
  std::string problem_;
};

}  // namespace spoonbill
