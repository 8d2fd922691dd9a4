// Reading of files, whole or in part, and writing of files that appear whole or not at all. Errors name the
// file and the system's reason.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "engine/base/unfinished_files.h"

namespace spoonbill {

// Returns an error if the file is missing, a folder, a device or pipe, not readable by this process, empty,
// or larger than `bytes_limit`. If it is too large, the message ends with `remedy`, for example "reduce the
// mesh". Never waits for the other end of a pipe.
Status check_file(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy = {});

// Returns the file's content. Refuses every file that check_file() refuses, and a file that cannot be read to
// its end.
Result<std::string> read_file(const std::filesystem::path& file, std::size_t bytes_limit,
                              std::string_view remedy = {});

// Opens a regular file for reading piece by piece, for files that may be larger than the memory available.
// Refuses a missing file, a folder, a device or pipe, and a file that this process may not read.
Result<std::ifstream> open_file(const std::filesystem::path& file);

// Returns up to `count` bytes from the start or the end of a regular file, for recognising its format.
// Returns an empty text if the file cannot be opened or is not regular.
std::string read_first_bytes(const std::filesystem::path& file, std::size_t count);
std::string read_last_bytes(const std::filesystem::path& file, std::size_t count);

// Selects whether commit() waits until the content is on the disk. Several files can be committed with
// `later` and then flushed by one call of flush_to_disk().
enum class Durability { now, later };

// Origin of a file's name. A person may name a link, whose target is then written, or a device or pipe, which
// is written directly. The program, a script or a recording may name a file in a folder of unknown origin.
// Whatever has this name there is replaced, and links are not followed.
enum class NamedBy { person, program };

// Options for writing a file whose name may be in use. A regular file that this process may not write is
// refused unless `replaces_read_only` is true.
struct OutputOptions {
  NamedBy named_by = NamedBy::person;
  bool replaces_read_only = false;
};

// Returns an error if `file` is a regular file that this process may not write, or whose permissions do not
// allow anyone to write it.
Status check_replaceable(const std::filesystem::path& file);

// A file that is being written. It has one owner and is used by one thread, never the haptic thread, because
// writing may block.
class OutputFile {
 public:
  // Creates a file whose whole content appears under its name at commit(). A crash at any moment leaves
  // either the old content or the new. The new file has the permissions of the file that it replaces. Writes
  // are buffered, so errors may be reported as late as commit().
  static Result<OutputFile> create(const std::filesystem::path& file, const OutputOptions& options = {});

  // Creates a file that other programs may read while it grows. All bytes that write() has accepted survive a
  // crash of this program. The file grows as FILE.part and becomes FILE at commit(); without commit() it
  // remains FILE.part. Refuses a file that another process is growing (ErrorCode::in_use). If a crash
  // has left a FILE.part, renames that file (see kept_aside()).
  static Result<OutputFile> create_growing(const std::filesystem::path& file,
                                           const OutputOptions& options = {});

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();  // deletes an uncommitted file made by create()

  // Returns the path to which write() writes: FILE.part for a growing file, a temporary name for a file made
  // by create(), or FILE itself for a device or pipe.
  const std::filesystem::path& written_file() const { return written_; }
  // Returns the new name that create_growing() gave to an older FILE.part; empty if it renamed none.
  const std::filesystem::path& kept_aside() const { return kept_aside_; }

  Status write(std::string_view bytes);

  // Writes the buffered bytes and waits until the file is on the disk. For a pipe there is no such wait.
  Status flush();

  // Publishes the file under its name and closes it. No other call may follow.
  Status commit(Durability durability = Durability::now);

  // Same as commit(), but keeps the replaced content as FILE.bak.
  Status commit_with_backup();

 private:
  enum class Mode { whole, growing };

  OutputFile() = default;
  static Result<OutputFile> create(const std::filesystem::path& file, Mode mode,
                                   const OutputOptions& options);
  Status open_whole();
  Status open_growing();
  Error write_error(const char* what) const;
  Status send(std::string_view bytes);
  Status finish(Durability durability, bool with_backup);
  bool writes_beside() const { return written_ != target_; }

  std::filesystem::path file_;    // name as given, for messages
  std::filesystem::path target_;  // path to replace or create, with links resolved
  // Path to which write() writes: a temporary file beside the target, or the target itself.
  std::filesystem::path written_;
  std::filesystem::path kept_aside_;
  UnfinishedFile unfinished_;  // entry in the list of unfinished files, for an uncommitted file of create()
  std::string buffer_;         // bytes not yet sent to the file; stays empty for a file of create_growing()
  int descriptor_ = -1;
  Mode mode_ = Mode::whole;
};

// Writes a file and commits it, with the guarantees of OutputFile::create().
Status write_file(const std::filesystem::path& file, std::string_view bytes,
                  Durability durability = Durability::now, const OutputOptions& options = {});

// Same as write_file(), but keeps the replaced content as FILE.bak; for files that a user edits. If a person
// gave the name (NamedBy), refuses to replace anything but a regular file.
Status replace_file(const std::filesystem::path& file, std::string_view bytes,
                    const OutputOptions& options = {});

// Flushes `finished`, a file that another program has written, and renames it to `file`. Both paths must be
// in the same folder.
Status publish_file(const std::filesystem::path& finished, const std::filesystem::path& file);

// Waits until everything written to the file system of the folder is on the disk.
Status flush_to_disk(const std::filesystem::path& folder);

}  // namespace spoonbill
