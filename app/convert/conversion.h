// From one kind of model file to another: documents, CAD files and, to go out, meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/files/cad_file.h"
#include "app/files/length_unit.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct ConversionRequest {
  std::filesystem::path in, out;
  // Of the CAD file's numbers that come in, whatever it declares, or of those that go out.
  std::optional<LengthUnit> unit;
  std::optional<double> chord_m;      // of meshes; 0.05 mm unless told
  std::optional<double> tolerance_m;  // of what a CAD file holds and no B-spline is; 0.01 mm unless told
  std::optional<StepSchema> schema;   // AP214 unless told
  std::vector<int> bodies;            // which of them, counted from 1; all if empty
  std::filesystem::path cad_program;  // that handles CAD files; beside this one if empty
};

// What was read, what was written, and in which units.
struct ConversionReport {
  std::string unit_in, unit_out;
  bool unit_declared = true;
  std::vector<CadSurface> surfaces;
  std::optional<int> solids, open_shells;                       // of a CAD file that was written
  std::optional<std::size_t> triangles, meshes, closed_meshes;  // of a mesh file that was written
  double chord_error_m = 0.0;                                   // that the meshes keep
  std::vector<std::string> notes;
};

// The faces of one solid leave as that solid, in a CAD file and in a mesh, where they close; notes tell where
// they do not.
//
// The file's kind is the ending of its name: .json; .step, .stp, .iges, .igs; .stl, .obj, .ply, .3mf. Nothing
// stands under the name of `out` before it is whole, and a file that stood there stays as it is when
// anything fails. Refused: a mesh to come in, two documents unless bodies are chosen, options that say
// nothing to these files, and whatever the readers and writers refuse.
Result<ConversionReport> convert_file(const ConversionRequest& request, const Progress& progress);

// Whether the ending is that of a CAD file or a mesh.
bool is_exported_to(const std::filesystem::path& file);

// Bodies that stand in memory go out as convert_file() writes those of a document.
Result<ConversionReport> export_bodies(std::vector<Body> bodies, const std::filesystem::path& out,
                                       const Progress& progress);

}  // namespace spoonbill
