// Tests CAD files that the child process reads and writes, and faults of the files and of the child.
#include "app/files/cad_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <sstream>

#include "engine/exchange/cad_stream.h"
#include "engine/exchange/frame_stream.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

using namespace std::chrono_literals;

CadChild by_program() {
  CadChild child;
  child.program = SPOONBILL_CAD_PROGRAM;
  child.patience = 60s;
  return child;
}

CadModel two_tubes() {
  CadModel model;
  model.surfaces.push_back({"one", ellipsoid_tube(8, 10), 0.0, {}, {}});
  model.surfaces.push_back({"two", ellipsoid_tube(6, 8, {0.1, 0, 0}), 0.0, {}, {}});
  return model;
}

class CadFileTest : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content).string();
  }

  static Result<CadModel> read(const std::string& file, const CadChild& child = by_program()) {
    CadReading reading;
    reading.format = format_from_name(file);
    return read_cad_file(file, reading, child);
  }

  static void expect_refusal(const std::string& file, const std::string& reason,
                             const CadChild& child = by_program()) {
    const auto model = read(file, child);
    ASSERT_FALSE(model) << file << " should be refused: " << reason;
    expect_one_line(file, model.error().message);
    EXPECT_NE(model.error().message.find(reason), std::string::npos) << model.error().message;
  }

  static void expect_refusal(const std::string& file, ErrorCode code, const CadChild& child = by_program()) {
    const auto model = read(file, child);
    ASSERT_FALSE(model) << file;
    expect_one_line(file, model.error().message);
    EXPECT_EQ(model.error().code, code) << model.error().message;
  }

  static void expect_one_line(const std::string& file, const std::string& line) {
    EXPECT_TRUE(line.starts_with(file + ": ")) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_LT(line.size(), file.size() + 500) << line;
  }

  static std::string text_of(FileFormat format) {
    const auto content = make_cad_file(two_tubes(), {format, StepSchema::ap214, "mm"}, "model", by_program());
    EXPECT_TRUE(content) << content.error().message;
    return content ? content->text : "";
  }

  // Returns the settings of a child that is a shell script instead of spoonbill-cad.
  CadChild instead(const std::string& script) const {
    CadChild child;
    child.program = folder_.write("reader", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(child.program, std::filesystem::perms::owner_all);
    child.patience = 2s;
    return child;
  }

  TemporaryFolder folder_;
};

TEST_F(CadFileTest, WhatIsMadeIsRead) {
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    const auto model = read(write(format == FileFormat::step ? "a.step" : "a.igs", text_of(format)));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->surfaces.size(), 2u);
    EXPECT_EQ(model->surfaces[1].name, "two");
    EXPECT_EQ(model->unit, "mm");
    EXPECT_TRUE(model->unit_declared);
  }
}

TEST_F(CadFileTest, NamesTellTheFormat) {
  EXPECT_TRUE(is_cad(format_from_name("a.STEP")));
  EXPECT_TRUE(is_cad(format_from_name("a.b.igs")));
  EXPECT_FALSE(is_cad(format_from_name("a.stl")));
  EXPECT_FALSE(is_cad(format_from_name("step")));
  EXPECT_EQ(format_from_name("a.Stp"), FileFormat::step);
  EXPECT_EQ(format_from_name("a.IGES"), FileFormat::iges);
}

TEST_F(CadFileTest, WhatIsNoFileIsRefused) {
  expect_refusal((folder_.path() / "missing.step").string(), ErrorCode::missing);
  expect_refusal(write("empty.step", ""), "is empty");
  expect_refusal(write("empty.iges", ""), "is empty");
  const auto folder = folder_.path() / "folder.step";
  std::filesystem::create_directory(folder);
  expect_refusal(folder.string(), "is a folder");
  const auto pipe = folder_.path() / "pipe.step";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_refusal(pipe.string(), "is not a regular file");
  const std::string huge = write("huge.step", "ISO-10303-21;");
  std::filesystem::resize_file(huge, std::uintmax_t{600} << 20);  // a sparse file
  expect_refusal(huge, ErrorCode::too_many);
}

