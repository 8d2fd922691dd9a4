// Tests that assemblies, names and units are read from files that OpenCASCADE writes.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <IGESControl_Writer.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TDF_Label.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Trsf.hxx>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/exchange/cad/cad.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

struct Found {
  std::vector<CadSurface> surfaces;
  CadModel model;
};

Vector3 middle_of(const std::vector<CadSurface>& surfaces, const std::string& name) {
  Vector3 low = Vector3::Constant(1e30), high = -low;
  for (const CadSurface& part : surfaces) {
    if (!part.name.starts_with(name)) continue;
    for (const double u : uniform_parameters(part.surface.u, 17)) {
      for (const double v : uniform_parameters(part.surface.v, 17)) {
        const Vector3 at = position(part.surface, u, v);
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
      }
    }
  }
  return 0.5 * (low + high);
}

class CadReader : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  Found read(const std::filesystem::path& file, CadReading reading = {}) const {
    if (file.extension() == ".igs") reading.format = FileFormat::iges;
    Found found;
    auto model = read_cad(file, reading, [&](CadSurface part) { found.surfaces.push_back(std::move(part)); });
    EXPECT_TRUE(model) << model.error().message;
    if (model) found.model = std::move(model).value();
    return found;
  }

  std::filesystem::path box_in(const char* unit, const char* name) const {
    set_file_unit(unit);
    const auto file = folder_.path() / name;
    const TopoDS_Shape box = BRepPrimAPI_MakeBox(30, 20, 10).Shape();
    if (file.extension() == ".igs") {
      IGESControl_Writer writer;
      EXPECT_TRUE(writer.AddShape(box));
      EXPECT_TRUE(writer.Write(file.c_str()));
    } else {
      STEPControl_Writer writer;
      writer.Transfer(box, STEPControl_AsIs);
      writer.Write(file.c_str());
    }
    set_file_unit("mm");
    return file;
  }

  TemporaryFolder folder_;
};

gp_Trsf moved(double x, double y, double z, double turn = 0.0) {
  gp_Trsf motion;
  motion.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn);
  motion.SetTranslationPart(gp_Vec(x, y, z));
  return motion;
}

// Writes an assembly that is moved as a whole: a trolley with a deck and an axle. The axle has two wheels,
// and one of them has a name of its own.
void write_trolley(const std::filesystem::path& file) {
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto part = [&](const TopoDS_Shape& shape, const char* name) {
    const TDF_Label label = shapes->AddShape(shape, false);
    TDataStd_Name::Set(label, name);
    return label;
  };
  const auto assembly = [&](const char* name) {
    const TDF_Label label = shapes->NewShape();
    TDataStd_Name::Set(label, name);
    return label;
  };
  const TDF_Label wheel = part(BRepPrimAPI_MakeCylinder(5, 2).Shape(), "wheel");
  const TDF_Label deck = part(BRepPrimAPI_MakeBox(40, 20, 1).Shape(), "deck");
  const TDF_Label axle = assembly("axle"), trolley = assembly("trolley");
  shapes->AddComponent(axle, wheel, moved(0, 0, 0));
  TDataStd_Name::Set(shapes->AddComponent(axle, wheel, moved(0, 0, 30)), "spare wheel");
  shapes->AddComponent(trolley, axle, moved(100, 0, 0));
  shapes->AddComponent(trolley, deck, moved(0, 200, 0, 0.5 * std::numbers::pi));
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  ASSERT_TRUE(writer.Transfer(document));
  ASSERT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
}

