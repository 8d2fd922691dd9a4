#include "engine/base/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace spoonbill {
namespace {

constexpr std::size_t buffer_bytes = 65536;

Error system_failure(const std::filesystem::path& file, const char* what) {
  return Error{file.string() + ": " + what + ": " + std::generic_category().message(errno)};
}

// Pipes and read-only file systems have no disk to wait for.
bool is_on_disk(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS;
}

// Makes a rename in the folder survive a power cut; a file system that cannot do this has nothing to report.
void flush_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// A hard link first, so that the file itself is never absent; a copy where the file system has no links.
Status keep_as_backup(const std::filesystem::path& file) {
  const std::filesystem::path backup = file.string() + ".bak";
  const std::filesystem::path staged = file.string() + ".bak.new";
  std::error_code ignored, error;
  std::filesystem::remove(staged, ignored);
  std::filesystem::create_hard_link(file, staged, error);
  if (error) std::filesystem::copy_file(file, staged, error);
  if (!error) std::filesystem::rename(staged, backup, error);
  if (error) {
    std::filesystem::remove(staged, ignored);
    return Error{backup.string() + ": cannot keep the backup: " + error.message()};
  }
  return {};
}

}  // namespace

Result<OutputFile> OutputFile::create(const std::filesystem::path& file) {
  return create(file, Manner::whole);
}

Result<OutputFile> OutputFile::create_growing(const std::filesystem::path& file) {
  return create(file, Manner::growing);
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& file, Manner manner) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const bool replaces = std::filesystem::is_regular_file(status);
  OutputFile out;
  out.manner_ = manner;
  out.file_ = out.target_ = file;
  // What cannot be resolved is replaced itself.
  if (replaces) out.target_ = std::filesystem::canonical(file, ignored);
  if (ignored) out.target_ = file;
  out.written_ = out.target_;
  int flags = O_WRONLY | O_CREAT | O_CLOEXEC | O_TRUNC;
  if (manner == Manner::growing) {
    if (replaces) out.written_ += ".part";
  } else if (replaces || !std::filesystem::exists(status)) {
    out.written_ += ".new-" + std::to_string(::getpid());
    ::unlink(out.written_.c_str());  // what a killed process of the same number left
    flags |= O_EXCL;                 // so that nobody's link under that name is followed
  }
  out.descriptor_ = ::open(out.written_.c_str(), flags, 0666);
  if (out.descriptor_ < 0) return out.failure("cannot be written");
  // A mode given to open() loses what the process's mask takes away.
  if (replaces && ::fchmod(out.descriptor_, static_cast<mode_t>(status.permissions()) & 0777) != 0) {
    return out.failure("cannot be given its permissions");
  }
  return Result<OutputFile>(std::move(out));
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : file_(std::move(other.file_)),
      target_(std::move(other.target_)),
      written_(std::move(other.written_)),
      buffer_(std::move(other.buffer_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      manner_(other.manner_) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(target_, other.target_);
  std::swap(written_, other.written_);
  std::swap(buffer_, other.buffer_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(manner_, other.manner_);
  return *this;
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (manner_ == Manner::whole && is_beside()) ::unlink(written_.c_str());
}

Error OutputFile::failure(const char* what) const {
  return system_failure(file_, what);
}

Status OutputFile::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure("cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Status OutputFile::write(std::string_view bytes) {
  if (manner_ == Manner::growing) return send(bytes);
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
  return is_on_disk(descriptor_) ? Status() : Status(failure("cannot be flushed to the disk"));
}

Status OutputFile::commit(Durability durability) {
  return finish(durability, false);
}

Status OutputFile::commit_with_backup() {
  return finish(Durability::now, true);
}

Status OutputFile::finish(Durability durability, bool keep_backup) {
  if (Status sent = send(buffer_); !sent) return sent;
  buffer_.clear();
  const bool flushes = durability == Durability::now;
  if (flushes && !is_on_disk(descriptor_)) return failure("cannot be flushed to the disk");
  if (is_beside()) {
    std::error_code ignored;
    if (keep_backup && std::filesystem::exists(target_, ignored)) {
      if (Status kept = keep_as_backup(target_); !kept) return kept;
    }
    if (::rename(written_.c_str(), target_.c_str()) != 0) {
      Error error = failure("cannot be replaced");
      if (manner_ == Manner::growing) error.message += "; the new content is " + written_.string();
      return error;
    }
    written_ = target_;
    if (flushes) flush_folder_of(target_);
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) return failure("cannot be closed");
  return {};
}

Status write_file(const std::filesystem::path& file, std::string_view bytes, Durability durability) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  if (Status written = out->write(bytes); !written) return written;
  return out->commit(durability);
}

Status replace_file(const std::filesystem::path& file, std::string_view bytes) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return Error{file.string() + ": is not a regular file, choose another name"};
  }
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  if (Status written = out->write(bytes); !written) return written;
  return out->commit_with_backup();
}

Status put_in_place(const std::filesystem::path& finished, const std::filesystem::path& file) {
  const int descriptor = ::open(finished.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return system_failure(file, "cannot be written");
  const bool stored = is_on_disk(descriptor);
  ::close(descriptor);
  if (!stored) return system_failure(file, "cannot be flushed to the disk");
  if (::rename(finished.c_str(), file.c_str()) != 0) return system_failure(file, "cannot be replaced");
  flush_folder_of(file);
  return {};
}

Status flush_to_disk(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return system_failure(folder, "cannot be opened");
  const bool flushed = ::syncfs(descriptor) == 0;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return flushed ? Status() : Status(system_failure(folder, "cannot be flushed to the disk"));
}

}  // namespace spoonbill