TEST_F(CadFileTest, OtherContentIsRefused) {
  for (const char* ending : {".step", ".igs"}) {
    SCOPED_TRACE(ending);
    expect_refusal(write(std::string("text") + ending, "hello, this is no CAD file\n"), "");
    expect_refusal(write(std::string("json") + ending, "{\"spoonbill_document\": 1}"), "");
    expect_refusal(write(std::string("zeros") + ending, std::string(5000, '\0')), "");
    std::string noise;
    Random random(3);
    for (int k = 0; k < 20000; ++k) noise += static_cast<char>(random.integer(0, 255));
    expect_refusal(write(std::string("noise") + ending, noise), "");
  }
  expect_refusal(write("is-iges.step", text_of(FileFormat::iges)), "is not a STEP file");
  expect_refusal(write("is-step.iges", text_of(FileFormat::step)), "");
  const std::string nothing =
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
  expect_refusal(write("nothing.step", nothing), "contains no");
}

// Truncated and changed files give a model or an error of one line within a limited time.
TEST_F(CadFileTest, DamagedFilesGiveAModelOrOneLine) {
  Random random(11);
  int refused = 0, read_all_the_same = 0;
  for (const FileFormat format : {FileFormat::step, FileFormat::iges}) {
    const std::string sound = text_of(format);
    for (int k = 0; k < effort(is_full_run() ? 40 : 10); ++k) {
      std::string damaged = sound;
      if (k % 2 == 0)
        damaged.resize(static_cast<std::size_t>(random.integer(1, static_cast<int>(sound.size()) - 1)));
      for (int changes = random.integer(0, 6); changes > 0; --changes) {
        const auto at = static_cast<std::size_t>(random.integer(0, static_cast<int>(damaged.size()) - 1));
        static const std::string letters = "#()',;*$.E-9\\\x00\xff 10";
        damaged[at] =
            letters[static_cast<std::size_t>(random.integer(0, static_cast<int>(letters.size()) - 1))];
      }
      const std::string file = write(format == FileFormat::step ? "damaged.step" : "damaged.iges", damaged);
      const auto model = read(file);
      if (model) {
        ++read_all_the_same;
      } else {
        ++refused;
        expect_one_line(file, model.error().message);
      }
    }
  }
  EXPECT_GT(refused, 0);
  RecordProperty("refused", refused);
  RecordProperty("read", read_all_the_same);
}

TEST_F(CadFileTest, NumbersBeyondAllBoundsAreRefused) {
  const std::string sound = text_of(FileFormat::step);
  for (const char* number : {"1.E+300", "NAN", "1.E+999", "1.E+8"}) {
    SCOPED_TRACE(number);
    std::string text = sound;
    const std::string begin = "CARTESIAN_POINT('',(";
    std::size_t at = text.find("B_SPLINE_SURFACE_WITH_KNOTS");
    at = text.find(begin, at) + begin.size();
    text.replace(at, text.find(',', at) - at, number);
    const std::string file = write("beyond.step", text);
    const auto model = read(file);
    if (model) {
      // OpenCASCADE may read the changed text as another number, which must be in range.
      for (const double x : model->surfaces[0].surface.net.x) EXPECT_LE(std::abs(x), 100.0);
    } else {
      expect_one_line(file, model.error().message);
    }
  }
}

// A single bad face does not make the whole file unreadable.
TEST_F(CadFileTest, AFaceThatCannotBeTakenIsLeftOutAndNamed) {
  std::string text = text_of(FileFormat::step);
  const std::string begin = "CARTESIAN_POINT('',(";
  std::size_t at = 0;
  const auto spoil_next_surface = [&] {
    at = text.find(begin, text.find("B_SPLINE_SURFACE_WITH_KNOTS", at)) + begin.size();
    text.replace(at, text.find(',', at) - at, "NAN");
  };
  spoil_next_surface();
  const auto model = read(write("one.step", text));
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->surfaces.size(), 1u);
  EXPECT_EQ(model->surfaces[0].name, "two");
  ASSERT_EQ(model->notes.size(), 1u);
  EXPECT_TRUE(model->notes[0].starts_with("'one' ")) << model->notes[0];
  EXPECT_NE(model->notes[0].find("is skipped: "), std::string::npos) << model->notes[0];
  spoil_next_surface();
  expect_refusal(write("none.step", text), "'one': ");
}

