// Tests faces whose edges are slightly outside the surface's domain, and faces whose edges are inside the
// domain although control points of the edges are outside.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <GCE2d_MakeSegment.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/face_surface.h"
#include "engine/exchange/mesh_export/tessellation.h"
#include "tests/engine/exchange/cad/kept_part.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

class ImportedEdges : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  static std::string text_of_file(const char* name) {
    return content_of(std::filesystem::path(SPOONBILL_CAD_FILES) / name);
  }

  CadModel read_text(const std::string& text) const {
    CadModel found;
    auto model = read_cad(folder_.write("model.step", text), {},
                          [&](CadSurface part) { found.surfaces.push_back(std::move(part)); });
    EXPECT_TRUE(model) << model.error().message;
    if (!model) return found;
    model->surfaces = std::move(found.surfaces);
    return std::move(model).value();
  }

  static void expect_one_solid(const CadModel& model, std::size_t faces, double volume_m3) {
    const auto solids = mesh_solids(model, {});
    ASSERT_TRUE(solids) << solids.error().message;
    ASSERT_EQ(solids->solids.size(), 1u);
    EXPECT_EQ(solids->solids[0].surface_indices.size(), faces);
    EXPECT_NEAR(solids->solids[0].volume_m3, volume_m3, 2e-4 * volume_m3);
  }

  TemporaryFolder folder_;
};

