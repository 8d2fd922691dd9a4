// What a file of the program's own holds, by its content; its name says nothing.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

enum class FileKind { document, recording, script, material };

// Refused: a file that cannot be read, or is none of these.
Result<FileKind> kind_of_file(const std::filesystem::path& file);

}  // namespace spoonbill
