// The files that a recording asked for with `save` and `screenshot`, made again by its replay.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "render/image.h"

namespace spoonbill {

// Takes the session's marks: writes its documents into the folder, and gives the names of the pictures that
// the next frame is to be kept under. Without a folder nothing is written or kept.
Result<std::vector<std::string>> take_marks(Session& session,
                                            const std::optional<std::filesystem::path>& folder);

Status write_marked_picture(const Image& picture, const std::string& name,
                            const std::filesystem::path& folder);

}  // namespace spoonbill
