// STEP and IGES files, read and made by a child process with limits, which alone loads OpenCASCADE: a hostile
// file cannot take the session with it.
#pragma once

#include <chrono>
#include <filesystem>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// How the child is run.
struct CadChild {
  std::filesystem::path program;  // beside this one, if empty
  std::chrono::milliseconds patience{300'000};
  Progress progress;  // reported several times a second
};

// Refused, each with one line that names the file: missing, a folder or device, unreadable, empty, above 512
// MiB; what OpenCASCADE cannot read; what crashes it, takes it longer than the patience or more than 4 GiB;
// what read_cad() refuses; surfaces that no document could hold; when asked to stop.
Result<CadModel> read_cad_file(const std::filesystem::path& file, const CadReading& reading,
                               const CadChild& child = {});

// The text of a CAD file, to be written whole. `file` is its name in messages.
Result<CadFileContent> make_cad_file(const CadModel& model, const CadWriting& writing,
                                     const std::filesystem::path& file, const CadChild& child = {});

// Those solids of the model that several of its faces bound, as watertight meshes. `file` is the name of the
// model in messages. Refused: as make_cad_file() does; more triangles than the limit.
Result<CadSolids> make_cad_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const std::filesystem::path& file, const CadChild& child = {});

}  // namespace spoonbill
