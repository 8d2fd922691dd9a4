#include "app/files/foreign_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace spoonbill {

Status check_foreign_file(const std::filesystem::path& file, std::size_t bytes_limit,
                          const std::string& smaller) {
  const std::string name = file.string();
  const int opened = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (opened < 0) {
    if (errno == ENOENT) return Error{name + ": no such file"};
    return Error{name + ": cannot be opened: " + std::generic_category().message(errno)};
  }
  struct stat facts {};
  const bool examined = ::fstat(opened, &facts) == 0;
  ::close(opened);
  if (!examined) return Error{name + ": cannot be examined: " + std::generic_category().message(errno)};
  if (S_ISDIR(facts.st_mode)) return Error{name + ": is a folder, name a file in it"};
  if (!S_ISREG(facts.st_mode)) return Error{name + ": is not a regular file"};
  if (facts.st_size == 0) return Error{name + ": is empty"};
  if (static_cast<std::size_t>(facts.st_size) > bytes_limit) {
    return Error{name + ": is larger than " + std::to_string(bytes_limit >> 20) + " MiB; " + smaller};
  }
  return {};
}

Error explain_end(const std::filesystem::path& file, const ChildEnd& end, std::chrono::milliseconds patience,
                  const std::string& thing, const std::string& smaller) {
  const std::string name = file.string();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(patience).count();
  if (end.out_of_time) {
    return Error{name + ": reading it took longer than " + std::to_string(seconds) + " s; " + smaller};
  }
  if (end.signal != 0) {
    return Error{name + ": the reader crashed on it (signal " + std::to_string(end.signal) +
                 "); the file is damaged, export it anew"};
  }
  return Error{name + ": the reader ended without a " + thing + " (exit code " +
               std::to_string(end.exit_code) + "); export it anew"};
}

}  // namespace spoonbill