TEST_F(CadReader, AssembliesArePlacedAndNamed) {
  const auto file = folder_.path() / "trolley.step";
  write_trolley(file);
  const Found found = read(file);
  EXPECT_EQ(found.surfaces.size(), 3u + 3u + 6u);
  const auto count = [&](const std::string& name) {
    return std::count_if(found.surfaces.begin(), found.surfaces.end(),
                         [&](const CadSurface& part) { return part.name.starts_with(name); });
  };
  EXPECT_EQ(count("wheel"), 3);
  EXPECT_EQ(count("spare wheel"), 3);
  EXPECT_EQ(count("deck"), 6);
  ASSERT_EQ(found.model.notes.size(), 1U);
  EXPECT_NE(found.model.notes[0].find("the 12 faces of 3 solids"), std::string::npos) << found.model.notes[0];
  // The wheels are cylinders with a radius of 5 mm, which are approximated. The bound is above the allowed
  // deviation.
  EXPECT_LT((middle_of(found.surfaces, "wheel") - Vector3(0.1, 0.0, 0.001)).norm(), 2e-5);
  EXPECT_LT((middle_of(found.surfaces, "spare wheel") - Vector3(0.1, 0.0, 0.031)).norm(), 2e-5);
  // The deck of 40 x 20 mm is rotated by a quarter turn about its corner, then moved.
  EXPECT_LT((middle_of(found.surfaces, "deck") - Vector3(-0.01, 0.22, 0.0005)).norm(), 1e-9);
  std::vector<std::string> names;
  for (const CadSurface& part : found.surfaces) names.push_back(part.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "names must tell faces apart";
}

TEST_F(CadReader, UnitsAreThoseDeclared) {
  for (const char* ending : {".step", ".igs"}) {
    for (const auto& [unit, name] :
         {std::pair("mm", "mm"), std::pair("cm", "cm"), std::pair("m", "m"), std::pair("in", "inch")}) {
      SCOPED_TRACE(std::string(unit) + ending);
      const auto file = box_in(unit, (std::string("box") + ending).c_str());
      const Found found = read(file);
      EXPECT_EQ(found.model.unit, name);
      EXPECT_TRUE(found.model.unit_declared);
      EXPECT_LT((middle_of(found.surfaces, "") - Vector3(0.015, 0.01, 0.005)).norm(), 1e-9);
      // `unit_m` overrides the file's unit: the file's numbers are read as centimetres.
      CadReading reading;
      reading.unit_m = 0.01;
      const double in_file = std::string(unit) == "mm"   ? 1e-3
                             : std::string(unit) == "cm" ? 1e-2
                             : std::string(unit) == "m"  ? 1.0
                                                         : 0.0254;
      const Vector3 expected = Vector3(0.015, 0.01, 0.005) * (0.01 / in_file);
      EXPECT_LT((middle_of(read(file, reading).surfaces, "") - expected).norm(), 1e-9 * 0.01 / in_file);
    }
  }
}

// Returns the text with another unit in the global section and with the same number of lines.
std::string with_unit(std::string text, const std::string& unit) {
  const std::string declared = ",1,4HINCH,";
  const std::size_t at = text.find(declared);
  EXPECT_NE(at, std::string::npos) << text.substr(0, 600);
  text.replace(at, declared.size(), unit);
  const std::size_t end = text.find_first_of("SGDP", text.find("G000000", at) - 1);
  text.insert(end, declared.size() - unit.size(), ' ');
  return text;
}

TEST_F(CadReader, AnIgesFileWithoutAUnitIsInMillimetresAndSaysSo) {
  const std::string text = content_of(box_in("in", "box.igs"));
  // The unit is missing, its flag is 0, which the standard does not define, or its name is missing or not in
  // the standard.
  for (const char* unit : {",,,", ",0,,", ",3,4HFOOT,", ",3,2Hmm,", ",3,,"}) {
    SCOPED_TRACE(unit);
    const Found found = read(folder_.write("none.igs", with_unit(text, unit)));
    EXPECT_FALSE(found.model.unit_declared);
    EXPECT_EQ(found.model.unit, "mm");
    ASSERT_FALSE(found.model.notes.empty());
    EXPECT_NE(found.model.notes[0].find("declares no unit"), std::string::npos);
    EXPECT_LT((middle_of(found.surfaces, "") - Vector3(0.015, 0.01, 0.005) / 25.4).norm(), 1e-9);
  }
}

TEST_F(CadReader, AnIgesFileMayNameItsUnit) {
  const std::string text = content_of(box_in("in", "box.igs"));
  for (const auto& [unit, metres] :
       {std::pair(",3,2HMM,", 1e-3), std::pair(",3,2HFT,", 0.3048), std::pair(",10,,", 1e-2)}) {
    SCOPED_TRACE(unit);
    const Found found = read(folder_.write("named.igs", with_unit(text, unit)));
    EXPECT_TRUE(found.model.unit_declared);
    const Vector3 in_file = Vector3(0.015, 0.01, 0.005) / 0.0254;
    EXPECT_LT((middle_of(found.surfaces, "") - metres * in_file).norm(), 1e-9);
  }
}

// OpenCASCADE skips a face that it cannot read and reports success, so the reader must count such faces.
TEST_F(CadReader, FacesThatCannotBeReadAreCounted) {
  const std::string text = content_of(box_in("mm", "box.step"));
  const std::string begin = "ADVANCED_FACE('',(";
  const std::size_t face = text.find(begin), surface = text.find(",#", text.find(')', face)) + 1;
  ASSERT_NE(face, std::string::npos);
  for (const char* other : {"#99999", "#1"}) {
    SCOPED_TRACE(other);
    std::string damaged = text;
    damaged.replace(surface, text.find(',', surface) - surface, other);
    const Found found = read(folder_.write("damaged.step", damaged));
    EXPECT_EQ(found.surfaces.size(), 5u);
    ASSERT_FALSE(found.model.notes.empty());
    EXPECT_EQ(found.model.notes[0],
              "1 of the file's 6 faces cannot be read and are missing; repair them in the CAD system");
  }
}

// Writes an assembly with two instances of one part. The part is in a file of its own, which the file of the
// assembly names. Returns the file of the assembly.
std::filesystem::path write_in_parts(const std::filesystem::path& folder) {
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label part = shapes->AddShape(BRepPrimAPI_MakeBox(40, 20, 1).Shape(), false);
  TDataStd_Name::Set(part, "deck");
  const TDF_Label whole = shapes->NewShape();
  shapes->AddComponent(whole, part, moved(0, 0, 0));
  shapes->AddComponent(whole, part, moved(0, 0, 30));
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  EXPECT_TRUE(writer.Transfer(document, STEPControl_AsIs, (folder / "part").c_str()));
  const auto file = folder / "whole.step";
  EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
  return file;
}

// OpenCASCADE would open the files that a STEP file names, whatever their path and contents.
TEST_F(CadReader, OtherFilesThatAFileNamesAreNotOpened) {
  const auto file = write_in_parts(folder_.path());
  const std::string text = content_of(file), before = "DOCUMENT_FILE('";
  ASSERT_NE(text.find(before), std::string::npos);
  const std::size_t name = text.find(before) + before.size();
  ASSERT_TRUE(std::filesystem::exists(folder_.path() / text.substr(name, text.find('\'', name) - name)));
  const auto found = read_cad(file, {}, [](const CadSurface&) { FAIL() << "a surface of another file"; });
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::missing);
  EXPECT_NE(found.error().message.find("names other files"), std::string::npos) << found.error().message;
}

