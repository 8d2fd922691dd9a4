#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "app/assets_folder.h"
#include "app/edit/editor.h"
#include "app/files/documents.h"
#include "app/live/exporter.h"
#include "render/image.h"

namespace spoonbill {
namespace {

constexpr int most_numbered_files = 9999;

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

// The first of NAME-0001.ENDING, NAME-0002.ENDING... that does not exist.
std::filesystem::path next_free(const std::filesystem::path& folder, const std::string& name,
                                const std::string& ending) {
  std::filesystem::path file;
  std::error_code ignored;
  for (int number = 1; number <= most_numbered_files; ++number) {
    std::array<char, 16> digits{};
    std::snprintf(digits.data(), digits.size(), "-%04d", number);
    std::string whole = name;
    whole.append(digits.data()).append(ending);
    file = folder / whole;
    if (!std::filesystem::exists(file, ignored)) break;
  }
  return file;
}

std::string stem_of(const std::filesystem::path& file) {
  return file.empty() ? "untitled" : file.stem().string();
}

}  // namespace

void Editor::leave(Leave how) {
  leaving_ = how;
  if (!document_.has_unsaved_changes(live_->last_frame())) return leave_now(how);
  unsaved_.ask("Save the changes to " + stem_of(document_.file()) + "?");
}

void Editor::leave_now(Leave how) {
  leaving_ = Leave::none;
  leave_when_saved_ = false;
  if (how == Leave::quit) left_ = true;
  if (how == Leave::fresh) open_fresh();
  if (how == Leave::lump) lumps_.ask();
  if (how == Leave::open) files_.ask(FilePurpose::open_model, document_.file());
}

void Editor::open(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return messages_.add_problem(document.error().message);
  auto view = view_from_json(document->view, file.string());
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), file.string())) return;
  asked_.emplace_back(AskedOpen{file, view.value()});
}

void Editor::open_fresh() {
  const std::filesystem::path file = std::filesystem::path(assets_folder) / "models" / "spoon-handle.json";
  auto document = read_document(file);
  if (!document) return messages_.add_problem(document.error().message);
  auto view = view_from_json(document->view, file.string());
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), file.string())) return;
  asked_.emplace_back(AskedOpen{{}, view.value()});
}

void Editor::open_lump(const LumpChoice& choice) {
  const auto material = shipped_material("modelling-clay");
  if (!material) return messages_.add_problem(material.error().message);
  auto document = make_stock_shape_document(choice, material.value());
  if (!document) return lumps_.refuse(document.error().message);
  const auto view = view_from_json(document->view, "the new lump");
  if (!view) return messages_.add_problem(view.error().message);
  if (!live_->open(std::move(document).value(), "the new lump")) return;
  asked_.emplace_back(AskedOpen{{}, view.value()});
}

void Editor::look_for_left_over() {
  const auto found = document_.left_over();
  if (!found) {
    messages_.add_problem(found.error().message);
    return begin_without_left_over();
  }
  if (!found.value()) return document_.begin(*live_);
  left_over_.ask("An earlier session of " + stem_of(document_.file()) +
                 " did not end in order.\nWhat it had not saved is still there.");
}

void Editor::begin_without_left_over() {
  document_.set_left_over_aside();
  document_.begin(*live_);
}

void Editor::recover() {
  auto found = document_.left_over();
  if (!found || !found.value()) return begin_without_left_over();
  auto view = view_from_json(found.value()->view, "the recovered document");
  if (!view || !live_->open(std::move(*found.value()), "the recovered document")) {
    return begin_without_left_over();
  }
  asked_.emplace_back(AskedOpen{document_.file(), view.value(), true});
}

void Editor::save() {
  if (document_.file().empty()) return files_.ask(FilePurpose::save_model, "untitled.json");
  save_as(document_.file());
}

void Editor::save_as(const std::filesystem::path& file) {
  live_->set_view(view_to_json(view_));
  live_->save(file);
  ask(MarkFile{FileMarkKind::document, mark_name_of(stem_of(file))});
}

// Beside the document, as a STEP file unless another ending is typed.
std::filesystem::path Editor::export_name() const {
  return folder_of(document_.file()) / (stem_of(document_.file()) + ".step");
}

void Editor::export_to(const std::filesystem::path& file) {
  if (!Exporter::writes(file)) {
    return messages_.add_problem("not exported: the ending of the name chooses the format: " +
                                 std::string(Exporter::endings_text()));
  }
  live_->save(file);
}

void Editor::toggle_recording(const LiveFrame& frame) {
  if (frame.recording) {
    live_->stop_recording();
    return;
  }
  const bool is_asked = std::any_of(asked_.begin(), asked_.end(), [](const auto& asked) { return !asked; });
  if (is_asked) return;  // its answer is not here yet
  const std::filesystem::path file =
      next_free(folder_of(document_.file()), stem_of(document_.file()), ".recording.jsonl");
  if (!live_->start_recording(file, view_)) return;
  asked_.emplace_back(std::nullopt);
  messages_.add({Notice::Kind::information, "recording to " + file.filename().string()});
}

void Editor::write_screenshot() {
  screenshot_due_ = false;
  Image picture;
  window_.read_pixels(picture);
  const std::filesystem::path file =
      next_free(folder_of(document_.file()), stem_of(document_.file()), ".png");
  if (Status written = write_png(file, picture); !written) {
    return messages_.add_problem(written.error().message);
  }
  messages_.add({Notice::Kind::information, "wrote " + file.filename().string()});
  ask(MarkFile{FileMarkKind::picture, mark_name_of(file.stem().string())});
}

}  // namespace spoonbill
