// Documents as commands read them.
#pragma once

#include <filesystem>

#include "engine/exchange/document.h"

namespace spoonbill {

// Refused by its name, with the command that makes a document of it: a CAD file, a mesh, a scan.
Status check_native_name(const std::filesystem::path& file);

// read_document() of what has such a name.
Result<Document> read_document_file(const std::filesystem::path& file);

}  // namespace spoonbill
