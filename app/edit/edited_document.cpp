#include "app/edit/edited_document.h"

#include <utility>

namespace spoonbill {

std::optional<Autosave> EditedDocument::autosave() const {
  if (!state_folder_) return std::nullopt;
  return Autosave(*state_folder_, file_);
}

Result<std::optional<Document>> EditedDocument::left_over() const {
  const auto place = autosave();
  if (!place) return std::optional<Document>();
  return place->left_over();
}

void EditedDocument::discard_left_over() const {
  if (const auto place = autosave()) place->remove();
}

void EditedDocument::begin(std::filesystem::path file, LiveSession& live, std::uint64_t deed) {
  file_ = std::move(file);
  saved_deed_ = deed;
  recovered_ = false;
  live.set_autosave(autosave());
}

void EditedDocument::begin_recovered(LiveSession& live) {
  recovered_ = true;
  live.set_autosave(autosave());
}

void EditedDocument::note_saved(const SavedDocument& saved, LiveSession& live) {
  const bool renamed = saved.file != file_;
  file_ = saved.file;
  saved_deed_ = saved.deed;
  recovered_ = false;
  if (renamed) live.set_autosave(autosave());
}

std::string EditedDocument::title(const LiveFrame& frame) const {
  const std::string name = file_.empty() ? "untitled" : file_.filename().string();
  return name + (has_unsaved_changes(frame) ? " *" : "");
}

}  // namespace spoonbill
