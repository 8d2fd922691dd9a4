#include "engine/base/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace spoonbill {

namespace {

constexpr std::size_t buffer_bytes = 65536;

// Returns the error for the system call that has just failed, with the system's own reason (errno).
Error system_error(ErrorCode code, const std::filesystem::path& file, const char* what) {
  return {code, file.string() + ": " + what + ": " + std::generic_category().message(errno)};
}

class OpenFile {
 public:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
  OpenFile(OpenFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), bytes_(other.bytes_) {}
  OpenFile& operator=(OpenFile&&) = delete;
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int descriptor() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }
  std::size_t bytes() const { return bytes_; }  // size of the file when it was opened
  void set_bytes(std::size_t bytes) { bytes_ = bytes; }

 private:
  int descriptor_;
  std::size_t bytes_ = 0;
};

Error too_large(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy) {
  return Error{ErrorCode::too_many, file.string() + ": is larger than " + std::to_string(bytes_limit >> 20) +
                                        " MiB" + (remedy.empty() ? "" : "; " + std::string(remedy))};
}

// Opens a regular file. O_NONBLOCK keeps open() from waiting for the other end of a pipe.
Result<OpenFile> open_regular(const std::filesystem::path& file) {
  OpenFile opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (opened.descriptor() < 0) {
    if (errno == ENOENT) return Error{ErrorCode::missing, file.string() + ": no such file"};
    return system_error(ErrorCode::unreadable, file, "cannot be opened");
  }
  struct stat status {};
  if (::fstat(opened.descriptor(), &status) != 0)
    return system_error(ErrorCode::unreadable, file, "cannot be examined");
  if (S_ISDIR(status.st_mode))
    return Error{ErrorCode::unreadable, file.string() + ": is a folder; name a file in it"};
  if (!S_ISREG(status.st_mode))
    return Error{ErrorCode::unreadable, file.string() + ": is not a regular file"};
  opened.set_bytes(static_cast<std::size_t>(status.st_size));
  return Result<OpenFile>(std::move(opened));
}

}  // namespace

Status check_file(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy) {
  const auto opened = open_regular(file);
  if (!opened) return opened.error();
  if (opened->bytes() == 0) return Error{ErrorCode::malformed, file.string() + ": is empty"};
  if (opened->bytes() > bytes_limit) return too_large(file, bytes_limit, remedy);
  return {};
}

Result<std::string> read_file(const std::filesystem::path& file, std::size_t bytes_limit,
                              std::string_view remedy) {
  const auto opened = open_regular(file);
  if (!opened) return opened.error();
  std::string content;
  content.reserve(std::min(opened->bytes(), bytes_limit));
  char chunk[65536];
  for (;;) {
    const ssize_t count = ::read(opened->descriptor(), chunk, sizeof chunk);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(ErrorCode::unreadable, file, "cannot be read");
    if (count == 0) break;
    content.append(chunk, static_cast<std::size_t>(count));
    if (content.size() > bytes_limit) return too_large(file, bytes_limit, remedy);
  }
  if (content.empty()) return Error{ErrorCode::malformed, file.string() + ": is empty"};
  return content;
}

Result<std::ifstream> open_file(const std::filesystem::path& file) {
  const auto opened = open_regular(file);
  if (!opened) return opened.error();
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return system_error(ErrorCode::unreadable, file, "cannot be opened");
  return stream;
}

std::string read_first_bytes(const std::filesystem::path& file, std::size_t count) {
  auto stream = open_file(file);
  if (!stream) return {};
  std::string start(count, '\0');
  stream->read(start.data(), static_cast<std::streamsize>(count));
  start.resize(static_cast<std::size_t>(stream->gcount()));
  return start;
}

std::string read_last_bytes(const std::filesystem::path& file, std::size_t count) {
  auto stream = open_file(file);
  if (!stream) return {};
  stream->seekg(0, std::ios::end);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(stream->tellg(), 0));
  std::string end(std::min(size, count), '\0');
  stream->seekg(static_cast<std::streamoff>(size - end.size()));
  stream->read(end.data(), static_cast<std::streamsize>(end.size()));
  end.resize(static_cast<std::size_t>(stream->gcount()));
  return end;
}

