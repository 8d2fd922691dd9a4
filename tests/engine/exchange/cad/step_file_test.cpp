// Checks, with a script that reads STEP files without OpenCASCADE, that the files contain the same surfaces
// as the model.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "engine/base/text.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/cad/cad.h"
#include "tests/engine/exchange/cad/cad_surfaces.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

std::string table_of(const CadModel& model) {
  std::string table;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    const Surface& surface = model.surfaces[k].surface;
    for (const double u : uniform_parameters(surface.u, 23)) {
      for (const double v : uniform_parameters(surface.v, 23)) {
        const Vector3 at = position(surface, u, v);
        table += std::to_string(k);
        for (const double number : {u, v, at.x(), at.y(), at.z()}) table += "," + number_text(number);
        table += "\n";
      }
    }
  }
  return table;
}

double largest_distance_by_script(const CadModel& model, const CadWriting& writing,
                                  const std::string& unit_m) {
  const TemporaryFolder folder;
  const auto content = write_cad(model, writing);
  if (!content) return 1e30;
  const auto step = folder.write("model.step", content->text), table = folder.write("table", table_of(model));
  const auto out = folder.path() / "out";
  const std::string line = std::string(SPOONBILL_PYTHON) + " " + SPOONBILL_STEP_SCRIPT + " " + step.string() +
                           " " + unit_m + " " + table.string() + " >" + out.string();
  if (std::system(line.c_str()) != 0) return 1e30;
  return std::stod(content_of(out));
}

TEST(StepFile, ScipyEvaluatesTheSameSurfaces) {
  prepare_occt();
  CadModel model;
  for (const KnownSurface& known : known_surfaces()) model.surfaces.push_back(known.surface);
  // The surfaces are up to 2 m wide; the files have about fourteen digits for coordinates and knots.
  EXPECT_LT(largest_distance_by_script(model, {FileFormat::step, StepSchema::ap214, "mm"}, "0.001"), 1e-9);
  EXPECT_LT(largest_distance_by_script(model, {FileFormat::step, StepSchema::ap242, "m"}, "1"), 1e-9);
  EXPECT_LT(largest_distance_by_script(model, {FileFormat::step, StepSchema::ap214, "in"}, "0.0254"), 1e-9);
  // The script must detect a unit that is wrong by the fraction 4e-7.
  EXPECT_GT(largest_distance_by_script(model, {FileFormat::step, StepSchema::ap214, "in"}, "0.02540001"),
            1e-8);
}

}  // namespace
}  // namespace spoonbill
