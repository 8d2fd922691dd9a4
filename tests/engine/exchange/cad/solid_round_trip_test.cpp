// Tests that solids whose faces are imported as one surface each are exported as solids.
#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <cmath>

#include "engine/exchange/cad/cad.h"
#include "tests/engine/exchange/cad/occt_shapes.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

// The volume may differ by this fraction: faces are approximated to 0.01 mm on parts of 10 to 40 mm.
constexpr double volume_share = 2e-3;

double volume_mm3(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-6);
  return properties.Mass();
}

class SolidRoundTrip : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  CadModel read(const TopoDS_Shape& shape) const { return read_through_step(shape, folder_.path()); }

  CadFileContent write(const CadModel& model, FileFormat format = FileFormat::step) const {
    const auto content = write_cad(model, {format, StepSchema::ap214, "mm"});
    EXPECT_TRUE(content) << content.error().message;
    return content ? content.value() : CadFileContent();
  }

  TopoDS_Shape shape_of(const CadFileContent& content, FileFormat format = FileFormat::step) const {
    const auto file = folder_.write("out", content.text);
    return format == FileFormat::step ? shape_in<STEPControl_Reader>(file)
                                      : shape_in<IGESControl_Reader>(file);
  }

  void expect_same_solids(const TopoDS_Shape& shape, FileFormat format) const {
    const CadFileContent content = write(read(shape), format);
    EXPECT_EQ(content.notes, std::vector<std::string>());
    const TopoDS_Shape back = shape_of(content, format);
    EXPECT_TRUE(BRepCheck_Analyzer(back).IsValid());
    EXPECT_EQ(count_of(back, TopAbs_SOLID), count_of(shape, TopAbs_SOLID));
    EXPECT_EQ(count_of(back, TopAbs_SHELL), count_of(shape, TopAbs_SHELL));
    EXPECT_EQ(content.solids, count_of(shape, TopAbs_SOLID));
    EXPECT_EQ(content.open_shells, 0);
    EXPECT_NEAR(volume_mm3(back), volume_mm3(shape), volume_share * volume_mm3(shape));
  }

  TemporaryFolder folder_;
};

TEST_F(SolidRoundTrip, SolidsOfManyFacesComeBackWhole) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    for (const NamedShape& named : every_second(solid_shapes(), format == FileFormat::iges)) {
      if (count_of(named.shape, TopAbs_SOLID) == 0) continue;
      SCOPED_TRACE(named.name + (format == FileFormat::step ? ", STEP" : ", IGES"));
      expect_same_solids(named.shape, format);
    }
  }
}

TEST_F(SolidRoundTrip, CavitiesStayCavities) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    for (const NamedShape& named : hollow_solids()) {
      SCOPED_TRACE(named.name + (format == FileFormat::step ? ", STEP" : ", IGES"));
      EXPECT_EQ(count_of(named.shape, TopAbs_SHELL), 2);
      expect_same_solids(named.shape, format);
    }
  }
}

// The model is a box with a ball-shaped cavity, from which all surfaces except the cavity's are removed. The
// shell of the cavity encloses no material.
TEST_F(SolidRoundTrip, ACavityByItselfIsNoSolid) {
  CadModel model = read(hollow_solids()[1].shape);
  ASSERT_EQ(model.surfaces.size(), 7u);
  std::erase_if(model.surfaces, [](const CadSurface& part) { return part.surface.net.size() <= 4; });
  ASSERT_EQ(model.surfaces.size(), 1u);
  const CadFileContent content = write(model);
  EXPECT_EQ(content.solids, 0);
  EXPECT_EQ(content.open_shells, 1);
  const TopoDS_Shape back = shape_of(content);
  EXPECT_EQ(count_of(back, TopAbs_SOLID), 0);
  EXPECT_LT(volume_mm3(back), 0.0);
}

TEST_F(SolidRoundTrip, FacesThatDoNotCloseKeepTheirNames) {
  CadModel model = read(BRepPrimAPI_MakeBox(30, 20, 10).Shape());
  ASSERT_EQ(model.surfaces.size(), 6u);
  for (const CadSurface& part : model.surfaces) EXPECT_EQ(part.solid, "solid");
  model.surfaces.pop_back();
  const CadFileContent content = write(model);
  EXPECT_EQ(content.solids, 0);
  EXPECT_EQ(content.open_shells, 5);
  EXPECT_EQ(content.notes,
            std::vector<std::string>{
                "5 of the 5 faces of 'solid' together enclose no volume; they are written one by one"});
  for (const CadSurface& part : model.surfaces) {
    EXPECT_NE(content.text.find("'" + part.name + "'"), std::string::npos);
  }
}

// The two solids have the same name, as after a copy of the bodies in a document.
TEST_F(SolidRoundTrip, TwoSolidsOfOneNameAreTwo) {
  CadModel model = read(BRepPrimAPI_MakeBox(30, 20, 10).Shape());
  const std::vector<CadSurface> first = model.surfaces;
  for (CadSurface part : first) {
    for (double& x : part.surface.net.x) x += 0.1;
    part.name += " again";
    model.surfaces.push_back(std::move(part));
  }
  const CadFileContent content = write(model);
  EXPECT_EQ(content.solids, 2);
  EXPECT_NEAR(volume_mm3(shape_of(content)), 2.0 * 6000.0, 1e-6);
}

}  // namespace
}  // namespace spoonbill
