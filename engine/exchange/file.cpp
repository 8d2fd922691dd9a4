#include "engine/exchange/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <optional>
#include <system_error>

#include "engine/exchange/sequential_file.h"

namespace spoonbill {

namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

Error failure(const std::filesystem::path& file, const char* what) {
  return Error{file.string() + ": " + what + ": " + std::generic_category().message(errno)};
}

// Errors name the file that the temporary one is to become.
Status write_and_flush(const std::filesystem::path& temporary, const std::filesystem::path& file,
                       std::optional<mode_t> mode, std::string_view content) {
  ::unlink(temporary.c_str());  // what a killed process of the same number left, or a link that waits there
  auto out = SequentialFile::create(temporary, file);
  if (!out.ok()) return out.error();
  // A mode given to open() loses what the process's mask takes away.
  if (mode && ::chmod(temporary.c_str(), *mode) != 0) return failure(file, "cannot be given its permissions");
  if (Status status = out->append(content); !status.ok()) return status;
  return out->close();
}

// A hard link first, so that the file itself is never absent; a copy where the file system has no links.
Status keep_backup(const std::filesystem::path& file) {
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

// So that the rename itself survives a power cut; file systems that cannot do this have nothing to report.
void flush_folder(const std::filesystem::path& folder) {
  const Descriptor open_folder(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (open_folder.number() >= 0) ::fsync(open_folder.number());
}

}  // namespace

Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t bytes_limit) {
  const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (in.number() < 0) {
    if (errno == ENOENT) return Error{file.string() + ": no such file"};
    return failure(file, "cannot be opened");
  }
  struct stat facts {};
  if (::fstat(in.number(), &facts) != 0) return failure(file, "cannot be examined");
  if (S_ISDIR(facts.st_mode)) return Error{file.string() + ": is a folder, name a file in it"};
  if (!S_ISREG(facts.st_mode)) return Error{file.string() + ": is not a regular file"};

  std::string content;
  content.reserve(std::min(static_cast<std::size_t>(facts.st_size), bytes_limit));
  char chunk[65536];
  for (;;) {
    const ssize_t count = ::read(in.number(), chunk, sizeof chunk);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return failure(file, "cannot be read");
    if (count == 0) break;
    content.append(chunk, static_cast<std::size_t>(count));
    if (content.size() > bytes_limit) {
      return Error{file.string() + ": is larger than " + std::to_string(bytes_limit >> 20) + " MiB"};
    }
  }
  if (content.empty()) return Error{file.string() + ": is empty"};
  return content;
}

std::string first_bytes(const std::filesystem::path& file, std::size_t count) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  std::string start(count, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(count));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  return start;
}

Status replace_file(const std::filesystem::path& file, std::string_view content) {
  std::error_code error;
  const auto state = std::filesystem::status(file, error);
  const bool exists = std::filesystem::exists(state);
  if (exists && !std::filesystem::is_regular_file(state)) {
    return Error{file.string() + ": is not a regular file, choose another name"};
  }
  const std::filesystem::path target = exists ? std::filesystem::canonical(file, error) : file;
  if (error && exists) return Error{file.string() + ": cannot be resolved: " + error.message()};

  struct stat facts {};
  std::optional<mode_t> mode;
  if (exists && ::stat(target.c_str(), &facts) == 0) mode = facts.st_mode & 0777;
  const std::filesystem::path temporary = target.string() + ".new-" + std::to_string(::getpid());
  Status status = write_and_flush(temporary, file, mode, content);
  if (status.ok() && exists) status = keep_backup(target);
  if (status.ok() && ::rename(temporary.c_str(), target.c_str()) != 0) {
    status = failure(file, "cannot be replaced");
  }
  if (!status.ok()) {
    ::unlink(temporary.c_str());
    return status;
  }
  flush_folder(target.has_parent_path() ? target.parent_path() : std::filesystem::path("."));
  return {};
}

}  // namespace spoonbill
