// A file being written. A regular file appears under its name whole, at commit(), or not at all; one that it
// replaces gives it its permissions, and a link is followed to what it names. A device or pipe is written as
// it is. One owner, one thread. Errors name the file.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

class OutputFile {
 public:
  static Result<OutputFile> create(const std::filesystem::path& path);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();  // an uncommitted file is removed

  // Errors may show as late as commit().
  Status write(std::string_view text);
  Status commit();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  OutputFile(std::filesystem::path path, std::filesystem::path target, std::filesystem::path written,
             std::FILE* file);
  Error failure(std::string_view what) const;

  std::filesystem::path path_;     // as it was named
  std::filesystem::path target_;   // what it names
  std::filesystem::path written_;  // beside the target, or the target itself for devices and pipes
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace spoonbill
