#include "app/edit/file_prompt.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <system_error>

namespace spoonbill {
namespace {

constexpr const char* title_of(FilePurpose purpose) {
  switch (purpose) {
    case FilePurpose::open_model:
      return "Open a model";
    case FilePurpose::export_model:
      return "Export the model to a CAD file or a mesh";
    case FilePurpose::save_model:
      break;
  }
  return "Save the model as";
}

constexpr const char* verb_of(FilePurpose purpose) {
  switch (purpose) {
    case FilePurpose::open_model:
      return "Open";
    case FilePurpose::export_model:
      return "Export";
    case FilePurpose::save_model:
      break;
  }
  return "Save";
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code problem;
  return std::filesystem::is_directory(path, problem);
}

}  // namespace

void FilePrompt::ask(FilePurpose purpose, const std::filesystem::path& start) {
  purpose_ = purpose;
  asking_ = appearing_ = true;
  problem_.clear();
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::absolute(start, ignored);
  folder_ = is_folder(whole) ? whole : whole.parent_path();
  const std::string name = is_folder(whole) ? std::string() : whole.filename().string();
  std::snprintf(text_.data(), text_.size(), "%s", name.c_str());
  list_folder();
}

void FilePrompt::list_folder() {
  entries_.clear();
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, problem)) {
    const std::string name = entry.path().filename().string();
    if (name.empty() || name.front() == '.') continue;
    std::error_code ignored;
    if (entry.is_directory(ignored) || entry.path().extension() == ".json") entries_.push_back(entry.path());
  }
  if (problem) problem_ = folder_.string() + ": " + problem.message();
  std::sort(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
    const bool folder_a = is_folder(a), folder_b = is_folder(b);
    return folder_a != folder_b ? folder_a : a < b;
  });
}

std::optional<std::filesystem::path> FilePrompt::draw() {
  if (!asking_) return std::nullopt;
  const char* title = title_of(purpose_);
  if (appearing_) ImGui::OpenPopup(title);
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const ImVec2 middle(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(title, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    return std::nullopt;
  }
  ImGui::TextUnformatted(folder_.string().c_str());
  ImGui::BeginChild("entries", ImVec2(26.0F * line, 12.0F * line), true);
  if (ImGui::Selectable("..", false, ImGuiSelectableFlags_DontClosePopups)) {
    folder_ = folder_.parent_path();
    list_folder();
  }
  std::optional<std::filesystem::path> opened;
  for (const auto& entry : entries_) {
    const std::string name = entry.filename().string() + (is_folder(entry) ? "/" : "");
    if (ImGui::Selectable(name.c_str(), false, ImGuiSelectableFlags_DontClosePopups)) opened = entry;
  }
  ImGui::EndChild();
  if (opened && is_folder(*opened)) {
    folder_ = *opened;
    list_folder();
  } else if (opened) {
    std::snprintf(text_.data(), text_.size(), "%s", opened->filename().c_str());
  }
  if (appearing_) ImGui::SetKeyboardFocusHere();
  appearing_ = false;
  ImGui::SetNextItemWidth(26.0F * line);
  const bool entered =
      ImGui::InputText("##name", text_.data(), text_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  if (!problem_.empty()) ImGui::TextUnformatted(problem_.c_str());
  const bool confirmed = ImGui::Button(verb_of(purpose_));
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) asking_ = false;
  std::optional<std::filesystem::path> result;
  if (entered || confirmed) result = chosen();
  if (!asking_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return result;
}

std::optional<std::filesystem::path> FilePrompt::chosen() {
  const std::filesystem::path typed(text_.data());
  if (typed.empty()) return std::nullopt;
  std::filesystem::path whole = typed.is_absolute() ? typed : folder_ / typed;
  if (is_folder(whole)) {
    folder_ = whole;
    text_[0] = '\0';
    list_folder();
    return std::nullopt;
  }
  if (purpose_ == FilePurpose::save_model && whole.extension().empty()) whole += ".json";
  if (purpose_ == FilePurpose::export_model && whole.extension().empty()) whole += ".step";
  asking_ = false;
  return whole;
}

}  // namespace spoonbill
