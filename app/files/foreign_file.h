// What files of other programs have in common, which a child process reads.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>

#include "app/process/child_output.h"
#include "engine/base/result.h"

namespace spoonbill {

// Refused, each with one line that names the file: missing, a folder or device, unreadable, empty, above the
// limit, of which `smaller` is the remedy ("reduce the mesh").
Status check_foreign_file(const std::filesystem::path& file, std::size_t bytes_limit,
                          const std::string& smaller);

// Why a child that should have handed back a `thing` ended without one.
Error explain_end(const std::filesystem::path& file, const ChildEnd& end, std::chrono::milliseconds patience,
                  const std::string& thing, const std::string& smaller);

}  // namespace spoonbill
