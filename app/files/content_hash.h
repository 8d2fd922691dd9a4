// Hashes of files' content, for noticing that another program has changed a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace spoonbill {

// Returns a hash of the content. Hashes can be compared only within one process.
std::uint64_t content_hash(std::string_view content);

// Returns the hash of a document file's content; empty if the file cannot be read.
std::optional<std::uint64_t> file_content_hash(const std::filesystem::path& file);

}  // namespace spoonbill
