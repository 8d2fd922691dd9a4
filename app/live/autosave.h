// Autosaved documents: what a crash leaves of unsaved work. One file a window, in the program's state
// folder, gone again once the document is saved or closed in order.
//
//   {"spoonbill_autosave": 1, "of": "/home/ada/spoon.json", "document": {...}}
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/files/state_folder.h"
#include "engine/base/result.h"
#include "engine/exchange/document.h"

namespace spoonbill {

// One document's autosave. Plain value; used by one thread at a time.
class Autosave {
 public:
  // `of` names the document's file; empty for one that has none yet. Windows that show one document number
  // their autosaves, from 1 on.
  Autosave(const std::filesystem::path& folder, const std::filesystem::path& of, int number = 1);

  // Whole or not at all, as every document; the one before stays until then.
  Status write(const Document& document) const;

  // What a session that did not end in order has left; nothing when there is none, or when it is older than
  // the document's file itself. One that cannot be read is an error, which leaves it where it is.
  Result<std::optional<Document>> left_over() const;

  // Without one, nothing happens.
  void remove() const;
  // Out of the way of the next ones, for whoever can still read it.
  void set_aside() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path of_;
  std::filesystem::path file_;
};

// A window's right to one autosave of a document, which no other window uses as long as this lives. One
// owner.
class AutosaveClaim {
 public:
  // An autosave that was left over and belongs to nobody, else the first that is free.
  static AutosaveClaim take(const std::filesystem::path& folder, const std::filesystem::path& of);

  const Autosave& autosave() const { return autosave_; }

 private:
  AutosaveClaim(Autosave autosave, std::optional<FileLock> lock)
      : autosave_(std::move(autosave)), lock_(std::move(lock)) {}

  Autosave autosave_;
  std::optional<FileLock> lock_;  // nothing where the folder takes no lock
};

}  // namespace spoonbill
