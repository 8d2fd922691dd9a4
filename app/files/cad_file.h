// STEP and IGES files, read and written by the child process spoonbill-cad. Only the child loads OpenCASCADE,
// and its time and memory are limited, so that a hostile file cannot crash the session.
#pragma once

#include <chrono>
#include <filesystem>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// The settings of the child process.
struct CadChild {
  std::filesystem::path program;  // program to run; default: spoonbill-cad in this program's folder
  std::chrono::milliseconds patience{300'000};  // time limit of the child
  Progress progress;                            // receives the progress several times a second
};

// Reads a CAD file of at most 512 MiB. Every error names the file. Errors: a file that is missing,
// unreadable, empty or malformed; a child that crashes, runs out of time or needs more than 4 GiB; what
// read_cad() rejects; a surface that no document can hold; a request to stop.
Result<CadModel> read_cad_file(const std::filesystem::path& file, const CadReading& reading,
                               const CadChild& child = {});

// Returns the content of a CAD file that holds the model. In messages, `file` names the model; nothing is
// written to it.
Result<CadFileContent> make_cad_file(const CadModel& model, const CadWriting& writing,
                                     const std::filesystem::path& file, const CadChild& child = {});

// Joins the faces of each solid that consists of several surfaces, and returns these solids as watertight
// meshes. In messages, `file` names the model. Errors: those of make_cad_file(), more triangles than the
// limit.
Result<CadSolids> make_cad_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const std::filesystem::path& file, const CadChild& child = {});

}  // namespace spoonbill
