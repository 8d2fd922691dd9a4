// Autosaved documents: unsaved work that survives a crash. Each window has one file in the program's state
// folder. The file is removed when the document is saved or closed normally. The locks beside these files
// show which documents are open in other windows.
//
//  {"spoonbill_autosave": 1, "of": "/home/ada/spoon.json", "document": {...}}
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/files/state_folder.h"
#include "engine/base/result.h"
#include "engine/exchange/document.h"

namespace spoonbill {

// The autosave file of one document. Plain value; used by one thread at a time.
class Autosave {
 public:
  // `of` names the document's file; empty for an unsaved document. Windows that show the same document have
  // different numbers, from 1.
  Autosave(const std::filesystem::path& folder, const std::filesystem::path& of, int number = 1);

  // Replaces the file as a whole; after an error the previous one remains.
  Status write(const Document& document) const;

  // Returns the document that an interrupted session left. Returns nullopt if no session was interrupted, or
  // if the document's file holds the same document, whichever of the two files is newer. A file that cannot
  // be read is an error and is not removed.
  Result<std::optional<Document>> recovered_document() const;

  // Removes the file if it exists.
  void remove() const;
  // Moves the file's content to a free name in the same folder, so that later autosaves do not overwrite it,
  // and returns that name. The new file is a document that can be opened. A file that cannot be read or
  // copied is only renamed.
  Result<std::filesystem::path> set_aside() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  Result<Document> read() const;

  std::filesystem::path of_;
  std::filesystem::path file_;
};

// A window's exclusive right to one autosave file, for the lifetime of the object, which has one owner.
class AutosaveClaim {
 public:
  // Claims an autosave that an interrupted session left and that no other window has claimed. If there is
  // none, claims the first free file name.
  static AutosaveClaim acquire(const std::filesystem::path& folder, const std::filesystem::path& of);

  const Autosave& autosave() const { return autosave_; }
  // Returns true if another window had the same document open when this claim was acquired.
  bool is_open_elsewhere() const { return is_open_elsewhere_; }

 private:
  AutosaveClaim(Autosave autosave, std::optional<FileLock> lock)
      : autosave_(std::move(autosave)), lock_(std::move(lock)) {}

  Autosave autosave_;
  std::optional<FileLock> lock_;  // lock of the autosave; empty if none could be acquired
  bool is_open_elsewhere_ = false;
};

}  // namespace spoonbill
