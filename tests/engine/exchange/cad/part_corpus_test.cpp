// Tests parts as people make them, 12 families in five sizes each: each is imported, meshed, exported and
// imported again. The references are OpenCASCADE's triangles of the original; its integrals over faces with
// curved outlines are up to 2 % wrong.
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepOffsetAPI_MakePipe.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Circ.hxx>
#include <numbers>
#include <string>
#include <vector>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/mesh_export/tessellation.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/cad/occt_shapes.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill::part_corpus {
namespace {

constexpr int size_count = 5;
constexpr double import_tolerance_m = 1e-5, chord_m = 5e-5;

gp_Ax2 upright(double x, double y, double z) {
  return {gp_Pnt(x, y, z), gp_Dir(0, 0, 1)};
}

TopoDS_Wire polygon(const std::vector<gp_Pnt>& corners) {
  BRepBuilderAPI_MakePolygon maker;
  for (const gp_Pnt& corner : corners) maker.Add(corner);
  maker.Close();
  return maker.Wire();
}

TopoDS_Shape turned(const TopoDS_Wire& profile) {
  return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(profile).Shape(), gp_Ax1()).Shape();
}

TopoDS_Shape thin_dome(int size) {
  const auto half = [](double radius) {
    return BRepPrimAPI_MakeSphere(radius, 0.0, std::numbers::pi / 2).Shape();
  };
  const double radius = 10.0 + 10.0 * size;
  return BRepAlgoAPI_Cut(half(radius), half(radius - 0.5 - 0.2 * size)).Shape();
}

TopoDS_Shape thin_cup(int size) {
  const double radius = 8.0 + 4.0 * size, wall = 0.4 + 0.3 * size;
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(upright(0, 0, 0), radius, 30.0).Shape(),
                         BRepPrimAPI_MakeCylinder(upright(0, 0, wall), radius - wall, 30.0).Shape())
      .Shape();
}

TopoDS_Shape rounded_box(int size) {
  return rounded(BRepPrimAPI_MakeBox(20.0 + 5.0 * size, 15.0, 10.0).Shape(), 0.5 + 0.8 * size);
}

// A plate with bores: up to 100 in the sizes that are tried, so with up to 106 faces.
TopoDS_Shape perforated_plate(int size) {
  static constexpr int rows[size_count] = {2, 4, 7, 10, 15};
  const int count = rows[size];
  TopoDS_Shape plate = BRepPrimAPI_MakeBox(4.0 * count, 4.0 * count, 2.0).Shape();
  TopoDS_Compound bores;
  BRep_Builder().MakeCompound(bores);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      BRep_Builder().Add(
          bores, BRepPrimAPI_MakeCylinder(upright(4.0 * i + 2.0, 4.0 * j + 2.0, -1.0), 1.2, 4.0).Shape());
    }
  }
  return BRepAlgoAPI_Cut(plate, bores).Shape();
}

// A bore that ends 0.01 to 1 mm beside a rounded edge.
TopoDS_Shape bore_beside_rim(int size) {
  static constexpr double beside[size_count] = {1.0, 0.3, 0.1, 0.03, 0.01};
  return BRepAlgoAPI_Cut(rounded(BRepPrimAPI_MakeBox(20.0, 15.0, 6.0).Shape(), 1.0),
                         BRepPrimAPI_MakeCylinder(upright(10.0, 6.0 + beside[size], -1.0), 5.0, 8.0).Shape())
      .Shape();
}

TopoDS_Shape grooved_shaft(int size) {
  std::vector<gp_Pnt> profile = {{0, 0, 0}};
  const int grooves = 2 + 4 * size;
  for (int k = 0; k < grooves; ++k) {
    profile.emplace_back(3.0, 0, 1.0 * k);
    profile.emplace_back(2.4, 0, 1.0 * k + 0.5);
  }
  profile.emplace_back(3.0, 0, 1.0 * grooves);
  profile.emplace_back(0, 0, 1.0 * grooves);
  return turned(polygon(profile));
}

TopoDS_Shape bent_pipe(int size) {
  const std::vector<gp_Pnt> spine = {
      {0, 0, 0}, {0, 0, 15}, {4.0 * size, 0, 30}, {8.0 * size, 5, 45}, {8.0 * size, 5, 60}};
  const TopoDS_Wire circle =
      BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(upright(0, 0, 0), 1.5 + 0.5 * size)));
  return BRepOffsetAPI_MakePipe(BRepBuilderAPI_MakeWire(spline_edge(spine)),
                                BRepBuilderAPI_MakeFace(circle).Shape())
      .Shape();
}

