// STEP and IGES files to surfaces. What a hostile file does to OpenCASCADE it does to this process: call it
// in a child with limits.
#pragma once

#include <filesystem>
#include <functional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad/cad_writer.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

using TakeSurface = std::function<void(CadSurface)>;

// Hands over the surface of each face of the file, as assemblies place it, one after the other, and returns
// what is said of all together, with no surfaces: notes tell of a unit that is not known, of faces that
// OpenCASCADE lost or that are no surfaces of ours, of other files that this one names, none of which is
// opened, and of solids whose faces come apart. prepare_occt() must have been called. Refused: what
// OpenCASCADE cannot read, a file without faces that can be taken, or with more than the limit. The Error
// says what is wrong, without the file's name.
Result<CadModel> read_cad(const std::filesystem::path& file, const CadReading& reading,
                          const TakeSurface& take, const Progress& progress = {});

}  // namespace spoonbill
