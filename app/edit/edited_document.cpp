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
  return AutosaveClaim::take(*state_folder_, file_);
}

Result<std::optional<Document>> EditedDocument::left_over() const {
  const auto place = autosave();
  if (!place) return std::optional<Document>();
  return place->left_over();
}

void EditedDocument::discard_left_over() const {
  if (const auto place = autosave()) place->remove();
}

void EditedDocument::set_left_over_aside() const {
  if (const auto place = autosave()) place->set_aside();
}

void EditedDocument::turn_to(std::filesystem::path file, LiveSession& live) {
  file_ = std::move(file);
  document_ = live.last_frame().document;
  saved_deed_ = live.last_frame().deed;
  recovered_ = false;
  live.set_autosave(std::nullopt);
  claim_.reset();  // first, for a file that is opened again
  claim_ = claim();
}

void EditedDocument::begin(LiveSession& live) {
  saved_deed_ = live.last_frame().deed;
  live.set_autosave(autosave());
}

void EditedDocument::begin_recovered(LiveSession& live) {
  document_ = live.last_frame().document;
  recovered_ = true;
  live.set_autosave(autosave());
}

void EditedDocument::note_saved(const SavedDocument& saved, LiveSession& live) {
  if (saved.document != document_) return;
  const bool renamed = saved.file != file_;
  file_ = saved.file;
  saved_deed_ = saved.deed;
  recovered_ = false;
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
