// Tests reading of IGES files that are damaged or unusual.
#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <IGESControl_Writer.hxx>
#include <algorithm>
#include <string>
#include <vector>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/file_report.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

// The fields of an entity that differ between tests. Each test makes a file of a few entities.
struct Entity {
  int type = 128;
  std::string parameters;
  int placement = 0;    // number of the entity that holds the transformation, counted from 1; 0: none
  int subordinate = 0;  // 1 if the entity is shown only as part of others, otherwise 0
};

std::string padded(std::string text, std::size_t length) {
  text.resize(std::max(length, text.size()), ' ');
  return text;
}

std::string field(long number) {
  const std::string text = std::to_string(number);
  return std::string(8 - text.size(), ' ') + text;
}

std::string numbered(char section, long number) {
  const std::string text = std::to_string(number);
  return section + std::string(7 - text.size(), '0') + text + "\n";
}

// Splits the parameters into lines of at most 64 letters without cutting any parameter.
std::vector<std::string> lines_of(const std::string& parameters) {
  std::vector<std::string> lines(1);
  for (std::size_t k = 0; k < parameters.size();) {
    const std::size_t end = std::min(parameters.find(',', k), parameters.size() - 1) + 1;
    if (lines.back().size() + end - k > 64) lines.emplace_back();
    lines.back() += parameters.substr(k, end - k);
    k = end;
  }
  return lines;
}

// Returns an IGES file of the entities. `scale_and_unit` is the text of parameters 13 to 15 of the global
// section.
std::string iges_text(const std::vector<Entity>& entities, const std::string& scale_and_unit = "1.,2,2HMM") {
  std::string directory, parameters;
  long line = 1, entry = 1;
  for (const Entity& entity : entities) {
    const auto lines = lines_of(std::to_string(entity.type) + "," + entity.parameters + ";");
    const std::string subordinate = "000" + std::to_string(entity.subordinate) + "0000";
    const long placement = entity.placement == 0 ? 0 : 2 * entity.placement - 1;
    directory += field(entity.type) + field(line) + field(0) + field(0) + field(0) + field(0) +
                 field(placement) + field(0) + subordinate + numbered('D', entry);
    directory +=
        padded(field(entity.type) + field(0) + field(0) + field(static_cast<long>(lines.size())) + field(0),
               72) +
        numbered('D', entry + 1);
    for (const std::string& text : lines) {
      parameters += padded(text, 64) + field(entry) + numbered('P', line++);
    }
    entry += 2;
  }
  return padded("test", 72) + numbered('S', 1) +
         padded("1H,,1H;,4Htest,8Htest.igs,4Htest,4Htest,32,38,6,308,15,4Htest,", 72) + numbered('G', 1) +
         padded(scale_and_unit + ",1,0.01,15H20261124.135122,1E-07,100.,4Hroot,4Hroot,11,0;", 72) +
         numbered('G', 2) + directory + parameters +
         padded("S" + field(1).substr(1) + "G" + field(2).substr(1) + "D" + field(entry - 1).substr(1) + "P" +
                    field(line - 1).substr(1),
                72) +
         numbered('T', 1);
}

// Returns the parameters of a sheet of 10 x 20 mm whose left edge is at `x`. The corner at the left end of
// the far edge is lifted by 3 mm.
std::string sheet_at(double x) {
  const std::string left = std::to_string(x), right = std::to_string(x + 10.0);
  return "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.," + left + ",0.,0.," + right + ",0.,0.," +
         left + ",20.,3.," + right + ",20.,0.,0.,1.,0.,1.";
}

struct FoundInIges {
  std::vector<CadSurface> surfaces;
  CadModel model;
  std::string refusal;
};

