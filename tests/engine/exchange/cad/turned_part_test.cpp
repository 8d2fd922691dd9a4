// Tests merging of the faces of a turned part from a CAD system: faces of revolution, and between them discs
// and rings, which are planes trimmed by circles.
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Writer.hxx>
#include <gp_Ax2.hxx>

#include "engine/exchange/cad/cad.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/surface_check.h"
#include "engine/merging/merge.h"
#include "engine/merging/trimmed_patch.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

double volume_m3(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-6);
  return 1e-9 * properties.Mass();
}

std::vector<Surface> whole_faces_of(const TopoDS_Shape& shape) {
  const TemporaryFolder folder;
  prepare_occt();
  set_file_unit("mm");
  const auto file = folder.path() / "part.step";
  STEPControl_Writer writer;
  EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
  std::vector<Surface> faces;
  const auto model = read_cad(file, {}, [&](const CadSurface& part) {
    auto whole = untrimmed(part.surface, part.trims, 1e-5);
    EXPECT_TRUE(whole) << part.name << ": " << whole.error().message;
    if (whole) faces.push_back(std::move(whole)->surface);
  });
  EXPECT_TRUE(model) << model.error().message;
  return faces;
}

void expect_one_closed_body(const TopoDS_Shape& shape, std::size_t face_count) {
  const std::vector<Surface> faces = whole_faces_of(shape);
  ASSERT_EQ(faces.size(), face_count);
  MergeRequest request;
  request.join.continuity = 0;
  const auto merged = merge(faces, request);
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_LE(merged->deviation_m, request.join.tolerance_m);
  EXPECT_EQ(find_closing(merged->surface).closedness, Closedness::solid);
  // The sides are about 10 mm from the axis, and the import may move them by about 0.01 mm inwards or
  // outwards.
  EXPECT_NEAR(std::abs(compute_enclosed_mass(merged->surface).volume_m3) / volume_m3(shape), 1.0, 2e-3);
}

TEST(TurnedPart, ACylinderAndAConeAreOneBodyEach) {
  expect_one_closed_body(BRepPrimAPI_MakeCylinder(20, 40).Shape(), 3);
  expect_one_closed_body(BRepPrimAPI_MakeCone(20, 10, 40).Shape(), 3);
}

TEST(TurnedPart, AShaftWithAShoulderIsOneBody) {
  const TopoDS_Shape thick = BRepPrimAPI_MakeCylinder(20, 40).Shape();
  const TopoDS_Shape thin =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 40), gp_Dir(0, 0, 1)), 10, 30).Shape();
  expect_one_closed_body(BRepAlgoAPI_Fuse(thick, thin).Shape(), 5);
}

TEST(TurnedPart, ACupIsOneBody) {
  const TopoDS_Shape block = BRepPrimAPI_MakeCylinder(20, 40).Shape();
  const TopoDS_Shape bore =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 5), gp_Dir(0, 0, 1)), 16, 40).Shape();
  expect_one_closed_body(BRepAlgoAPI_Cut(block, bore).Shape(), 5);
}

}  // namespace
}  // namespace spoonbill
