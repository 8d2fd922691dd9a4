// The document in the window as the user sees it: its file, its unsaved changes, and the document recovered
// after a crash.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/live/autosave.h"
#include "app/live/live_session.h"

namespace spoonbill {

// File, unsaved changes and autosave of the document that is edited. One owner: the program's main thread.
class EditedDocument {
 public:
  // `state_folder` is empty if the program has no folder for autosaves.
  EditedDocument(std::optional<std::filesystem::path> state_folder, std::filesystem::path file);

  // Returns the document's file; empty for a document that was never saved.
  const std::filesystem::path& file() const { return file_; }

  // Returns the document that an interrupted session of this file left; usually none.
  Result<std::optional<Document>> recovered_document() const;

  // Moves the recovered document to another name, so that this session can autosave, and returns that name.
  Result<std::filesystem::path> set_recovered_aside() const;

  // Returns true if another window had the file open when this window opened it.
  bool is_open_elsewhere() const { return claim_ && claim_->is_open_elsewhere(); }

  // Ends autosaving, because the user discards the unsaved changes. Only work that was recovered and has not
  // been saved since is kept: it is stored as a document, whose name is returned.
  Result<std::optional<std::filesystem::path>> discard_changes(LiveSession& live);

  // Switches to a file that the session has opened, and discards the changes of the previous document.
  // Nothing is autosaved before begin() or begin_recovered(), because a recovered document must stay until
  // the user has decided about it.
  Result<std::optional<std::filesystem::path>> switch_to(std::filesystem::path file, LiveSession& live);

  // Marks the document as unchanged and starts to autosave.
  void begin(LiveSession& live);
  // Starts with the recovered document, which counts as changed.
  void begin_recovered(LiveSession& live);

  // Updates the file and the state of unsaved changes after the session has saved a document.
  void note_saved(const SavedDocument& saved, LiveSession& live);
  // Returns true if the document was recovered and has not been saved since.
  bool is_recovered() const { return is_recovered_; }
  bool has_unsaved_changes(const LiveFrame& frame) const {
    return is_recovered_ || frame.edit_count != saved_edit_count_;
  }

  // Returns the title of the window, such as "spoon-handle.json *"; the star stands for unsaved changes.
  std::string title(const LiveFrame& frame) const;

 private:
  std::optional<Autosave> autosave() const;
  std::optional<AutosaveClaim> claim() const;

  std::optional<std::filesystem::path> state_folder_;
  std::filesystem::path file_;
  std::optional<AutosaveClaim> claim_;
  std::uint64_t document_ = 0;  // number of the document, see LiveFrame::document
  std::uint64_t saved_edit_count_ = 0;
  bool is_recovered_ = false;
};

}  // namespace spoonbill