TopoDS_Shape loft(int size) {
  BRepOffsetAPI_ThruSections maker(true, false);
  for (int k = 0; k < 4; ++k) {
    const double radius = 5.0 + 2.0 * std::sin(1.0 * k * (size + 1));
    maker.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(upright(0, 0, 10.0 * k), radius))));
  }
  return maker.Shape();
}

TopoDS_Shape thin_vase(int size) {
  const double wall = 0.5 + 0.3 * size;
  std::vector<gp_Pnt> outer, inner;
  for (int k = 0; k <= 6; ++k) {
    const double radius = 10.0 + 3.0 * std::sin(0.9 * k + size);
    outer.emplace_back(radius, 0, 6.0 * k);
    inner.emplace_back(radius - wall, 0, 6.0 * k);
  }
  BRepBuilderAPI_MakeWire wire(spline_edge(outer), BRepBuilderAPI_MakeEdge(outer.back(), inner.back()).Edge(),
                               spline_edge(inner));
  wire.Add(BRepBuilderAPI_MakeEdge(inner.front(), outer.front()).Edge());
  return turned(wire.Wire());
}

TopoDS_Shape spline_pocket(int size) {
  std::vector<gp_Pnt> outline;
  const int corners = 5 + 2 * size;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / corners, radius = k % 2 == 0 ? 8.0 : 5.0;
    outline.emplace_back(15.0 + radius * std::cos(angle), 15.0 + radius * std::sin(angle), 4.0);
  }
  const TopoDS_Shape pocket =
      BRepPrimAPI_MakePrism(
          BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(spline_edge(outline, true)).Wire()).Shape(),
          gp_Vec(0, 0, 10))
          .Shape();
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(30.0, 30.0, 10.0).Shape(), pocket).Shape();
}

TopoDS_Shape loose_faces(int size) {
  TopoDS_Compound compound;
  BRep_Builder().MakeCompound(compound);
  for (TopExp_Explorer each(rounded_box(size), TopAbs_FACE); each.More(); each.Next())
    BRep_Builder().Add(compound, BRepBuilderAPI_Copy(each.Current()).Shape());
  return compound;
}

struct Family {
  const char* name;
  TopoDS_Shape (*make)(int size);
  const char* unit = "mm";
  TopoDS_Shape (*reference)(int size) = nullptr;  // if it differs from the part
  // False for a part that is no solid once it has been exported and imported: the side of a pipe that ends
  // within the tolerance of its caps gets a trim loop with both runs of its seam, which are not joined.
  bool returns = true;
  // Sizes that are tried. With 225 bores, a plate has more chords than trim loops may have. The outlines of
  // some pockets are up to 0.4 mm beside their edges once they are imported.
  Range<int> sizes{0, size_count - 1};
};

constexpr Family families[] = {
    {"ThinDome", thin_dome},
    {"ThinCup", thin_cup},
    {"RoundedBox", rounded_box},
    {"PerforatedPlate", perforated_plate, "mm", nullptr, true, {0, 3}},
    {"BoreBesideRim", bore_beside_rim},
    {"GroovedShaftInInches", grooved_shaft, "in"},
    {"BentPipe", bent_pipe, "mm", nullptr, false},
    {"Loft", loft},
    {"ThinVase", thin_vase},
    {"SplinePocketInMetres", spline_pocket, "m", nullptr, true, {2, 2}},
    {"LooseFaces", loose_faces, "mm", rounded_box},
    {"GroovedShaft", grooved_shaft},
};

struct Measures {
  double volume_m3 = 0.0, area_m2 = 0.0;
};

// Deflection of the triangles that are measured: a tenth of the chord error of the meshes under test.
constexpr double reference_deflection_mm = 5e-3;

