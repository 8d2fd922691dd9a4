// Conversion between model files: documents and CAD files are read and written, meshes are written.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/files/cad_file.h"
#include "app/files/length_unit.h"
#include "engine/base/file.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct ConversionRequest {
  std::filesystem::path in, out;
  // Unit of the numbers in the CAD file that is read, or in the file that is written. Replaces the unit that
  // a CAD file declares.
  std::optional<LengthUnit> unit;
  std::optional<double> chord_m;      // chord error of meshes; default: 0.05 mm
  bool allow_deviation = false;       // whether meshes may be farther away from the surfaces than that
  std::optional<double> tolerance_m;  // tolerance for CAD geometry that is not a B-spline; default: 0.01 mm
  std::optional<double> sew_m;        // gap up to which loose faces are joined; default: the file's tolerance
  std::optional<StepSchema> schema;   // schema of a STEP file; default: AP214
  std::vector<int> bodies;            // bodies to convert, numbered from 1; all if empty
  OutputOptions how;                  // how `out` replaces an existing file
  std::filesystem::path cad_program;  // program of the CAD child, see CadChild::program
};

struct ConversionReport {
  std::string unit_in, unit_out;
  bool unit_declared = true;  // false if the CAD file declared no unit
  std::vector<CadSurface> surfaces;
  std::optional<int> solids, open_shells;                       // counts in the CAD file that was written
  std::optional<std::size_t> triangles, meshes, closed_meshes;  // counts in the mesh file that was written
  double chord_error_m = 0.0;  // upper bound of the chord errors of all meshes
  std::vector<std::string> notes;
};

// Converts a file to another format. The extension selects the format: .json; .step, .stp, .iges, .igs; .stl,
// .obj, .ply, .3mf.
//
// In CAD files and meshes, the faces of one solid are joined if they enclose a volume; otherwise a note
// reports that the solid is open. `out` appears complete or not at all; on an error an existing file stays as
// it is. Errors: a mesh as input; two documents without a choice of bodies; options that have no effect on
// these formats; a mesh that misses its chord error; errors of the readers and writers.
Result<ConversionReport> convert_file(const ConversionRequest& request, const Progress& progress);

// Returns true if the extension is that of a CAD file or a mesh.
bool is_exported_to(const std::filesystem::path& file);

// Writes bodies that are in memory, as convert_file() writes the bodies of a document.
Result<ConversionReport> export_bodies(std::vector<Body> bodies, const std::filesystem::path& out,
                                       const Progress& progress);

}  // namespace spoonbill