namespace {

// Flushes the file to the disk and returns true on success. Pipes and read-only file systems have nothing to
// flush, which counts as success.
bool flush_descriptor(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS;
}

// Flushes the folder of the file, so that a rename in it survives a power cut. Errors are ignored, because
// some file systems cannot flush a folder.
void flush_parent_folder(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// Saves FILE as FILE.bak by a hard link, so that FILE is never absent. If the file system has no hard links,
// copies the file instead.
Status save_backup(const std::filesystem::path& file) {
  const std::filesystem::path backup = file.string() + ".bak";
  const std::filesystem::path staged = file.string() + ".bak.new";
  std::error_code ignored, error;
  std::filesystem::remove(staged, ignored);
  const UnfinishedFile unfinished(staged);
  std::filesystem::create_hard_link(file, staged, error);
  if (error) std::filesystem::copy_file(file, staged, error);
  if (!error) std::filesystem::rename(staged, backup, error);
  if (error) {
    std::filesystem::remove(staged, ignored);
    return Error{ErrorCode::unwritable, backup.string() + ": cannot keep the backup: " + error.message()};
  }
  return {};
}

}  // namespace

Status check_replaceable(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  // For the administrator, access() succeeds on every file, so the permission bits are tested too.
  if ((status.st_mode & 0222) != 0 && ::access(file.c_str(), W_OK) == 0) return {};
  return Error{ErrorCode::unwritable, file.string() + ": is read-only; choose another name or use --force"};
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& file, const OutputOptions& options) {
  return create(file, Mode::whole, options);
}

Result<OutputFile> OutputFile::create_growing(const std::filesystem::path& file,
                                              const OutputOptions& options) {
  return create(file, Mode::growing, options);
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& file, Mode mode,
                                      const OutputOptions& options) {
  const bool follows = options.named_by == NamedBy::person;
  std::error_code ignored;
  const auto status =
      follows ? std::filesystem::status(file, ignored) : std::filesystem::symlink_status(file, ignored);
  const bool replaces = std::filesystem::is_regular_file(status);
  if (replaces && !options.replaces_read_only) {
    if (Status checked = check_replaceable(file); !checked) return checked.error();
  }
  OutputFile out;
  out.mode_ = mode;
  out.file_ = out.target_ = file;
  // If the link cannot be resolved, the link itself is replaced.
  if (replaces && follows) out.target_ = std::filesystem::canonical(file, ignored);
  if (out.target_.empty()) out.target_ = file;
  out.written_ = out.target_;
  if (follows && std::filesystem::exists(status) && !replaces) {
    out.descriptor_ = ::open(out.written_.c_str(), O_WRONLY | O_CLOEXEC);
    if (out.descriptor_ < 0) return out.write_error("cannot be written");
    return Result<OutputFile>(std::move(out));
  }
  Status opened = mode == Mode::growing ? out.open_growing() : out.open_whole();
  if (!opened) return opened.error();
  // open() has created the new file with default permissions. The file gets the permissions of the file that
  // it replaces.
  if (replaces && ::fchmod(out.descriptor_, static_cast<mode_t>(status.permissions()) & 0777) != 0) {
    return out.write_error("cannot be given its permissions");
  }
  return Result<OutputFile>(std::move(out));
}

namespace {

// With O_EXCL, open() fails if the name exists, even if it is a symbolic link.
constexpr int new_file_flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;

// Locks the file. Returns false only if another process has locked it; without support for locks in the file
// system, returns true.
bool lock_file(int descriptor) {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

bool has_name(int descriptor, const std::filesystem::path& file) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::lstat(file.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

Error held_by_another(const std::filesystem::path& file) {
  return {
      ErrorCode::in_use,
      file.string() + ": another program is writing it; wait until it has finished or choose another name"};
}

// Renames the existing FILE to FILE.1 or, if this name is in use, to FILE.2 and so on. Returns the new name.
// An empty FILE is removed instead. Returns an empty path if nothing was renamed.
Result<std::filesystem::path> move_aside(const std::filesystem::path& file) {
  const OpenFile old(::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  const bool is_regular =
      old.descriptor() >= 0 && ::fstat(old.descriptor(), &status) == 0 && S_ISREG(status.st_mode);
  if (is_regular) {
    if (!lock_file(old.descriptor())) return held_by_another(file);
    // If the name no longer refers to the opened file, another process has moved or finished that file.
    if (!has_name(old.descriptor(), file)) return std::filesystem::path();
    if (status.st_size == 0) {
      ::unlink(file.c_str());
      return std::filesystem::path();
    }
  }
  constexpr int most_kept = 1000;
  for (int n = 1; n <= most_kept; ++n) {
    const std::filesystem::path other = file.string() + "." + std::to_string(n);
    if (::renameat2(AT_FDCWD, file.c_str(), AT_FDCWD, other.c_str(), RENAME_NOREPLACE) == 0) return other;
    if (errno == ENOENT) return std::filesystem::path();
    if (errno == EEXIST) continue;
    // Fallback for file systems that do not support RENAME_NOREPLACE.
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(other, ignored))) continue;
    if (::rename(file.c_str(), other.c_str()) == 0) return other;
    break;
  }
  return system_error(ErrorCode::unwritable, file, "is in the way and cannot be renamed");
}

}  // namespace

Status OutputFile::open_whole() {
  written_ += ".new-" + std::to_string(::getpid());
  ::unlink(written_.c_str());  // a killed process with the same ID may have left this file
  descriptor_ = ::open(written_.c_str(), new_file_flags, 0666);
  if (descriptor_ < 0) return write_error("cannot be written");
  unfinished_ = UnfinishedFile(written_);
  return {};
}

// Opens FILE.part and locks it. The lock ends with the process, so a locked FILE.part is still being written,
// and an unlocked one was left by a crash.
Status OutputFile::open_growing() {
  written_ += ".part";
  // A try fails if an old FILE.part had to be moved aside, or if another process acts at the same moment.
  constexpr int most_tries = 100;
  for (int n = 0; n < most_tries; ++n) {
    OpenFile opened(::open(written_.c_str(), new_file_flags, 0666));
    if (opened.descriptor() < 0 && errno != EEXIST) return write_error("cannot be written");
    if (opened.descriptor() < 0) {
      auto aside = move_aside(written_);
      if (!aside) return aside.error();
      if (!aside->empty()) kept_aside_ = std::move(aside).value();
      continue;
    }
    if (!lock_file(opened.descriptor())) return held_by_another(file_);
    if (!has_name(opened.descriptor(), written_)) continue;
    descriptor_ = opened.release();
    return {};
  }
  return held_by_another(file_);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : file_(std::move(other.file_)),
      target_(std::move(other.target_)),
      written_(std::move(other.written_)),
      kept_aside_(std::move(other.kept_aside_)),
      unfinished_(std::move(other.unfinished_)),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      mode_(other.mode_) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(target_, other.target_);
  std::swap(written_, other.written_);
  std::swap(kept_aside_, other.kept_aside_);
  std::swap(unfinished_, other.unfinished_);
  std::swap(buffer_, other.buffer_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(mode_, other.mode_);
  return *this;
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (mode_ == Mode::whole && writes_beside()) ::unlink(written_.c_str());
}

Error OutputFile::write_error(const char* what) const {
  return system_error(ErrorCode::unwritable, file_, what);
}

Status OutputFile::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return write_error("cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Status OutputFile::write(std::string_view bytes) {
  if (mode_ == Mode::growing) return send(bytes);
  if (buffer_.size() + bytes.size() < buffer_bytes) {
    buffer_ += bytes;
    return {};
  }
  if (Status sent = send(buffer_); !sent) return sent;
  buffer_.clear();
  return send(bytes);
}

Status OutputFile::flush() {
  if (Status sent = send(buffer_); !sent) return sent;
  buffer_.clear();
  return flush_descriptor(descriptor_) ? Status() : Status(write_error("cannot be flushed to the disk"));
}

Status OutputFile::commit(Durability durability) {
  return finish(durability, false);
}

Status OutputFile::commit_with_backup() {
  return finish(Durability::now, true);
}

Status OutputFile::finish(Durability durability, bool with_backup) {
  if (Status sent = send(buffer_); !sent) return sent;
  buffer_.clear();
  const bool flushes = durability == Durability::now;
  if (flushes && !flush_descriptor(descriptor_)) return write_error("cannot be flushed to the disk");
  if (writes_beside()) {
    std::error_code ignored;
    const bool keeps_old =
        with_backup && std::filesystem::is_regular_file(std::filesystem::symlink_status(target_, ignored));
    if (keeps_old) {
      if (Status saved = save_backup(target_); !saved) return saved;
    }
    if (::rename(written_.c_str(), target_.c_str()) != 0) {
      Error error = write_error("cannot be replaced");
      if (mode_ == Mode::growing) error.message += "; the new content is in " + written_.string();
      return error;
    }
    written_ = target_;
    unfinished_ = {};
    if (flushes) flush_parent_folder(target_);
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) return write_error("cannot be closed");
  return {};
}

Status write_file(const std::filesystem::path& file, std::string_view bytes, Durability durability,
                  const OutputOptions& options) {
  auto out = OutputFile::create(file, options);
  if (!out) return out.error();
  if (Status written = out->write(bytes); !written) return written;
  return out->commit(durability);
}

Status replace_file(const std::filesystem::path& file, std::string_view bytes, const OutputOptions& options) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const bool may_replace = options.named_by == NamedBy::program || std::filesystem::is_regular_file(status);
  if (std::filesystem::exists(status) && !may_replace) {
    return Error{ErrorCode::unwritable, file.string() + ": is not a regular file; choose another name"};
  }
  auto out = OutputFile::create(file, options);
  if (!out) return out.error();
  if (Status written = out->write(bytes); !written) return written;
  return out->commit_with_backup();
}

Status publish_file(const std::filesystem::path& finished, const std::filesystem::path& file) {
  const int descriptor = ::open(finished.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return system_error(ErrorCode::unwritable, file, "cannot be written");
  const bool flushed = flush_descriptor(descriptor);
  ::close(descriptor);
  if (!flushed) return system_error(ErrorCode::unwritable, file, "cannot be flushed to the disk");
  if (::rename(finished.c_str(), file.c_str()) != 0)
    return system_error(ErrorCode::unwritable, file, "cannot be replaced");
  flush_parent_folder(file);
  return {};
}

Status flush_to_disk(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return system_error(ErrorCode::unwritable, folder, "cannot be opened");
  const bool flushed = ::syncfs(descriptor) == 0;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return flushed ? Status()
                 : Status(system_error(ErrorCode::unwritable, folder, "cannot be flushed to the disk"));
}

}  // namespace spoonbill
