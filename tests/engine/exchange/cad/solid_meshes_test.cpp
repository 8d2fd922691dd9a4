// Tests meshes of whole solids whose faces are imported as one surface each.
#include <gtest/gtest.h>

#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <map>
#include <utility>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/shape_mesh.h"
#include "engine/exchange/mesh_export/tessellation.h"
#include "tests/engine/exchange/cad/occt_shapes.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

constexpr double usual_chord_m = 5e-5;
constexpr double cubic_mm = 1e-9, square_mm = 1e-6;
// Tolerance at which the import approximates faces that are not B-splines.
constexpr double import_tolerance_m = 1e-5;

struct Measures {
  double volume_m3 = 0.0, area_m2 = 0.0;
};

Measures measures_of(const TopoDS_Shape& shape) {
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(shape, volume, 1e-6);
  BRepGProp::SurfaceProperties(shape, area, 1e-6);
  return {volume.Mass() * cubic_mm, area.Mass() * square_mm};
}

// Expects each edge to belong to two triangles, which use it in opposite directions.
void expect_watertight(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++ways[{corners[k], corners[(k + 1) % 3]}];
  }
  EXPECT_FALSE(ways.empty());
  int bad = 0;
  for (const auto& [way, count] : ways) {
    const auto back = ways.find({way.second, way.first});
    bad += count != 1 || back == ways.end() || back->second != 1 ? 1 : 0;
  }
  EXPECT_EQ(bad, 0);
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const TriangleCorners& corners : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[corners[0]], b = mesh.vertices_m[corners[1]],
                  c = mesh.vertices_m[corners[2]];
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

class SolidMeshes : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  CadSolids meshed(const TopoDS_Shape& shape, double chord_m) const {
    const auto solids = mesh_solids(read_through_step(shape, folder_.path()), {chord_m});
    EXPECT_TRUE(solids) << solids.error().message;
    return solids ? solids.value() : CadSolids();
  }

  void expect_solid(const TopoDS_Shape& shape, double chord_m) const {
    const CadSolids solids = meshed(shape, chord_m);
    EXPECT_EQ(solids.notes, std::vector<std::string>());
    EXPECT_TRUE(solids.loose.empty());
    ASSERT_EQ(solids.solids.size(), 1u);
    const CadSolid& solid = solids.solids[0];
    EXPECT_EQ(solid.surface_indices.size(), static_cast<std::size_t>(count_of(shape, TopAbs_FACE)));
    expect_watertight(solid.mesh);
    EXPECT_LE(solid.chord_error_m, chord_m + solid.gap_m);
    const Measures whole = measures_of(shape);
    // A surface displaced by at most an error changes the volume by at most the product of this error and the
    // area; a tenth is added for curvature. Inward normals would change the sign of the volume.
    const double moved_m = 1.1 * (solid.chord_error_m + import_tolerance_m);
    EXPECT_NEAR(enclosed_volume_m3(solid.mesh), whole.volume_m3, moved_m * whole.area_m2);
    EXPECT_NEAR(solid.volume_m3, whole.volume_m3, 1.1 * import_tolerance_m * whole.area_m2);
    // With the usual chord error of 0.05 mm, the area of the mesh differs by less than 1 % from the area of
    // the solid.
    if (chord_m > usual_chord_m) return;
    EXPECT_NEAR(solid.area_m2, area_of(solid.mesh), 1e-2 * solid.area_m2);
  }

  TemporaryFolder folder_;
};

TEST_F(SolidMeshes, ADrilledBoxIsWatertightWithinItsChord) {
  for (const double chord_m : {1e-3, 5e-5, 5e-6}) {
    SCOPED_TRACE(chord_m);
    expect_solid(drilled_box(), chord_m);
  }
  EXPECT_GT(meshed(drilled_box(), 5e-6).solids[0].mesh.triangles.size(),
            meshed(drilled_box(), 1e-3).solids[0].mesh.triangles.size());
}

TEST_F(SolidMeshes, SolidsOfManyFacesAreWatertight) {
  for (const NamedShape& named : every_second(solid_shapes(), false)) {
    // A solid with a single face is not imported as several surfaces, so it is skipped here.
    if (count_of(named.shape, TopAbs_SOLID) == 0 || count_of(named.shape, TopAbs_FACE) < 2) continue;
    SCOPED_TRACE(named.name);
    expect_solid(named.shape, usual_chord_m);
  }
}

// OpenCASCADE's own meshes of a sphere, a cone or a pipe are farther from their faces than their deflection.
TEST_F(SolidMeshes, ShapesOfOpenCascadeAreMeshedWithinTheChord) {
  for (const NamedShape& named : every_second(solid_shapes(), true)) {
    if (count_of(named.shape, TopAbs_SOLID) == 0) continue;
    SCOPED_TRACE(named.name);
    const auto found = mesh_shape(named.shape, usual_chord_m, 1'000'000);
    ASSERT_TRUE(found) << found.error().message;
    if (!found.value()) continue;  // a shape whose faces are placed, as those of imported solids are not
    expect_watertight(found.value()->mesh);
    EXPECT_LE(found.value()->chord_error_m, usual_chord_m);
    const Measures whole = measures_of(named.shape);
    EXPECT_NEAR(enclosed_volume_m3(found.value()->mesh), whole.volume_m3, usual_chord_m * whole.area_m2);
  }
}

TEST_F(SolidMeshes, CavitiesAreHollow) {
  for (const NamedShape& named : hollow_solids()) {
    SCOPED_TRACE(named.name);
    expect_solid(named.shape, usual_chord_m);
  }
}

TEST_F(SolidMeshes, TwoSolidsStayTwo) {
  TopoDS_Compound both;
  BRep_Builder().MakeCompound(both);
  BRep_Builder().Add(both, drilled_box());
  BRep_Builder().Add(both, BRepPrimAPI_MakeBox(gp_Pnt(50, 0, 0), 10, 10, 10).Shape());
  const CadSolids solids = meshed(both, usual_chord_m);
  ASSERT_EQ(solids.solids.size(), 2u);
  EXPECT_NE(solids.solids[0].name, solids.solids[1].name);
  EXPECT_NEAR(enclosed_volume_m3(solids.solids[1].mesh), 1000.0 * cubic_mm, 1e-3 * cubic_mm);
  EXPECT_NEAR((solids.solids[1].centre_m - Vector3(0.055, 0.005, 0.005)).norm(), 0.0, 1e-9);
}

TEST_F(SolidMeshes, WhatDoesNotCloseIsLoose) {
  CadModel model = read_through_step(drilled_box(), folder_.path());
  const std::size_t faces = model.surfaces.size();
  CadSurface alone = model.surfaces.back();
  alone.solid.clear();
  model.surfaces.back() = alone;
  const auto solids = mesh_solids(model, {});
  ASSERT_TRUE(solids) << solids.error().message;
  EXPECT_TRUE(solids->solids.empty());
  EXPECT_EQ(solids->loose.size(), faces);
  ASSERT_EQ(solids->notes.size(), 1u);
  EXPECT_NE(solids->notes[0].find("together enclose no volume"), std::string::npos);
}

TEST_F(SolidMeshes, NoMoreTrianglesThanTheLimit) {
  const auto refused = mesh_solids(read_through_step(drilled_box(), folder_.path()), {usual_chord_m, 20});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::too_many) << refused.error().message;
}

}  // namespace
}  // namespace spoonbill