class IgesFile : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  FoundInIges read(const std::string& text) const {
    CadReading reading;
    reading.format = FileFormat::iges;
    FoundInIges found;
    auto model = read_cad(folder_.write("a.igs", text), reading,
                          [&](CadSurface part) { found.surfaces.push_back(std::move(part)); });
    if (!model) found.refusal = model.error().message;
    if (model) found.model = std::move(model).value();
    return found;
  }

  std::string box() const {
    set_file_unit("mm");
    const auto file = folder_.path() / "box.igs";
    IGESControl_Writer writer;
    EXPECT_TRUE(writer.AddShape(BRepPrimAPI_MakeBox(30, 20, 10).Shape()));
    EXPECT_TRUE(writer.Write(file.c_str()));
    return content_of(file);
  }

  TemporaryFolder folder_;
};

TEST_F(IgesFile, WhatIsWholeIsRead) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}, {128, sheet_at(20)}}));
  EXPECT_EQ(found.refusal, "");
  EXPECT_EQ(found.surfaces.size(), 2u);
  EXPECT_TRUE(found.model.notes.empty());
}

TEST_F(IgesFile, WhatIsCutShortIsRefused) {
  const std::string text = box();
  ASSERT_EQ(read(text).surfaces.size(), 6u);
  constexpr std::size_t cuts = 60;
  for (std::size_t k = 1; k < cuts; ++k) {
    const FoundInIges found = read(text.substr(0, text.size() * k / cuts));
    EXPECT_NE(found.refusal, "") << k;
    EXPECT_TRUE(found.surfaces.empty()) << k;
  }
  EXPECT_EQ(read(text.substr(0, text.size() / 2)).refusal,
            "is cut short or damaged: its last line is missing; copy it whole, or export it again");
}

TEST_F(IgesFile, ALineThatIsMissingIsMissed) {
  const std::string text = iges_text({{128, sheet_at(0)}, {128, sheet_at(20)}});
  for (const char section : {'S', 'G', 'D', 'P'}) {
    SCOPED_TRACE(section);
    std::string less = text;
    const std::size_t end = less.find(numbered(section, 1)) + 8;
    less.erase(end - 80, 81);
    EXPECT_NE(read(less).refusal.find("is cut short or damaged: its last line counts"), std::string::npos);
  }
}

TEST_F(IgesFile, AnEntityWhoseParametersLieBeyondTheEndIsRefused) {
  std::string text = iges_text({{128, sheet_at(0)}, {128, sheet_at(20)}});
  const std::string declared = field(0) + field(0) + field(3) + field(0);
  const std::size_t at = text.rfind(declared);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, declared.size(), field(0) + field(0) + field(4) + field(0));
  EXPECT_EQ(read(text).refusal,
            "is cut short or damaged: the parameters of an entity would reach line 7 of 6; copy it whole, or "
            "export it again");
}

TEST_F(IgesFile, ABareSurfaceThatIsDamagedIsMissed) {
  std::string damaged = sheet_at(20);
  damaged[0] = '5';  // the entity asks for more control points than it has
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}, {128, damaged}}));
  EXPECT_EQ(found.surfaces.size(), 1u);
  EXPECT_EQ(found.model.notes,
            std::vector<std::string>{
                "1 of the file's 2 faces cannot be read and are missing; repair them in the CAD system"});
}

TEST_F(IgesFile, APlacedPartThatIsNotReadIsMissed) {
  const FoundInIges found = read(iges_text(
      {{128, sheet_at(0), 0, 1}, {308, "0,4Hpart,1,1"}, {408, "3,100.,0.,0.,1."}, {408, "3,200.,0.,0.,2."}}));
  EXPECT_EQ(found.surfaces.size(), 1u);
  EXPECT_EQ(
      found.model.notes,
      std::vector<std::string>{
          "1 of the file's 2 placed parts cannot be read and are missing; repair them in the CAD system"});
}

// Three letters too many shift the columns of an entry.
TEST_F(IgesFile, AnEntryOfTheDirectoryThatIsDamagedIsRefused) {
  std::string text = iges_text({{128, sheet_at(0)}, {128, sheet_at(20)}, {128, sheet_at(40)}});
  const std::size_t second = text.find(numbered('D', 3)) - 72;
  text.insert(second + 16, "0.5");
  EXPECT_EQ(read(text).refusal,
            "is cut short or damaged: its last line counts 6 lines of section D, and there are 5; copy it "
            "whole, or export it again");
}

