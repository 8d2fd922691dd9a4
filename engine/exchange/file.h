// Whole files in and out of memory, with an error line for everything a file system can do to them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// Refused, each with its own line: missing, a directory or device, unreadable, empty, above `bytes_limit`.
Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t bytes_limit);

// At most so many bytes from its start, to tell what it is; none where it is missing, or no regular file:
// opening a pipe would wait for one who writes.
std::string first_bytes(const std::filesystem::path& file, std::size_t count);

// Writes beside the file, flushes to the disk and renames, so that a crash at any moment leaves the old
// content or the new one, whole. The old content stays as FILE.bak, its permissions
// are kept. A link is followed to what it names.
Status replace_file(const std::filesystem::path& file, std::string_view content);

}  // namespace spoonbill
