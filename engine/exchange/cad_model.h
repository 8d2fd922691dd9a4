// Data exchanged with CAD systems: named surfaces, joined solids, and the options of reading and writing.
// Plain data without OpenCASCADE.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {

enum class StepSchema { ap214, ap242 };

struct CadSurface {
  std::string name;
  Surface surface;
  // Largest distance found between the surface and the file's own; 0 where it was taken over exactly.
  double deviation_m = 0.0;
  std::vector<TrimLoop> trims;  // loops around the visible part; empty where the whole surface is visible
  // Reason why there are no trims although the file shows only a part; empty otherwise.
  std::string trim_problem;
  // Thickness of the material behind the surface; 0: none. Meshes get its walls, CAD files do not.
  double shell_thickness_m = 0.0;
  std::string solid = {};  // name of the solid that the surface is one of several faces of; empty without one
};

struct CadModel {
  std::vector<CadSurface> surfaces;
  std::string unit;  // of the file's numbers: "mm", "inch", or as the file names it
  bool unit_declared = true;
  std::vector<std::string> notes;  // one line each
};

struct CadReading {
  FileFormat format = FileFormat::step;  // or iges
  double unit_m = 0.0;                   // length of one of the file's numbers; 0: as the file declares
  double tolerance_m = 1e-5;             // largest deviation of approximated surfaces
  std::size_t face_limit = 1000;         // files of more faces are refused
};

struct CadWriting {
  FileFormat format = FileFormat::step;   // or iges
  StepSchema schema = StepSchema::ap214;  // for STEP only
  std::string unit = "mm";                // mm, cm, m or in
};

// Text of a CAD file and a summary of its content.
struct CadFileContent {
  std::string text;
  int solids = 0;
  int open_shells = 0;
  std::vector<std::string> notes;
};

// Solid joined of several faces, as a mesh and in numbers.
struct CadSolid {
  std::string name;
  // Indices of its faces into the model's surfaces, ascending; the faces of its cavities are included.
  std::vector<std::size_t> places;
  TriangleMesh mesh;           // watertight; normals out of the material
  double chord_error_m = 0.0;  // largest distance of samples of its faces and edges from their triangles
  double gap_m = 0.0;          // widest gap between two faces that one edge joins
  double volume_m3 = 0.0, area_m2 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // centre of mass at constant density
};

struct CadSolids {
  std::vector<CadSolid> solids;
  std::vector<std::size_t> loose;  // indices of surfaces that are faces of no solid
  std::vector<std::string> notes;  // one line each
};

struct SolidMeshing {
  double chord_m = 5e-5;
  std::size_t triangle_limit = 10'000'000;  // of all solids together
};

// Longest name that CAD files get, in bytes.
inline constexpr std::size_t cad_name_bytes_limit = 200;

// Returns the name as UTF-8 of at most `bytes_limit` bytes, with blanks for control characters and for bytes
// that are not UTF-8, and without blanks at its ends. Returns `fallback` where nothing is left.
std::string clean_cad_name(const std::string& name, const std::string& fallback,
                           std::size_t bytes_limit = cad_name_bytes_limit);

// Returns cleaned names in the same order, no two of them equal: names that several share get a number,
// "wheel 1", "wheel 2". Empty names become `fallback`.
std::vector<std::string> make_names_unique(const std::vector<std::string>& names,
                                           const std::string& fallback);

}  // namespace spoonbill
