// Tests that surfaces are the same after export to STEP or IGES and import; OpenCASCADE checks the bodies in
// the files.
#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/iges_file.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/cad_stream.h"
#include "engine/inspection/surface_check.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/exchange/cad/cad_surfaces.h"
#include "tests/engine/exchange/cad/occt_shapes.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

// Coordinates in the files have about fourteen digits in millimetres; the surfaces are up to 2 m wide.
constexpr double file_tolerance_m = 1e-9;

class CadRoundTrip : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  std::filesystem::path write(const CadModel& model, const CadWriting& writing) const {
    const auto content = write_cad(model, writing);
    EXPECT_TRUE(content) << content.error().message;
    return folder_.write(writing.format == FileFormat::step ? "model.step" : "model.iges",
                         content ? content->text : "");
  }

  static std::vector<CadSurface> read(const std::filesystem::path& file, CadReading reading) {
    std::vector<CadSurface> surfaces;
    const auto model = read_cad(file, reading, [&](CadSurface s) { surfaces.push_back(std::move(s)); });
    EXPECT_TRUE(model) << model.error().message;
    return surfaces;
  }

  void expect_round_trip(const KnownSurface& known, const CadWriting& writing) const {
    SCOPED_TRACE(known.surface.name + ", " + writing.unit);
    CadModel model;
    model.surfaces.push_back(known.surface);
    CadReading reading;
    reading.format = writing.format;
    const auto back = read(write(model, writing), reading);
    ASSERT_EQ(back.size(), 1u);
    EXPECT_EQ(back[0].name, known.surface.name);
    EXPECT_EQ(back[0].deviation_m, 0.0);
    EXPECT_TRUE(back[0].trims.empty());
    EXPECT_EQ(back[0].trim_problem, "");
    // A face of a solid is exported with its normals outwards, whatever the surface's orientation.
    const bool turned = known.closes && volume_by_quadrature_m3(known.surface.surface) < 0.0;
    if (turned) {
      EXPECT_NEAR(volume_by_quadrature_m3(back[0].surface), -volume_by_quadrature_m3(known.surface.surface),
                  1e-12);
    } else {
      EXPECT_LT(largest_distance_m(known.surface.surface, back[0].surface), file_tolerance_m);
    }
  }

  TemporaryFolder folder_;
};

TEST_F(CadRoundTrip, EverySurfaceComesBackFromStep) {
  for (const KnownSurface& known : known_surfaces()) {
    expect_round_trip(known, {FileFormat::step, StepSchema::ap214, "mm"});
    expect_round_trip(known, {FileFormat::step, StepSchema::ap242, "in"});
  }
}

TEST_F(CadRoundTrip, EverySurfaceComesBackFromIges) {
  for (const KnownSurface& known : known_surfaces()) {
    for (const char* unit : {"mm", "in", "m", "cm"}) {
      expect_round_trip(known, {FileFormat::iges, StepSchema::ap214, unit});
    }
  }
}

TEST_F(CadRoundTrip, PeriodicTubesComeBackPeriodicWithTheSameControlPoints) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    for (const Surface& surface : {ellipsoid_tube(9, 12), torus_like(0.04, 0.012)}) {
      CadModel model;
      model.surfaces.push_back({"tube", surface, 0.0, {}, {}});
      CadReading reading;
      reading.format = format;
      const auto back = read(write(model, {format, StepSchema::ap214, "mm"}), reading);
      ASSERT_EQ(back.size(), 1u);
      ASSERT_EQ(back[0].surface.u.is_periodic(), surface.u.is_periodic());
      ASSERT_EQ(back[0].surface.v.is_periodic(), surface.v.is_periodic());
      ASSERT_EQ(back[0].surface.net.size(), surface.net.size());
      for (std::size_t k = 0; k < surface.net.size(); ++k) {
        EXPECT_NEAR(back[0].surface.net.x[k], surface.net.x[k], 1e-12);
        EXPECT_NEAR(back[0].surface.net.z[k], surface.net.z[k], 1e-12);
      }
    }
  }
}

