#include "engine/exchange/sequential_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace spoonbill {

Result<SequentialFile> SequentialFile::create(const std::filesystem::path& file) {
  return create(file, file);
}

Result<SequentialFile> SequentialFile::create(const std::filesystem::path& file,
                                              std::filesystem::path named) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  SequentialFile result(std::move(named), descriptor);
  if (descriptor < 0) return result.failure("cannot be written");
  return result;
}

SequentialFile::SequentialFile(std::filesystem::path named, int descriptor)
    : named_(std::move(named)), descriptor_(descriptor) {}

SequentialFile::SequentialFile(SequentialFile&& other) noexcept
    : named_(std::move(other.named_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

SequentialFile& SequentialFile::operator=(SequentialFile&& other) noexcept {
  std::swap(named_, other.named_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

SequentialFile::~SequentialFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Error SequentialFile::failure(const char* what) const {
  return Error{named_.string() + ": " + what + ": " + std::generic_category().message(errno)};
}

Status SequentialFile::append(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor_, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failure("cannot be written");
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Status SequentialFile::close() {
  const bool flushed = ::fsync(descriptor_) == 0 || errno == EINVAL || errno == EROFS;  // pipes have no disk
  if (!flushed) return failure("cannot be flushed to the disk");
  if (::close(std::exchange(descriptor_, -1)) != 0) return failure("cannot be closed");
  return {};
}

}  // namespace spoonbill
