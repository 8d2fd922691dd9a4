// A file that grows at its end, unbuffered: what append() has returned for survives the program's death.
#pragma once

#include <filesystem>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// One owner. Every error names the file and the system's reason ("No space left on device").
class SequentialFile {
 public:
  // An existing file is emptied. Errors name `named` where the user knows the file by another name.
  static Result<SequentialFile> create(const std::filesystem::path& file);
  static Result<SequentialFile> create(const std::filesystem::path& file, std::filesystem::path named);

  SequentialFile(SequentialFile&& other) noexcept;
  SequentialFile& operator=(SequentialFile&& other) noexcept;
  ~SequentialFile();

  Status append(std::string_view content);

  // Flushes to the disk, where the file is on one, and closes. Nothing may follow.
  Status close();

 private:
  SequentialFile(std::filesystem::path named, int descriptor);
  Error failure(const char* what) const;

  std::filesystem::path named_;
  int descriptor_;
};

}  // namespace spoonbill