TEST_F(IgesFile, ACurveThatIsDamagedIsTold) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}, {142, "1,99,0,1,1"}}));
  EXPECT_EQ(found.surfaces.size(), 1u);
  EXPECT_EQ(found.model.notes,
            std::vector<std::string>{"damaged entities of the file: 1; the parts that they belong to are "
                                     "missing or wrong; export the file again"});
}

TEST_F(IgesFile, AMatrixThatStretchesIsTold) {
  const std::string stretch = "2.,0.,0.,100.,0.,1.,0.,0.,0.,0.,1.,0.",
                    turn = "0.,-1.,0.,9.,1.,0.,0.,0.,0.,0.,1.,0.";
  const FoundInIges turned = read(iges_text({{128, sheet_at(0), 2}, {124, turn}}));
  EXPECT_TRUE(turned.model.notes.empty());
  const FoundInIges found = read(iges_text({{128, sheet_at(0), 2}, {124, stretch}}));
  ASSERT_EQ(found.model.notes.size(), 1u);
  EXPECT_NE(found.model.notes[0].find("placements that scale, stretch or mirror: 1, which are not read"),
            std::string::npos);
}

// In a damaged file, the entity that should be the matrix may be missing or may have another type.
TEST_F(IgesFile, AMatrixThatIsNoneIsTold) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0), 2}, {110, "0.,0.,0.,1.,0.,0."}}));
  EXPECT_EQ(found.refusal, "");
  EXPECT_EQ(std::count_if(found.model.notes.begin(), found.model.notes.end(),
                          [](const std::string& note) {
                            return note.starts_with("placements that scale, stretch or mirror: 1,");
                          }),
            1);
}

TEST_F(IgesFile, ModelsThatAreNullHaveNoContent) {
  EXPECT_FALSE(find_unit(opencascade::handle<StepData_StepModel>()).declared);
  EXPECT_EQ(count_unread_placements(opencascade::handle<StepData_StepModel>()), 0);
  EXPECT_EQ(count_unread_placements(opencascade::handle<IGESData_IGESModel>()), 0);
  EXPECT_EQ(remove_external_files({}), 0);
  EXPECT_EQ(count_losses({}, FileFormat::iges).faces, 0);
}

TEST_F(IgesFile, WhatIsFarAwayIsLeftOut) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}, {128, sheet_at(200000)}}));
  EXPECT_EQ(found.surfaces.size(), 1u);
  ASSERT_EQ(found.model.notes.size(), 1u);
  EXPECT_NE(found.model.notes[0].find("is skipped: is more than 100 m from the origin"), std::string::npos)
      << found.model.notes[0];
}

TEST_F(IgesFile, TheScaleOfAModelIsTold) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}}, "0.5,2,2HMM"));
  ASSERT_EQ(found.model.notes.size(), 1u);
  EXPECT_NE(found.model.notes[0].find("a model of scale 0.5, which is not applied"), std::string::npos);
  for (const char* same : {"1.,2,2HMM", "1,2,2HMM", "1.D0,2,2HMM", ",2,2HMM"}) {
    EXPECT_TRUE(read(iges_text({{128, sheet_at(0)}}, same)).model.notes.empty()) << same;
  }
}

TEST_F(IgesFile, AFlagOfNoUnitIsMillimetres) {
  const FoundInIges found = read(iges_text({{128, sheet_at(0)}}, "1.,99,2HMM"));
  EXPECT_EQ(found.refusal, "");
  ASSERT_EQ(found.surfaces.size(), 1u);
  EXPECT_FALSE(found.model.unit_declared);
  EXPECT_EQ(found.model.notes.size(), 1u);
  EXPECT_NEAR(found.surfaces[0].surface.net.point(1, 1).y(), 0.02, 1e-12);
}

}  // namespace
}  // namespace spoonbill
