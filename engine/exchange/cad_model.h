// Data exchanged with CAD systems: named surfaces, joined solids, and the options of reading and writing. The
// types do not depend on OpenCASCADE.
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
  // Largest distance between the surface and the original in the file; 0 if the conversion is exact.
  double deviation_m = 0.0;
  std::vector<TrimLoop> trims;  // loops around the visible part; empty if the whole surface is visible
  // Reason why there are no trims although the file shows only a part of the surface; empty otherwise.
  std::string trim_problem;
  // Thickness of a shell whose outer side is the surface; 0 if the body is not a shell. Exported meshes
  // include the inner side and the walls of the shell, CAD files do not.
  double shell_thickness_m = 0.0;
  // Largest distance between the file's edges and the trim loops or, if the surface is untrimmed, between the
  // file's edges and the sides of the surface.
  double trim_deviation_m = 0.0;
  // Name of the solid, if the surface is one of its several faces and has no trim_problem; otherwise empty.
  std::string solid = {};
};

struct CadModel {
  std::vector<CadSurface> surfaces;
  // Unit of the file's numbers, such as "mm", "inch" or, for a unit without a known name, "3 mm".
  std::string unit;
  bool unit_declared = true;
  std::vector<std::string> notes;  // one line each
};

struct CadReading {
  FileFormat format = FileFormat::step;  // step or iges
  double unit_m = 0.0;                   // length of one unit of the file; 0: as stated in the file
  double tolerance_m = 1e-5;             // largest deviation of approximated surfaces
  // Gap up to which edges of loose faces are joined; 0: the tolerance that the file states.
  double sew_m = 0.0;
  std::size_t face_limit = 1000;  // files with more faces are refused
};

struct CadWriting {
  FileFormat format = FileFormat::step;   // step or iges
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

// Solid joined from several faces: its mesh and its measures.
struct CadSolid {
  std::string name;
  // Indices, into CadModel::surfaces, of the faces of this solid and of its cavities; ascending.
  std::vector<std::size_t> surface_indices;
  TriangleMesh mesh;  // watertight; the normals point out of the material
  // Largest distance of the mesh from the exact faces and edges, measured at samples.
  double chord_error_m = 0.0;
  double gap_m = 0.0;  // widest gap between two faces that share an edge
  double volume_m3 = 0.0, area_m2 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // centre of mass at constant density
};

struct CadSolids {
  std::vector<CadSolid> solids;
  std::vector<std::size_t> loose;  // indices of surfaces that are not part of a solid
  std::vector<std::string> notes;  // one line each
};

struct SolidMeshing {
  double chord_m = 5e-5;                    // requested chord error
  std::size_t triangle_limit = 10'000'000;  // largest number of triangles of all solids together
};

// Length limit of names in CAD files, in bytes.
inline constexpr std::size_t cad_name_bytes_limit = 200;

// Returns the name as UTF-8 of at most `bytes_limit` bytes. Control characters and bytes that are not UTF-8
// become spaces; spaces at the ends are removed. Returns `fallback` if nothing remains.
std::string clean_cad_name(const std::string& name, const std::string& fallback,
                           std::size_t bytes_limit = cad_name_bytes_limit);

// Returns cleaned names in the same order, all different: a name that occurs several times is numbered,
// "wheel 1", "wheel 2". Empty names become `fallback`.
std::vector<std::string> make_names_unique(const std::vector<std::string>& names,
                                           const std::string& fallback);

}  // namespace spoonbill
