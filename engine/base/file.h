// Whole files in memory, with an error line for everything that a file system can do to them. What is written
// goes through output_file.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// Checks what read_file() refuses before it reads: a missing file, a folder, a device or pipe, one that this
// process may not read, an empty one, one of more than `bytes_limit`, of which `remedy` says what to do
// ("reduce the mesh"). The error begins with the file's name. Does not wait for the other end of a pipe.
Status check_file(const std::filesystem::path& file, std::size_t bytes_limit, std::string_view remedy = {});

// Returns the file's bytes. Refuses what check_file() refuses, and a file that cannot be read to its end.
Result<std::string> read_file(const std::filesystem::path& file, std::size_t bytes_limit,
                              std::string_view remedy = {});

// Opens a regular file that is read in pieces, because it may be larger than the memory that it is worth.
// Refused: a missing file, a folder, a device or pipe, one that this process may not read.
Result<std::ifstream> open_file(const std::filesystem::path& file);

// Returns at most `count` bytes from the start, or the end, of a regular file, to recognise it by; nothing
// where it is missing or something else.
std::string first_bytes(const std::filesystem::path& file, std::size_t count);
std::string last_bytes(const std::filesystem::path& file, std::size_t count);

}  // namespace spoonbill