// If an instance has no name, OpenCASCADE names it with a number. The reader uses the name of the part
// instead.
TEST_F(CadReader, AUseWithoutANameHasItsPartsName) {
  const auto file = folder_.path() / "trolley.step";
  write_trolley(file);
  std::string text = content_of(file);
  const std::string named = "'spare wheel'";
  for (std::size_t at = text.find(named); at != std::string::npos; at = text.find(named)) {
    text.replace(at, named.size(), "''");
  }
  const Found found = read(folder_.write("nameless.step", text));
  EXPECT_EQ(std::count_if(found.surfaces.begin(), found.surfaces.end(),
                          [](const CadSurface& part) { return part.name.starts_with("wheel"); }),
            6);
}

// One corner of the plate, which is 90 m long, is 0.5 mm off the rectangle.
TEST_F(CadReader, ASlantThatExceedsTheToleranceIsATrim) {
  BRepBuilderAPI_MakePolygon outline(gp_Pnt(0, 0, 0), gp_Pnt(90000, 0, 0), gp_Pnt(89999.5, 900, 0),
                                     gp_Pnt(0, 900, 0), true);
  const auto file = folder_.path() / "plate.step";
  STEPControl_Writer writer;
  writer.Transfer(BRepBuilderAPI_MakeFace(outline.Wire()).Shape(), STEPControl_AsIs);
  writer.Write(file.c_str());
  CadReading reading;
  for (const double tolerance_m : {1e-7, 1e-5}) {
    reading.tolerance_m = tolerance_m;
    EXPECT_EQ(read(file, reading).surfaces.at(0).trims.size(), 1u);
  }
  reading.tolerance_m = 1e-3;
  EXPECT_TRUE(read(file, reading).surfaces.at(0).trims.empty());
}