TEST_F(CadRoundTrip, NamesAndTheirOrderAreKept) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    CadModel model;
    const std::vector<std::string> names = {"handle",
                                            "a long name with spaces, 'quotes' and (brackets)",
                                            "L\xc3\xb6"
                                            "ffel \xe5\x8c\x99",
                                            "back\\slash",
                                            "FACEPLATE",
                                            "WIRE rack",
                                            "SOLID oak",
                                            "4711"};
    for (const std::string& name : names) model.surfaces.push_back({name, ellipsoid_tube(8, 8), 0.0, {}, {}});
    CadReading reading;
    reading.format = format;
    const auto back = read(write(model, {format, StepSchema::ap214, "mm"}), reading);
    ASSERT_EQ(back.size(), names.size());
    for (std::size_t k = 0; k < names.size(); ++k) EXPECT_EQ(back[k].name, names[k]);
  }
}

TEST_F(CadRoundTrip, LongNamesAreStillToldApart) {
  // Most letters of the name have two bytes. Single bytes between them shift the letters, so that a line
  // break or a cut would fall inside one.
  std::string name = "\xf0\x9f\xa5\x84 ";
  while (name.size() < 190) name += name.size() % 3 == 0 ? "a" : "\xc3\xb6";
  CadModel model;
  for (int k = 0; k < 3; ++k) model.surfaces.push_back({name, ellipsoid_tube(8, 8), 0.0, {}, {}});
  const auto back = read(write(model, {}), {});
  ASSERT_EQ(back.size(), 3u);
  for (const CadSurface& part : back) {
    EXPECT_LE(part.name.size(), 200u);
    EXPECT_TRUE(part.name.starts_with(name.substr(0, 180))) << part.name;
    EXPECT_TRUE(cad_surface_from_json(json_to_line(cad_surface_to_json(part)), "file"));
  }
  EXPECT_NE(back[0].name, back[1].name);
  EXPECT_NE(back[1].name, back[2].name);
}

TEST_F(CadRoundTrip, StepFilesHoldOnlyAscii) {
  CadModel model;
  model.surfaces.push_back(
      {"L\xc3\xb6"
       "ffel",
       ellipsoid_tube(8, 8),
       0.0,
       {},
       {}});
  const auto content = write_cad(model, {});
  ASSERT_TRUE(content);
  for (const char letter : content->text) EXPECT_GE(letter, 0);
  EXPECT_NE(content->text.find("L\\X2\\00F6\\X0\\ffel"), std::string::npos);
}

TEST_F(CadRoundTrip, BodiesThatCloseAreValidSolidsOfTheirVolume) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    for (const KnownSurface& known : known_surfaces()) {
      SCOPED_TRACE(known.surface.name + (format == FileFormat::step ? ", STEP" : ", IGES"));
      CadModel model;
      model.surfaces.push_back(known.surface);
      const auto content = write_cad(model, {format, StepSchema::ap214, "mm"});
      ASSERT_TRUE(content) << content.error().message;
      EXPECT_EQ(content->solids, known.closes ? 1 : 0);
      EXPECT_EQ(content->open_shells, known.closes ? 0 : 1);
      EXPECT_TRUE(content->notes.empty());
      const auto file = folder_.write("solid", content->text);
      const TopoDS_Shape shape = format == FileFormat::step ? shape_in<STEPControl_Reader>(file)
                                                            : shape_in<IGESControl_Reader>(file);
      EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
      EXPECT_EQ(TopExp_Explorer(shape, TopAbs_SOLID).More(), known.closes);
      if (!known.closes) continue;
      GProp_GProps properties;
      BRepGProp::VolumeProperties(shape, properties, 1e-8);
      const double ours = std::abs(volume_by_quadrature_m3(known.surface.surface));
      // Our volume is exact except for rounding if the pieces are cubic; OpenCASCADE's adaptive quadrature
      // has a tolerance of 1e-8.
      EXPECT_NEAR(properties.Mass() * 1e-9, ours, 1e-6 * ours);
      EXPECT_GT(properties.Mass(), 0.0);
    }
  }
}