std::string with_each(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// Returns a face that is a rectangle in the parameter plane. The rectangle exceeds the domain, from 0 to 1 in
// u and from 0 to `v_end` in v, by the fraction `beyond` on each side.
TopoDS_Face overshooting_face(const opencascade::handle<Geom_Surface>& surface, double beyond, double v_end) {
  const double low = -beyond, high = 1.0 + beyond, top = v_end * (1.0 + beyond);
  const gp_Pnt2d corners[] = {{low, -beyond * v_end}, {high, -beyond * v_end}, {high, top}, {low, top}};
  BRepBuilderAPI_MakeWire wire;
  for (int k = 0; k < 4; ++k) {
    const opencascade::handle<Geom2d_TrimmedCurve> side =
        GCE2d_MakeSegment(corners[k], corners[(k + 1) % 4]).Value();
    TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(side, surface);
    BRepLib::BuildCurves3d(edge);
    wire.Add(edge);
  }
  return BRepBuilderAPI_MakeFace(surface, wire.Wire());
}

TEST_F(ImportedEdges, OvershootingTheDomainByMicrometresKeepsTheSolid) {
  const CadModel model = read_text(text_of_file("block-2um.step"));
  EXPECT_EQ(model.surfaces.size(), 6u);
  expect_one_solid(model, 6, 24000e-9);
}

TEST_F(ImportedEdges, OvershootingEveryKindOfPolynomialSurfaceIsCutOff) {
  TColgp_Array2OfPnt net(1, 2, 1, 2);
  TColgp_Array1OfPnt line(1, 2);
  for (int i = 0; i < 2; ++i) {
    line(i + 1) = gp_Pnt(40.0 * i, 0, 0);
    for (int j = 0; j < 2; ++j) net(i + 1, j + 1) = gp_Pnt(40.0 * i, 30.0 * j, 0);
  }
  const opencascade::handle<Geom_Surface> bezier = new Geom_BezierSurface(net);
  const opencascade::handle<Geom_Surface> extrusion =
      new Geom_SurfaceOfLinearExtrusion(new Geom_BezierCurve(line), gp_Dir(0, 1, 0));
  for (const double beyond : {1e-10, 1e-8, 1e-6, 5e-5}) {
    for (const auto& [surface, v_end] : {std::pair(bezier, 1.0), std::pair(extrusion, 30.0)}) {
      const auto found = convert_face(overshooting_face(surface, beyond, v_end), 1e-3, 1e-5);
      ASSERT_TRUE(found) << found.error().message << " " << beyond;
      CadSurface part;
      part.surface = found->surface;
      part.trims = found->trims;
      EXPECT_NEAR(kept_area_m2(part), 1200e-6, 1e-3 * 1200e-6);
      EXPECT_TRUE(found->trim_problem.empty()) << found->trim_problem;
    }
  }
}

TEST_F(ImportedEdges, ASkippedFaceIsPlacedAndNotCounted) {
  const CadModel model = read_text(with_each(text_of_file("block-2um.step"), "13.334000000", "1.E+300"));
  EXPECT_EQ(model.surfaces.size(), 5u);
  ASSERT_EQ(model.notes.size(), 2u);
  EXPECT_TRUE(model.notes[0].starts_with("5 of the 6 faces of a solid")) << model.notes[0];
  EXPECT_TRUE(model.notes[1].starts_with("'block 6' at (20, 15, 20) mm is skipped: ")) << model.notes[1];
}

// The outline of the bottom face touches itself where the hole reaches the rounded edge.
TEST_F(ImportedEdges, AHoleThatTouchesItsRimClosesAgain) {
  const CadModel model = read_text(text_of_file("hole-touches-rim.step"));
  expect_one_solid(model, 11, 1029.14e-9);
  const auto written = write_cad(model, {});
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(written->solids, 1);
  expect_one_solid(read_text(written->text), 11, 1029.14e-9);
}

// A dome with a wall of 1 mm, of whose mesh by OpenCASCADE alone half the wall is missing.
TEST_F(ImportedEdges, AThinDomeIsMeshedWithinItsChord) {
  const CadModel model = read_text(text_of_file("dome.step"));
  for (const double chord_m : {5e-5, 2e-5}) {
    SCOPED_TRACE(chord_m);
    const auto solids = mesh_solids(model, {chord_m});
    ASSERT_TRUE(solids) << solids.error().message;
    ASSERT_EQ(solids->solids.size(), 1u);
    const CadSolid& solid = solids->solids[0];
    EXPECT_LE(solid.chord_error_m, chord_m + solid.gap_m);
    // The faces move by at most the chord error.
    EXPECT_NEAR(enclosed_volume_m3(solid.mesh), 9803.5e-9, (chord_m + solid.gap_m) * solid.area_m2);
    EXPECT_LT(solid.mesh.triangles.size(), 100000u);
  }
}

TEST_F(ImportedEdges, ControlPointsOutsideTheDomainDoNotBendATrim) {
  const CadModel model = read_text(text_of_file("arch.step"));
  ASSERT_EQ(model.surfaces.size(), 4u);
  int ends = 0;
  for (const CadSurface& part : model.surfaces) {
    EXPECT_LT(part.trim_deviation_m, 1e-8) << part.name;
    if (part.trims.empty()) continue;
    ++ends;
    EXPECT_NEAR(kept_area_m2(part), 640e-6, 1e-3 * 640e-6);
  }
  EXPECT_EQ(ends, 2);
  EXPECT_EQ(model.notes.size(), 1u);
  expect_one_solid(model, 4, 6400e-9);
}

TEST_F(ImportedEdges, LoopsAreMeasuredAgainstTheirEdges) {
  const CadModel within = read_text(text_of_file("block-2um.step"));
  double largest_m = 0.0;
  for (const CadSurface& part : within.surfaces) largest_m = std::max(largest_m, part.trim_deviation_m);
  EXPECT_NEAR(largest_m, std::sqrt(2.0) * 2e-6, 1e-9);
  EXPECT_EQ(within.notes.size(), 1u);
}

// The surface ends at 12 mm, below the top of the arch.
TEST_F(ImportedEdges, ACurveThatLeavesTheDomainIsCutThereAndNoted) {
  std::string text = with_each(text_of_file("arch.step"), "20.000000000,", "12.000000000,");
  text = with_each(text, "(0.,20.000000)", "(0.,12.000000)");
  const CadModel model = read_text(text);
  ASSERT_EQ(model.surfaces.size(), 4u);
  // The kept area is below the arch x = 40 s^2 (3 - 2 s), y = 80 s (1 - s) and also below y = 12, with x and
  // y in mm. Quadrature gives this area.
  constexpr double area_m2 = 453.805e-6;
  int ends = 0;
  for (const CadSurface& part : model.surfaces) {
    if (part.trims.empty()) continue;
    EXPECT_GT(part.trim_deviation_m, 1e-3);
    EXPECT_NEAR(kept_area_m2(part), area_m2, 2e-3 * area_m2);
    ++ends;
  }
  EXPECT_EQ(ends, 2);
  EXPECT_GE(std::count_if(model.notes.begin(), model.notes.end(),
                          [](const std::string& note) {
                            return note.find("away from its edges") != std::string::npos;
                          }),
            2);
}

}  // namespace
}  // namespace spoonbill
