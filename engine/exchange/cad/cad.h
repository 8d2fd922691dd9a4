// Reader and writer of STEP and IGES files, and meshes of their solids, through OpenCASCADE. OpenCASCADE's
// settings apply to the whole process, and a hostile file can take over the process. Therefore call these
// functions only in a child process with limits, and call prepare_occt() before the others. Each Error says
// what is wrong, without the file's name.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Makes OpenCASCADE print nothing, compute in millimetres, and keep geometry as it is. Call once.
void prepare_occt();

// set_step_schema() and set_file_unit() set options of OpenCASCADE for files that are written later;
// write_cad() calls both. `unit` is mm, cm, m or in.
void set_step_schema(StepSchema schema);
void set_file_unit(std::string_view unit);

using SurfaceSink = std::function<void(CadSurface)>;

// Reads the faces of a file. Passes the surface of each face to the sink, one after the other, at the
// position given by the file's assemblies. Returns the unit and the notes of the whole file, without
// surfaces.
//
// Notes report an unknown unit, faces that OpenCASCADE lost or that cannot be converted, and faces whose
// outline differs from their edges in the file by more than the tolerance. They also report references to
// other files, which are not opened, and solids that are separated into faces. Refused: a file that
// OpenCASCADE cannot read, a file without faces that can be converted, and a file with more faces than the
// limit. Faces that belong to no solid are joined to one if they enclose it (CadReading::sew_m).
Result<CadModel> read_cad(const std::filesystem::path& file, const CadReading& reading,
                          const SurfaceSink& sink, const Progress& progress = {});

// Returns the text of a file. In STEP each surface becomes a product with the surface's name: a
// MANIFOLD_SOLID_BREP if the surface closes, otherwise an open shell. In IGES it becomes a named entity: type
// 186 if the surface closes, 128 if it does not, 144 for each face of a trimmed surface. The faces of one
// solid are joined into a solid with its name if they enclose it. A surface that find_closing() classifies as
// solid is written exactly closed. Notes report by how much such a surface was open. They also report
// surfaces that would close but are not written as solids, bridged gaps between the faces of a solid, and
// bodies that are left out because OpenCASCADE cannot make a shape of them. Refused: a model of which nothing
// can be written.
Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing,
                                 const Progress& progress = {});

// Joins the surfaces that have the same CadSurface::solid into solids, as write_cad() does, and meshes these
// solids. All other surfaces are returned as loose. Surfaces that OpenCASCADE cannot join are loose too, as
// are the surfaces of a solid without a watertight mesh; notes report them. Refused: more triangles than the
// limit.
Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing,
                              const Progress& progress = {});

}  // namespace spoonbill
