// The document in the window as the person sees it: which file it is, whether it has unsaved changes, and
// what a crash may have left of it. One owner; the program's main thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/live/autosave.h"
#include "app/live/live_session.h"

namespace spoonbill {

class EditedDocument {
 public:
  // `state_folder`: nothing where there is no place to autosave.
  EditedDocument(std::optional<std::filesystem::path> state_folder, std::filesystem::path file);

  // Empty for one that was never saved.
  const std::filesystem::path& file() const { return file_; }

  // What a session that was cut short has left of this file; nothing for most.
  Result<std::optional<Document>> left_over() const;

  void discard_left_over() const;
  // One that cannot be read must not keep this session's work from being autosaved.
  void set_left_over_aside() const;

  // The session shows this file from now on; nothing is autosaved until begin(), when it is known what
  // becomes of what was left over.
  void turn_to(std::filesystem::path file, LiveSession& live);

  // As it is now it has no change; work is autosaved.
  void begin(LiveSession& live);
  // What was left over has taken its place: it counts as changed.
  void begin_recovered(LiveSession& live);

  void note_saved(const SavedDocument& saved, LiveSession& live);
  bool has_unsaved_changes(const LiveFrame& frame) const { return recovered_ || frame.deed != saved_deed_; }

  // "spoon-handle.json *": the star stands for unsaved changes.
  std::string title(const LiveFrame& frame) const;

 private:
  std::optional<Autosave> autosave() const;
  std::optional<AutosaveClaim> claim() const;

  std::optional<std::filesystem::path> state_folder_;
  std::filesystem::path file_;
  std::optional<AutosaveClaim> claim_;
  std::uint64_t document_ = 0;  // as in LiveFrame
  std::uint64_t saved_deed_ = 0;
  bool recovered_ = false;
};

}  // namespace spoonbill
