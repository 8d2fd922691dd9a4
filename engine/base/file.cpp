#include "engine/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace spoonbill {
namespace {

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
  std::size_t bytes() const { return bytes_; }  // when it was opened
  void set_bytes(std::size_t bytes) { bytes_ = bytes; }

 private:
  int descriptor_;
  std::size_t bytes_ = 0;
};

Error failure(const std::filesystem::path& file, const char* what) {
  return Error{file.string() + ": " + what + ": " + std::generic_category().message(errno)};
}

Error too_large(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy) {
  return Error{file.string() + ": is larger than " + std::to_string(bytes_limit >> 20) + " MiB" +
               (remedy.empty() ? "" : "; " + std::string(remedy))};
}

// A regular file. O_NONBLOCK, because opening a pipe would wait for its other end.
Result<OpenFile> open_regular(const std::filesystem::path& file) {
  OpenFile opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (opened.descriptor() < 0) {
    if (errno == ENOENT) return Error{file.string() + ": no such file"};
    return failure(file, "cannot be opened");
  }
  struct stat facts {};
  if (::fstat(opened.descriptor(), &facts) != 0) return failure(file, "cannot be examined");
  if (S_ISDIR(facts.st_mode)) return Error{file.string() + ": is a folder, name a file in it"};
  if (!S_ISREG(facts.st_mode)) return Error{file.string() + ": is not a regular file"};
  opened.set_bytes(static_cast<std::size_t>(facts.st_size));
  return Result<OpenFile>(std::move(opened));
}

}  // namespace

Status check_file(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy) {
  const auto opened = open_regular(file);
  if (!opened) return opened.error();
  if (opened->bytes() == 0) return Error{file.string() + ": is empty"};
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
    if (count < 0) return failure(file, "cannot be read");
    if (count == 0) break;
    content.append(chunk, static_cast<std::size_t>(count));
    if (content.size() > bytes_limit) return too_large(file, bytes_limit, remedy);
  }
  if (content.empty()) return Error{file.string() + ": is empty"};
  return content;
}

Result<std::ifstream> open_file(const std::filesystem::path& file) {
  const auto opened = open_regular(file);
  if (!opened) return opened.error();
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return failure(file, "cannot be opened");
  return stream;
}

std::string first_bytes(const std::filesystem::path& file, std::size_t count) {
  auto stream = open_file(file);
  if (!stream) return {};
  std::string start(count, '\0');
  stream->read(start.data(), static_cast<std::streamsize>(count));
  start.resize(static_cast<std::size_t>(stream->gcount()));
  return start;
}

std::string last_bytes(const std::filesystem::path& file, std::size_t count) {
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

}  // namespace spoonbill
