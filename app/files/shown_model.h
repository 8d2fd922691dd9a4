// Models of any kind that the program reads, for a picture of them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/files/length_unit.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/scene/scene.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Largest number of points of a cloud that are drawn, as discs.
inline constexpr std::size_t shown_point_limit = 60'000;

// Model as a picture shows it.
struct ShownModel {
  Snapshot snapshot;               // bodies at rest, without lattices
  std::optional<Ground> ground;    // the ground on which the bodies of a document stand
  std::vector<std::string> notes;  // what the picture does not show, and units taken; one line each
};

// Reads a document, the model of a recording or of a script, the faces of a CAD file, a mesh or a cloud of
// points. A cloud is shown as discs. `unit` is that of the numbers in meshes and clouds; default: metres for
// PLY and PCD, millimetres for others. Errors name the file: those of the readers, a file without
// anything to show, and a model smaller than 0.001 mm.
Result<ShownModel> read_shown_model(const std::filesystem::path& file, const std::optional<LengthUnit>& unit,
                                    const Progress& progress);

// Returns the bodies of a scene as they are. `source` names their file in messages.
Result<ShownModel> show_scene(const Scene& scene, const std::filesystem::path& source);

}  // namespace spoonbill
