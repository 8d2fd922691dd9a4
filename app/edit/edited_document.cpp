#include "app/edit/edited_document.h"

#include <utility>

namespace spoonbill {

EditedDocument::EditedDocument(std::optional<std::filesystem::path> state_folder, std::filesystem::path file)
    : state_folder_(std::move(state_folder)), file_(std::move(file)), claim_(claim()) {}

std::optional<Autosave> EditedDocument::autosave() const {
  if (!claim_) return std::nullopt;
  return claim_->autosave();
}

std::optional<AutosaveClaim> EditedDocument::claim() const {
  if (!state_folder_) return std::nullopt;
  return AutosaveClaim::acquire(*state_folder_, file_);
}

Result<std::optional<Document>> EditedDocument::recovered_document() const {
  const auto file = autosave();
  if (!file) return std::optional<Document>();
  return file->recovered_document();
}

Result<std::filesystem::path> EditedDocument::set_recovered_aside() const {
  const auto file = autosave();
  if (!file) return Error{ErrorCode::unavailable, "there is no folder for autosaves"};
  return file->set_aside();
}

Result<std::optional<std::filesystem::path>> EditedDocument::discard_changes(LiveSession& live) {
  using Kept = std::optional<std::filesystem::path>;
  if (!std::exchange(is_recovered_, false) || !claim_) {
    live.set_autosave(std::nullopt);
    return Kept();
  }
  const auto kept = live.set_autosave_aside();
  if (!kept) return kept.error();
  return Kept(kept.value());
}

Result<std::optional<std::filesystem::path>> EditedDocument::switch_to(std::filesystem::path file,
                                                                       LiveSession& live) {
  auto kept = discard_changes(live);
  file_ = std::move(file);
  document_ = live.last_frame().document;
  saved_edit_count_ = live.last_frame().edit_count;
  claim_.reset();  // the old claim must be released first, because the same file may be opened again
  claim_ = claim();
  return kept;
}

void EditedDocument::begin(LiveSession& live) {
  saved_edit_count_ = live.last_frame().edit_count;
  live.set_autosave(autosave());
}

void EditedDocument::begin_recovered(LiveSession& live) {
  document_ = live.last_frame().document;
  is_recovered_ = true;
  live.set_autosave(autosave());
}

void EditedDocument::note_saved(const SavedDocument& saved, LiveSession& live) {
  if (saved.document != document_) return;
  const bool renamed = saved.file != file_;
  file_ = saved.file;
  saved_edit_count_ = saved.edit_count;
  is_recovered_ = false;
  if (!renamed) return;
  auto next = claim();
  live.set_autosave(next ? std::optional(next->autosave()) : std::nullopt);
  claim_ = std::move(next);
}

std::string EditedDocument::title(const LiveFrame& frame) const {
  const std::string name = file_.empty() ? "untitled" : file_.filename().string();
  return name + (has_unsaved_changes(frame) ? " *" : "");
}

}  // namespace spoonbill
