// What comes from a CAD system or goes to one: named surfaces and what is known of them. Plain data.
#pragma once

#include <string>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {

enum class StepSchema { ap214, ap242 };

struct CadSurface {
  std::string name;
  Surface surface;
  // The largest distance found between the surface and the file's own; 0 where it was taken as it stands.
  double deviation_m = 0.0;
  std::vector<TrimLoop> trims;  // of the part that the file shows, if that is less than the surface
  // Why there are none although the file shows less; empty otherwise.
  std::string trim_problem;
  double shell_thickness_m = 0.0;  // of material behind it; 0: none. Meshes have its walls, CAD files do not
  std::string solid = {};  // the name of that which it is one of several faces of; empty of what stands alone
};

struct CadModel {
  std::vector<CadSurface> surfaces;
  std::string unit;  // of the file's numbers: "mm", "inch", or as the file names it
  bool unit_declared = true;
  std::vector<std::string> notes;  // a line each
};

struct CadReading {
  FileFormat format = FileFormat::step;  // or iges
  double unit_m = 0.0;                   // of the file's numbers, whatever it declares; 0: as declared
  double tolerance_m = 1e-5;             // of what is approximated
  std::size_t face_limit = 1000;         // files of more are refused
};

struct CadWriting {
  FileFormat format = FileFormat::step;   // or iges
  StepSchema schema = StepSchema::ap214;  // of STEP
  std::string unit = "mm";                // mm, cm, m or in
};

// A file's text and what stands in it.
struct CadFileContent {
  std::string text;
  int solids = 0;
  int open_shells = 0;
  std::vector<std::string> notes;
};

}  // namespace spoonbill