// Parameter 20 of the global section in IGES 5.3 is the largest coordinate; CAD systems size their models by
// it.
TEST_F(CadRoundTrip, IgesFilesTellTheirLargestCoordinate) {
  for (const auto& [unit, metres] : {std::pair("mm", 1e-3), std::pair("in", 0.0254)}) {
    for (const KnownSurface& known : known_surfaces()) {
      SCOPED_TRACE(known.surface.name);
      CadModel model;
      model.surfaces.push_back(known.surface);
      const auto file = write(model, {FileFormat::iges, StepSchema::ap214, unit});
      const auto parameters = read_iges_global_parameters(file);
      ASSERT_GT(parameters.size(), 19u);
      double largest_m = 0.0, largest_control_m = 0.0;
      const Surface& surface = known.surface.surface;
      for (const double u : uniform_parameters(surface.u, 40)) {
        for (const double v : uniform_parameters(surface.v, 40)) {
          largest_m = std::max(largest_m, position(surface, u, v).cwiseAbs().maxCoeff());
        }
      }
      for (const auto* coordinates : {&surface.net.x, &surface.net.y, &surface.net.z}) {
        for (const double x : *coordinates) largest_control_m = std::max(largest_control_m, std::abs(x));
      }
      const double told_m = metres * std::strtod(parameters[19].c_str(), nullptr);
      // OpenCASCADE computes the largest coordinate from bounding boxes, which contain the surface and are
      // inside the box of its control points. The bounds allow for OpenCASCADE's margin of 1e-7 mm and for
      // the seven digits in the file.
      EXPECT_GE(told_m, largest_m * (1.0 - 1e-6));
      EXPECT_LE(told_m, largest_control_m * (1.0 + 1e-5));
    }
  }
}

TEST_F(CadRoundTrip, FilesSayTheProgramAndNotThePerson) {
  CadModel model;
  model.surfaces.push_back({"tube", ellipsoid_tube(8, 8), 0.0, {}, {}});
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    const std::string text = write_cad(model, {format, StepSchema::ap214, "mm"})->text;
    EXPECT_NE(text.find("Spoonbill"), std::string::npos);
    // OpenCASCADE writes these words unless the program replaces them.
    for (const char* word : {"'Author'", "Open CASCADE Model", "Filename.iges"}) {
      EXPECT_EQ(text.find(word), std::string::npos) << word;
    }
  }
  const std::string text = write_cad(model, {FileFormat::iges, StepSchema::ap214, "mm"})->text;
  // Parameter 21 is the author and parameter 22 the organization.
  const auto parameters = read_iges_global_parameters(folder_.write("named.igs", text));
  ASSERT_GT(parameters.size(), 22u);
  EXPECT_EQ(parameters[20], "");
  EXPECT_EQ(parameters[21], "");
}

TEST_F(CadRoundTrip, SchemaAndUnitAreDeclared) {
  CadModel model;
  model.surfaces.push_back({"tube", ellipsoid_tube(8, 8), 0.0, {}, {}});
  const auto text = [&](StepSchema schema, const char* unit) {
    return write_cad(model, {FileFormat::step, schema, unit})->text;
  };
  EXPECT_NE(text(StepSchema::ap214, "mm").find("AUTOMOTIVE_DESIGN"), std::string::npos);
  EXPECT_NE(text(StepSchema::ap242, "mm").find("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING"),
            std::string::npos);
  EXPECT_NE(text(StepSchema::ap214, "mm").find("SI_UNIT(.MILLI.,.METRE.)"), std::string::npos);
  EXPECT_NE(text(StepSchema::ap214, "m").find("SI_UNIT($,.METRE.)"), std::string::npos);
  EXPECT_NE(text(StepSchema::ap214, "cm").find("SI_UNIT(.CENTI.,.METRE.)"), std::string::npos);
  EXPECT_NE(text(StepSchema::ap214, "in").find("'INCH'"), std::string::npos);
}

TEST(CadStream, SurfacesComeBackToTheBit) {
  for (const KnownSurface& known : known_surfaces()) {
    CadSurface surface = known.surface;
    surface.deviation_m = 1.0 / 3.0;
    surface.trim_deviation_m = 2e-6;
    surface.trim_problem = known.closes ? "none" : "";
    const auto back = cad_surface_from_json(json_to_line(cad_surface_to_json(surface)), "file");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->name, surface.name);
    EXPECT_EQ(back->deviation_m, surface.deviation_m);
    EXPECT_EQ(back->trim_problem, surface.trim_problem);
    EXPECT_EQ(back->trim_deviation_m, 2e-6);
    EXPECT_EQ(back->surface.u, surface.surface.u);
    EXPECT_EQ(back->surface.v, surface.surface.v);
    EXPECT_EQ(back->surface.net.x, surface.surface.net.x);
    EXPECT_EQ(back->surface.net.y, surface.surface.net.y);
    EXPECT_EQ(back->surface.net.z, surface.surface.net.z);
  }
}