TEST_F(CadFileTest, AReaderThatFailsIsExplained) {
  const std::string file = write("a.step", text_of(FileFormat::step));
  expect_refusal(file, "crashed on it (signal 11)", instead("kill -SEGV $$"));
  expect_refusal(file, "ended without a model (exit code 3)", instead("exit 3"));
  expect_refusal(file, "longer than 2 s", instead("sleep 20"));
  expect_refusal(file, "gave an invalid answer", instead("echo nonsense of more than sixteen bytes"));
  CadChild absent;
  absent.program = folder_.path() / "absent";
  expect_refusal(file, ErrorCode::unavailable, absent);
}

// A hostile file may have taken over the child, so any answer is possible.
TEST_F(CadFileTest, AnswersOfAnotherFormAreRefused) {
  std::ostringstream surface;
  write_frame(surface, FrameKind::surface, json_to_line(cad_surface_to_json(two_tubes().surfaces[0])));
  const std::string file = write("a.step", text_of(FileFormat::step));
  for (const char* ending : {"", "7", "[]", "{", R"({"unit": 5, "unit_declared": true, "notes": []})",
                             R"({"unit": "mm", "unit_declared": "yes", "notes": []})",
                             R"({"unit": "mm", "unit_declared": true, "notes": 3})", R"({"unit": "mm"})"}) {
    SCOPED_TRACE(ending);
    std::ostringstream answer;
    answer << surface.str();
    write_frame(answer, FrameKind::ending, ending);
    expect_refusal(file, "gave an invalid answer",
                   instead("cat " + folder_.write("answer", answer.str()).string()));
    std::ostringstream made;
    write_frame(made, FrameKind::file, "ISO-10303-21;");
    write_frame(made, FrameKind::ending, ending);
    const auto content = make_cad_file(two_tubes(), {}, "b.step",
                                       instead("cat " + folder_.write("made", made.str()).string()));
    ASSERT_FALSE(content);
    EXPECT_NE(content.error().message.find("gave an invalid answer"), std::string::npos);
  }
}

TEST_F(CadFileTest, AWriterThatFailsIsExplained) {
  const auto reason = [&](const std::string& script) {
    const auto content = make_cad_file(two_tubes(), {}, "b.step", instead(script));
    EXPECT_FALSE(content);
    return content ? "" : content.error().message;
  };
  EXPECT_EQ(reason("kill -SEGV $$").substr(0, 44), "b.step: the writer crashed (signal 11); writ");
  EXPECT_EQ(reason("sleep 20").substr(0, 38), "b.step: writing it took longer than 2 ");
  EXPECT_EQ(reason("exit 3").substr(0, 40), "b.step: the writer ended without a file ");
}

TEST_F(CadFileTest, AReaderIsStoppedSoon) {
  const std::string file = write("a.step", text_of(FileFormat::step));
  CadChild child = instead("sleep 20");
  child.patience = 20s;
  const auto start = std::chrono::steady_clock::now();
  child.progress = Progress([&](double) { return std::chrono::steady_clock::now() - start <= 100ms; });
  expect_refusal(file, ErrorCode::cancelled, child);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 10s);
}

TEST_F(CadFileTest, ProgressGrowsToTheEnd) {
  const std::string file = write("a.step", text_of(FileFormat::step));
  CadChild child = by_program();
  std::vector<double> shares;
  child.progress = Progress([&](double fraction) {
    shares.push_back(fraction);
    return true;
  });
  ASSERT_TRUE(read(file, child));
  ASSERT_GE(shares.size(), 3u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

}  // namespace
}  // namespace spoonbill
