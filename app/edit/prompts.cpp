#include "app/edit/prompts.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>

namespace spoonbill {

std::optional<int> Question::draw() {
  button_centres_px_.clear();
  if (!is_open_) return std::nullopt;
  if (appearing_) ImGui::OpenPopup(title_);
  appearing_ = false;
  const ImVec2 centre(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(centre, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(title_, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    return std::nullopt;
  }
  ImGui::TextUnformatted(text_.c_str());
  std::optional<int> answer;
  for (int i = 0; i < 3; ++i) {
    if (answers_[i] == nullptr) continue;
    if (i > 0) ImGui::SameLine();
    if (ImGui::Button(answers_[i])) answer = i;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    button_centres_px_.push_back({0.5 * (low.x + high.x), 0.5 * (low.y + high.y)});
  }
  if (answer) is_open_ = false;
  if (!is_open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return answer;
}

namespace {

constexpr const char* prompt_title(FilePurpose purpose) {
  switch (purpose) {
    case FilePurpose::open_model:
      return "Open model";
    case FilePurpose::export_model:
      return "Export model to CAD file or mesh";
    case FilePurpose::save_model:
      break;
  }
  return "Save model as";
}

constexpr const char* button_text(FilePurpose purpose) {
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
  is_open_ = appearing_ = true;
  problem_.clear();
  std::error_code ignored;
  const std::filesystem::path path = std::filesystem::absolute(start, ignored);
  folder_ = is_folder(path) ? path : path.parent_path();
  const std::string name = is_folder(path) ? std::string() : path.filename().string();
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
  if (!is_open_) return std::nullopt;
  const char* title = prompt_title(purpose_);
  if (appearing_) ImGui::OpenPopup(title);
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const ImVec2 centre(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(centre, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
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
  const bool confirmed = ImGui::Button(button_text(purpose_));
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) is_open_ = false;
  std::optional<std::filesystem::path> result;
  if (entered || confirmed) result = confirm_text();
  if (!is_open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return result;
}

std::optional<std::filesystem::path> FilePrompt::confirm_text() {
  const std::filesystem::path typed(text_.data());
  if (typed.empty()) return std::nullopt;
  std::filesystem::path path = typed.is_absolute() ? typed : folder_ / typed;
  if (is_folder(path)) {
    folder_ = path;
    text_[0] = '\0';
    list_folder();
    return std::nullopt;
  }
  if (purpose_ == FilePurpose::save_model && path.extension().empty()) path += ".json";
  if (purpose_ == FilePurpose::export_model && path.extension().empty()) path += ".step";
  is_open_ = false;
  return path;
}

namespace {

constexpr const char* shape_prompt_title = "New shape";

}  // namespace

void ShapePrompt::ask() {
  is_open_ = appearing_ = true;
  problem_.clear();
}

void ShapePrompt::refuse(std::string problem) {
  is_open_ = appearing_ = true;
  problem_ = std::move(problem);
}

void ShapePrompt::draw_fields() {
  const StockShapeKind& kind = stock_shape_kinds()[choice_.kind];
  if (ImGui::BeginCombo("Kind", kind.name)) {
    for (std::size_t k = 0; k < stock_shape_kinds().size(); ++k) {
      if (ImGui::Selectable(stock_shape_kinds()[k].name, k == choice_.kind)) choice_ = default_stock_shape(k);
    }
    ImGui::EndCombo();
  }
  const StockShapeKind& chosen = stock_shape_kinds()[choice_.kind];
  for (std::size_t f = 0; f < chosen.fields.size(); ++f) {
    ImGui::InputDouble(chosen.fields[f].name, &choice_.sizes_mm[f], 0.0, 0.0, "%.4g mm");
  }
}

std::optional<StockShapeChoice> ShapePrompt::draw() {
  if (!is_open_) return std::nullopt;
  if (appearing_) ImGui::OpenPopup(shape_prompt_title);
  appearing_ = false;
  const ImVec2 centre(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(centre, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(shape_prompt_title, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    return std::nullopt;
  }
  ImGui::PushItemWidth(10.0F * ImGui::GetFontSize());
  draw_fields();
  ImGui::PopItemWidth();
  if (!problem_.empty()) {
    ImGui::PushTextWrapPos(24.0F * ImGui::GetFontSize());
    ImGui::TextUnformatted(problem_.c_str());
    ImGui::PopTextWrapPos();
  }
  std::optional<StockShapeChoice> result;
  const bool entered = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
  if (ImGui::Button("Create") || entered) {
    result = choice_;
    is_open_ = false;
  }
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) is_open_ = false;
  if (!is_open_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return result;
}

}  // namespace spoonbill
