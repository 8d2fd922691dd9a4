// Asks for a file: a line to type into and the folder's models to choose from. One owner; the thread that
// draws.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace spoonbill {

enum class FilePurpose { open_model, save_model, export_model };

class FilePrompt {
 public:
  // Shows from the next draw() on, beginning with this file or folder.
  void ask(FilePurpose purpose, const std::filesystem::path& start);
  void close() { asking_ = false; }
  bool asking() const { return asking_; }
  FilePurpose purpose() const { return purpose_; }
  const char* typed() const { return text_.data(); }

  // Between begin_frame() and end_frame(). The file that was chosen, once.
  std::optional<std::filesystem::path> draw();

 private:
  void list_folder();
  std::optional<std::filesystem::path> chosen();

  FilePurpose purpose_ = FilePurpose::open_model;
  bool asking_ = false;
  bool appearing_ = false;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> entries_;  // folders first
  std::array<char, 1024> text_{};
  std::string problem_;
};

}  // namespace spoonbill