// Adds a transformation operator to the text of a STEP file. `ratios` is the text of the operator's scale and
// third axis.
std::string placed_by(std::string text, const std::string& ratios) {
  const std::size_t end = text.rfind("ENDSEC;");
  text.insert(end,
              "#9001=CARTESIAN_POINT('',(0.,0.,0.));\n#9002=DIRECTION('',(1.,0.,0.));\n"
              "#9003=DIRECTION('',(0.,1.,0.));\n#9004=DIRECTION('',(0.,0.,1.));\n"
              "#9005=DIRECTION('',(0.,0.,-1.));\n#9006=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',"
              "#9002,#9003,#9001," +
                  ratios + ");\n");
  return text;
}

TEST_F(CadReader, PlacementsThatScaleOrMirrorAreTold) {
  const std::string text = content_of(box_in("mm", "box.step"));
  const auto notes = [&](const std::string& ratios) {
    const auto told = read(folder_.write("placed.step", placed_by(text, ratios))).model.notes;
    return std::count_if(told.begin(), told.end(), [](const std::string& note) {
      return note.starts_with("placements that scale, stretch or mirror: 1, which are not read");
    });
  };
  EXPECT_EQ(notes("1.,#9004"), 0);
  EXPECT_EQ(notes("$,$"), 0);
  EXPECT_EQ(notes("2.,#9004"), 1);
  EXPECT_EQ(notes("1.,#9005"), 1);
}

TEST_F(CadReader, MoreFacesThanTheLimitAreRefused) {
  CadReading reading;
  reading.face_limit = 5;
  const auto found = read_cad(box_in("mm", "box.step"), reading, [](const CadSurface&) {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::too_many);
}

TEST_F(CadReader, AToleranceIsKeptAndReported) {
  const auto file = folder_.path() / "cylinder.step";
  STEPControl_Writer writer;
  writer.Transfer(BRepPrimAPI_MakeCylinder(50, 20).Shape(), STEPControl_AsIs);
  writer.Write(file.c_str());
  std::size_t before = 0;
  for (const double tolerance_m : {1e-4, 1e-6, 1e-8}) {
    CadReading reading;
    reading.tolerance_m = tolerance_m;
    const Found found = read(file, reading);
    double farthest = 0.0, deviation = 0.0;
    std::size_t controls = 0;
    for (const CadSurface& part : found.surfaces) {
      if (part.deviation_m == 0.0) continue;  // the deviation of the discs at the ends is 0
      deviation = part.deviation_m;
      controls = part.surface.net.size();
      for (const double u : uniform_parameters(part.surface.u, 777)) {
        const Vector3 at = position(part.surface, u, part.surface.v.domain_start());
        farthest = std::max(farthest, std::abs(std::hypot(at.x(), at.y()) - 0.05));
      }
    }
    EXPECT_GT(deviation, 0.0);
    EXPECT_LE(deviation, tolerance_m);
    // `deviation` is the largest error at nine points per piece; between them, the error may be slightly
    // larger.
    EXPECT_LE(farthest, 1.05 * deviation);
    EXPECT_GT(controls, before);
    before = controls;
  }
}

}  // namespace
}  // namespace spoonbill