Measures measure(const TopoDS_Shape& shape) {
  const BRepMesh_IncrementalMesh mesher(shape, reference_deflection_mm, false, 0.1);
  Measures sum;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
    TopLoc_Location location;
    const auto triangles = BRep_Tool::Triangulation(TopoDS::Face(each.Current()), location);
    const double sign = each.Current().Orientation() == TopAbs_REVERSED ? -1.0 : 1.0;
    for (int k = 1; k <= triangles->NbTriangles(); ++k) {
      std::array<int, 3> nodes{};
      triangles->Triangle(k).Get(nodes[0], nodes[1], nodes[2]);
      std::array<gp_Vec, 3> corners;
      for (std::size_t c = 0; c < 3; ++c)
        corners[c] = gp_Vec(triangles->Node(nodes[c]).Transformed(location).XYZ());
      sum.area_m2 += 0.5e-6 * (corners[1] - corners[0]).CrossMagnitude(corners[2] - corners[0]);
      sum.volume_m3 += sign / 6.0 * 1e-9 * corners[0].Dot(corners[1].Crossed(corners[2]));
    }
  }
  return sum;
}

class PartCorpus : public testing::TestWithParam<Family> {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  CadModel read(const std::filesystem::path& file) const {
    std::vector<CadSurface> surfaces;
    auto model = read_cad(file, {}, [&](CadSurface part) { surfaces.push_back(std::move(part)); });
    EXPECT_TRUE(model) << model.error().message;
    if (!model) return {};
    model->surfaces = std::move(surfaces);
    return std::move(model).value();
  }

  CadModel imported(const TopoDS_Shape& shape, const char* unit) const {
    set_file_unit(unit);
    const auto file = folder_.path() / "in.step";
    STEPControl_Writer writer;
    EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
    EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
    set_file_unit("mm");
    return read(file);
  }

  // Expects one watertight solid with the measures of the original, within what the import and the reference
  // approximate.
  void expect_solid(const CadModel& model, std::size_t faces, const Measures& whole) const {
    EXPECT_EQ(model.surfaces.size(), faces);
    const auto solids = mesh_solids(model, {chord_m});
    ASSERT_TRUE(solids) << solids.error().message;
    EXPECT_EQ(solids->notes, std::vector<std::string>());
    EXPECT_TRUE(solids->loose.empty());
    ASSERT_EQ(solids->solids.size(), 1u);
    const CadSolid& solid = solids->solids[0];
    const double near_m = import_tolerance_m + 1e-3 * reference_deflection_mm;
    EXPECT_NEAR(solid.volume_m3, whole.volume_m3, 1.1 * near_m * whole.area_m2);
    EXPECT_NEAR(solid.area_m2, whole.area_m2, 5e-3 * whole.area_m2);
    EXPECT_LE(solid.chord_error_m, chord_m + solid.gap_m);
    EXPECT_NEAR(enclosed_volume_m3(solid.mesh), whole.volume_m3, 1.1 * (chord_m + near_m) * whole.area_m2);
  }

  TemporaryFolder folder_;
};

TEST_P(PartCorpus, ComesInMeshesAndGoesOut) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  const Family& family = GetParam();
  for (int size = family.sizes.low; size <= family.sizes.high; ++size) {
    if (!is_long_run() && size != 2) continue;
    SCOPED_TRACE("size " + std::to_string(size));
    const TopoDS_Shape part = family.make(size);
    const Measures whole = measure(family.reference != nullptr ? family.reference(size) : part);
    const auto faces = static_cast<std::size_t>(count_of(part, TopAbs_FACE));
    const CadModel model = imported(part, family.unit);
    expect_solid(model, faces, whole);
    const auto content = write_cad(model, {});
    ASSERT_TRUE(content) << content.error().message;
    EXPECT_EQ(content->solids, 1);
    const auto out = folder_.write("out.step", content->text);
    const TopoDS_Shape written = shape_in<STEPControl_Reader>(out);
    EXPECT_EQ(count_of(written, TopAbs_SOLID), 1);
    EXPECT_EQ(count_of(written, TopAbs_FACE), static_cast<int>(faces));
    if (family.returns) expect_solid(read(out), faces, whole);
  }
}

// Trim loops of so many bores are refused, and the faces are whole.
TEST(PartWithManyBores, IsNoSolidWithoutThem) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  prepare_occt();
  const TemporaryFolder folder;
  const CadModel model = read_through_step(perforated_plate(4), folder.path());
  const auto whole = std::count_if(model.surfaces.begin(), model.surfaces.end(),
                                   [](const CadSurface& part) { return !part.trim_problem.empty(); });
  EXPECT_EQ(whole, 2);
  const auto solids = mesh_solids(model, {chord_m});
  ASSERT_TRUE(solids) << solids.error().message;
  EXPECT_TRUE(solids->solids.empty());
}

INSTANTIATE_TEST_SUITE_P(Parts, PartCorpus, testing::ValuesIn(families),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace spoonbill::part_corpus
