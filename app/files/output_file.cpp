#include "app/files/output_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace spoonbill {

Result<OutputFile> OutputFile::create(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool exists = std::filesystem::exists(status);
  const bool replaces = !exists || std::filesystem::is_regular_file(status);
  std::filesystem::path target = exists && replaces ? std::filesystem::canonical(path, ignored) : path;
  if (ignored) target = path;
  std::filesystem::path written = target;
  if (replaces) {
    written += ".unfinished-" + std::to_string(getpid());
    std::filesystem::remove(written, ignored);
  }
  // Exclusively, so that nobody's link under that name is followed.
  std::FILE* file = std::fopen(written.c_str(), replaces ? "wbxe" : "wbe");
  if (file == nullptr) return Error{path.string() + ": cannot be written: " + std::strerror(errno)};
  if (exists && replaces) fchmod(fileno(file), static_cast<mode_t>(status.permissions()) & 0777);
  return OutputFile(path, std::move(target), std::move(written), file);
}

OutputFile::OutputFile(std::filesystem::path path, std::filesystem::path target,
                       std::filesystem::path written, std::FILE* file)
    : path_(std::move(path)), target_(std::move(target)), written_(std::move(written)), file_(file) {}

OutputFile::OutputFile(OutputFile&& other) noexcept = default;

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  file_.reset();
  std::error_code ignored;
  if (written_ != target_) std::filesystem::remove(written_, ignored);
}

Error OutputFile::failure(std::string_view what) const {
  return Error{path_.string() + ": " + std::string(what) + ": " + std::strerror(errno)};
}

Status OutputFile::write(std::string_view text) {
  if (text.empty()) return {};  // it may have no address, which fwrite must have
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    return failure("cannot be written");
  }
  return {};
}

Status OutputFile::commit() {
  const bool stored = written_ == target_ ? std::fflush(file_.get()) == 0
                                          : std::fflush(file_.get()) == 0 && fsync(fileno(file_.get())) == 0;
  if (!stored) return failure("cannot be written");
  if (written_ != target_ && std::rename(written_.c_str(), target_.c_str()) != 0) {
    return failure("cannot be replaced");
  }
  file_.reset();
  return {};
}

}  // namespace spoonbill
