// The one way in which the program writes files: whole or not at all, with what a file system can refuse as
// an error line that names the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// Whether commit() waits until the content is on the disk. A sequence of files commits each of them `later`
// and calls flush_to_disk() once at its end.
enum class Durability { now, later };

// A file being written. One owner, one thread; never the haptic one, because writing may block.
class OutputFile {
 public:
  // A regular file appears under its name at commit(), whole, and is written beside it until then: a crash at
  // any moment leaves the old content or the new. One that it replaces gives it its permissions, and a link
  // is followed to what it names. A device or pipe is written as it is. Writes are buffered, so errors may
  // show as late as commit().
  static Result<OutputFile> create(const std::filesystem::path& file);

  // A file that others may read while it grows: what write() has returned for survives this program's death.
  // It grows under its own name where there is no such file yet, and as FILE.part beside an older one, which
  // commit() replaces. Without commit() it stays as it is.
  static Result<OutputFile> create_growing(const std::filesystem::path& file);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();  // a file of create() that was not committed is removed

  Status write(std::string_view bytes);

  // Waits until all that was written is on the disk, where the file is on one.
  Status flush();

  // Puts the file in its place and closes it. Nothing may follow.
  Status commit(Durability durability = Durability::now);

  // As commit(); the content that is replaced stays as FILE.bak.
  Status commit_with_backup();

 private:
  enum class Manner { whole, growing };

  OutputFile() = default;
  static Result<OutputFile> create(const std::filesystem::path& file, Manner manner);
  Error failure(const char* what) const;
  Status send(std::string_view bytes);
  Status finish(Durability durability, bool keep_backup);
  bool is_beside() const { return written_ != target_; }

  std::filesystem::path file_;     // as it was named, for messages
  std::filesystem::path target_;   // what that names
  std::filesystem::path written_;  // beside the target, or the target itself
  std::string buffer_;             // empty while the file grows
  int descriptor_ = -1;
  Manner manner_ = Manner::whole;
};

// Writes a file of that content as OutputFile::create() does.
Status write_file(const std::filesystem::path& file, std::string_view bytes,
                  Durability durability = Durability::now);

// As write_file(), for what a person would miss: the old content stays as FILE.bak. Refused: anything but a
// regular file.
Status replace_file(const std::filesystem::path& file, std::string_view bytes);

// Puts a file that another program has finished under its name, once it is on the disk. Both must be in one
// folder.
Status put_in_place(const std::filesystem::path& finished, const std::filesystem::path& file);

// Waits until the disk holds all that was written to the file system of that folder.
Status flush_to_disk(const std::filesystem::path& folder);

}  // namespace spoonbill