TEST(CadNames, SharedOnesAreNumberedAndNoTwoEqual) {
  EXPECT_EQ(make_names_unique({"a", "b", "", "a", ""}, "x"),
            (std::vector<std::string>{"a 1", "b", "x 1", "a 2", "x 2"}));
  EXPECT_EQ(make_names_unique({"a", "a", "a 1"}, "x"), (std::vector<std::string>{"a 2", "a 3", "a 1"}));
  const auto apart = make_names_unique(std::vector<std::string>(11, std::string(300, 'n')), "x");
  for (const std::string& name : apart) EXPECT_LE(name.size(), 200u);
  EXPECT_NE(apart[0], apart[10]);
}

TEST(CadNames, AreCleaned) {
  // U+009B is a control character, which terminals act on.
  EXPECT_EQ(clean_cad_name("a\xc2\x9bz", "x"), "a z");
  EXPECT_EQ(clean_cad_name("  a\nb\t ", "x"), "a b");
  EXPECT_EQ(clean_cad_name("", "x"), "x");
  EXPECT_EQ(clean_cad_name("\x01\x7f", "x"), "x");
  EXPECT_EQ(clean_cad_name("a\xff\xfe", "x"), "a");
  // The three bytes are the code of a surrogate, which UTF-8 forbids.
  EXPECT_EQ(clean_cad_name("a\xed\xa0\x80z", "x"), "a   z");
  EXPECT_EQ(clean_cad_name(std::string(300, 'a'), "x").size(), 200u);
  // The name is not cut inside a letter of several bytes.
  EXPECT_EQ(clean_cad_name(std::string(199, 'a') + "\xc3\xb6", "x").size(), 199u);
}

// The control points of one pole are slightly apart.
TEST_F(CadRoundTrip, WhatACheckCallsClosedIsASolidAndSaysWhatItMisses) {
  Surface pole = ellipsoid_tube(10, 10);
  pole.net.set_point(3, 0, pole.net.point(3, 0) + Vector3(2e-8, 0, 0));
  ASSERT_EQ(find_closing(pole).closedness, Closedness::solid);
  CadModel model;
  model.surfaces.push_back({"tube", pole, 0.0, {}, ""});
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    const auto content = write_cad(model, {format, StepSchema::ap214, "mm"});
    ASSERT_TRUE(content) << content.error().message;
    EXPECT_EQ(content->solids, 1);
    EXPECT_EQ(content->open_shells, 0);
    ASSERT_EQ(content->notes.size(), 1u);
    EXPECT_NE(content->notes[0].find("'tube' is open by "), std::string::npos) << content->notes[0];
    EXPECT_NE(content->notes[0].find("; it is written closed"), std::string::npos) << content->notes[0];
  }
}

// The two edges at the seam are slightly apart, as after cutting a surface that is closed only by the
// coincidence of its edges.
TEST_F(CadRoundTrip, ASeamThatIsALittleApartIsClosed) {
  const Surface closed = torus_like(0.02, 0.005);
  Surface open = part_of(closed, Direction::u, closed.u.domain_start(), closed.u.domain_end()).value();
  ASSERT_FALSE(open.u.is_periodic());
  for (int j = 0; j < open.net.columns; ++j) {
    open.net.set_point(0, j, open.net.point(0, j) + Vector3(2e-8, 0, 0));
  }
  ASSERT_EQ(find_closing(open).closedness, Closedness::solid);
  CadModel model;
  model.surfaces.push_back({"ring", open, 0.0, {}, ""});
  const auto content = write_cad(model, {FileFormat::step, StepSchema::ap214, "mm"});
  ASSERT_TRUE(content) << content.error().message;
  EXPECT_EQ(content->solids, 1);
}

}  // namespace
}  // namespace spoonbill
