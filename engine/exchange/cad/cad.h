// Reader and writer of STEP and IGES files, and meshes of their solids, through OpenCASCADE. Its settings
// belong to the whole process and a hostile file can take the process over, so call these functions in a
// child process with limits, prepare_occt() before all others. Each Error says what is wrong, without the
// file's name.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Makes OpenCASCADE print nothing, compute in millimetres, and change no geometry by its own choice. Call
// once.
void prepare_occt();

// Settings of OpenCASCADE for files written later; write_cad() sets both itself. `unit` is mm, cm, m or in.
void set_step_schema(StepSchema schema);
void set_file_unit(std::string_view unit);

using SurfaceSink = std::function<void(CadSurface)>;

// Passes the surface of each face of the file, as assemblies place it, to the sink, one after the other.
// Returns the unit and the notes of the whole file, without surfaces. Notes report an unknown unit, faces
// that OpenCASCADE lost or that cannot be converted, other files that this one names, none of which is
// opened, and solids that are separated into faces. Refused: a file that OpenCASCADE cannot read, without
// faces that can be converted, or with more faces than the limit.
Result<CadModel> read_cad(const std::filesystem::path& file, const CadReading& reading,
                          const SurfaceSink& sink, const Progress& progress = {});

// Returns the text of a file. Each surface becomes a product of its name in STEP: a MANIFOLD_SOLID_BREP where
// it closes, an open shell otherwise. In IGES it becomes a named entity: 186 where it closes, 128 where not,
// 144 for each face where it is trimmed. Faces of one solid are joined under its name where they close. A
// surface that find_closing() calls closed is written exactly closed. Notes report by how much it was open,
// surfaces that would close and are no solid, and bridged gaps between the faces of a solid.
Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing,
                                 const Progress& progress = {});

// Meshes the solids that write_cad() joins of the surfaces that name one; all other surfaces are loose.
// Surfaces of which OpenCASCADE makes no solid, or a solid without a watertight mesh, are loose too, with a
// note. Refused: more triangles than the limit.
Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing,
                              const Progress& progress = {});

}  // namespace spoonbill
