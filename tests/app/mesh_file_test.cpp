// Tests mesh files and clouds that the child process reads, and faults of the files and of the child.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "app/files/scan_file.h"
#include "tests/app/mesh_texts.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

using namespace std::chrono_literals;

MeshReading by_program() {
  MeshReading reading;
  reading.program = SPOONBILL_PROGRAM;
  return reading;
}

class MeshFileTest : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content).string();
  }

  // Returns the settings of a reader that is a shell script instead of the program.
  MeshReading instead(const std::string& script) const {
    const auto program = folder_.write("reader", "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    MeshReading reading;
    reading.program = program;
    reading.patience = 10s;
    return reading;
  }

  TemporaryFolder folder_;
};

void expect_refusal(const std::string& file, const std::string& reason,
                    const MeshReading& reading = by_program()) {
  const auto mesh = read_mesh_file(file, reading);
  ASSERT_FALSE(mesh) << file << " should be refused: " << reason;
  const std::string& line = mesh.error().message;
  EXPECT_TRUE(line.starts_with(file + ": ")) << line;
  EXPECT_NE(line.find(reason), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

void expect_refusal(const std::string& file, ErrorCode code, const MeshReading& reading = by_program()) {
  const auto mesh = read_mesh_file(file, reading);
  ASSERT_FALSE(mesh) << file;
  EXPECT_TRUE(mesh.error().message.starts_with(file + ": ")) << mesh.error().message;
  EXPECT_EQ(mesh.error().message.find('\n'), std::string::npos) << mesh.error().message;
  EXPECT_EQ(mesh.error().code, code) << mesh.error().message;
}

// The file has two triangles, each with a list of corners and a colour. Wherever the file is truncated, the
// program reports an error, and the reader does not crash.
TEST_F(MeshFileTest, ACutBinaryPlyIsToldOfItsCut) {
  for (const bool big : {false, true}) {
    const std::string header = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                               "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                               "property float z\nelement face 2\nproperty list ushort int vertex_indices\n"
                               "property uchar red\nend_header\n";
    std::string bytes;
    const auto append = [&](std::uint32_t number, int count) {
      for (int k = 0; k < count; ++k) {
        bytes.push_back(static_cast<char>(number >> 8U * static_cast<unsigned>(big ? count - 1 - k : k)));
      }
    };
    for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F}) {
      append(std::bit_cast<std::uint32_t>(number), 4);
    }
    for (const std::uint32_t first : {0U, 1U}) {
      append(3, 2);
      for (const std::uint32_t corner : {0U, 1U + first, 2U + first}) append(corner, 4);
      append(200, 1);
    }
    const auto whole = read_mesh_file(write("whole.ply", header + bytes), by_program());
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_EQ(whole->mesh.triangles.size(), 2U);
    for (const std::size_t kept : {std::size_t{0}, std::size_t{11}, std::size_t{47}, std::size_t{48},
                                   std::size_t{49}, std::size_t{60}, bytes.size() - 1}) {
      const std::string file = write("cut.ply", header + bytes.substr(0, kept));
      expect_refusal(file, kept < 48 ? "it ends within vertex" : "it ends within face");
    }
    std::string odd = header;
    odd.replace(odd.find("float z"), 7, "quark z");
    expect_refusal(write("odd.ply", odd + bytes), "of a type that PLY does not have");
  }
}

TEST_F(MeshFileTest, ACutTextStlIsToldOfItsCut) {
  TriangleMesh one;
  one.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  one.triangles = {{0, 1, 2}};
  std::string text = ascii_stl(one);
  text = text.substr(0, text.rfind("endsolid")) + "endsolid one\n \n";
  const std::size_t told_whole = text.rfind("endsolid") + 8;
  for (std::size_t kept = 1; kept <= text.size(); ++kept) {
    const std::string file = write("cut.stl", text.substr(0, kept));
    const auto read = read_mesh_file(file, by_program());
    ASSERT_EQ(read.ok(), kept >= told_whole) << text.substr(0, kept);
    if (read) {
      EXPECT_EQ(read->mesh.triangles.size(), 1U) << kept;
    } else {
      const std::string reason = kept < 5 ? "cannot be read as STL" : "it does not end with 'endsolid'";
      EXPECT_NE(read.error().message.find(reason), std::string::npos) << read.error().message;
    }
  }
}

TEST_F(MeshFileTest, ACutObjIsToldOfItsCutWhereItCanBe) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
  for (const char* last : {"f", "f ", "f 1", "f 1//1 3//1", "f 1//1 3//1 ", "f 1//1 3//1 4", "f 1//1 3//1 4/",
                           "f 1//1 3//1 4//", "f -4//1 -2//1 -", "v 0 1", "vn 1"}) {
    expect_refusal(write("cut.obj", start + last), "it is cut or damaged");
  }
  for (const char* last :
       {"f 1//1 3//1 4//1", "f 1//1 3//1 4//1\n# the last", "f 1//1 3//1 4//1\n", "g f 1"}) {
    const auto whole = read_mesh_file(write("whole.obj", start + last), by_program());
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_EQ(whole->mesh.triangles.size(), last[0] == 'g' ? 1U : 2U) << last;
  }
  expect_refusal(write("beyond.obj", start + "f 1//1 3//1 5//1\n"), "");
}

void expect_box(const std::string& file, const Vector3& size_m, const MeshReading& reading = by_program()) {
  SCOPED_TRACE(file);
  const auto read = read_mesh_file(file, reading);
  ASSERT_TRUE(read) << read.error().message;
  const auto clean = clean_mesh(read->mesh, file);
  ASSERT_TRUE(clean) << clean.error().message;
  EXPECT_EQ(clean->mesh.triangles.size(), 12u);
  EXPECT_EQ(clean->mesh.vertices_m.size(), 8u);
  EXPECT_EQ(clean->report.closed_parts, 1u);
  // Mesh files have single precision, and one test changes the lowest byte of a number.
  EXPECT_LT((clean->report.size_m - size_m).norm(), 2e-5 * size_m.norm());
}

const TriangleMesh box = box_of_triangles({-10, -20, -30}, {10, 20, 30});

TEST_F(MeshFileTest, EveryFormatGivesTheBoxInItsUnit) {
  const Vector3 in_mm(0.02, 0.04, 0.06);
  expect_box(write("binary.stl", binary_stl(box)), in_mm);
  expect_box(write("TEXT.STL", ascii_stl(box)), in_mm);
  expect_box(write("box.obj", obj_text(box)), in_mm);
  expect_box(write("-rf box.obj", obj_text(box)), in_mm);
  TriangleMesh small = box;
  for (Vector3& vertex : small.vertices_m) vertex *= 1e-3;
  expect_box(write("box.ply", ply_text(small)), in_mm);
  expect_box(write("binary.ply", binary_ply(small)), in_mm);

  // The first byte of a number may look like a line end, blank or letter.
  for (const int first : {'\n', '\r', ' ', '\0', 'e'}) {
    TriangleMesh mesh = small;
    auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(mesh.vertices_m[0].x()));
    bits = (bits & ~0xffU) | static_cast<std::uint32_t>(first);
    mesh.vertices_m[0].x() = std::bit_cast<float>(bits);
    expect_box(write("first.ply", binary_ply(mesh)), in_mm);
  }

  MeshReading reading = by_program();
  reading.unit = LengthUnit{"in", 0.0254};
  expect_box(write("inches.obj", obj_text(box)), 0.0254 * Vector3(20, 40, 60), reading);
  EXPECT_EQ(read_mesh_file(write("a.stl", binary_stl(box)), reading)->unit.name, "in");
  EXPECT_EQ(read_mesh_file(write("a.stl", binary_stl(box)), by_program())->unit.name, "mm");
  EXPECT_EQ(read_mesh_file(write("a.ply", ply_text(small)), by_program())->unit.name, "m");
}

TEST_F(MeshFileTest, PolygonsAreCutAndPointsLinesAndOtherFilesLeftOut) {
  const auto pipe = folder_.path() / "pipe.mtl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string text = "mtllib pipe.mtl\nmtllib /dev/zero\nusemtl gold\n";
  for (const Vector3& at : box.vertices_m) {
    text +=
        "v " + std::to_string(at.x()) + " " + std::to_string(at.y()) + " " + std::to_string(at.z()) + "\n";
  }
  text += "p 1\nl 1 2 3\n";
  for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
    text += std::string("g part") + face[0] + "\nf " + face + "\n";
  }
  expect_box(write("polygons.obj", text), {0.02, 0.04, 0.06});
}

TEST_F(MeshFileTest, WhatIsNoFileIsRefused) {
  expect_refusal((folder_.path() / "missing.stl").string(), ErrorCode::missing);
  expect_refusal(write("model.json", "{}"), ErrorCode::unsupported);
  expect_refusal(write("model", "solid"), ErrorCode::unsupported);
  expect_refusal(write("empty.obj", ""), "is empty");
  const auto folder = folder_.path() / "folder.ply";
  std::filesystem::create_directory(folder);
  expect_refusal(folder.string(), "is a folder");
  const auto pipe = folder_.path() / "pipe.stl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_refusal(pipe.string(), "is not a regular file");
  const auto device = folder_.path() / "device.stl";
  std::filesystem::create_symlink("/dev/zero", device);
  expect_refusal(device.string(), "is not a regular file");
  const std::string huge = write("huge.stl", "solid");
  std::filesystem::resize_file(huge, std::uintmax_t{600} << 20);  // a sparse file
  expect_refusal(huge, ErrorCode::too_many);
}

TEST_F(MeshFileTest, AFileWithoutPermissionIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "nothing is forbidden to root";
  const std::string file = write("secret.stl", binary_stl(box));
  std::filesystem::permissions(file, std::filesystem::perms::none);
  expect_refusal(file, "cannot be opened: Permission denied");
}

TEST_F(MeshFileTest, DamagedContentIsRefused) {
  const std::string stl = binary_stl(box);
  expect_refusal(write("truncated.stl", stl.substr(0, stl.size() - 30)), "cannot be read as STL");
  expect_refusal(write("head.stl", stl.substr(0, 60)), "cannot be read as STL");
  expect_refusal(write("surplus.stl", stl + stl.substr(84, 50)), "cannot be read as STL");
  std::string countless = stl;
  countless.replace(80, 4, "\xff\xff\xff\xff");
  expect_refusal(write("countless.stl", countless), ErrorCode::malformed);
  expect_refusal(write("json.stl", "{\"spoonbill_document\": 1}"), ErrorCode::malformed);
  const std::string text_ply = ply_text(box);
  expect_refusal(write("last.ply", text_ply.substr(0, text_ply.size() - 12)), "export it again");
  expect_refusal(write("headless.ply", "ply\nformat ascii 1.0\n"), "export it again");
  expect_refusal(write("json.ply", "{\"spoonbill_document\": 1}"), ErrorCode::malformed);
  expect_refusal(write("noise.obj", std::string("\0\x01\xff\xfe noise \0", 12)), "");
  const std::string ply = ply_text(box);
  expect_refusal(write("short.ply", ply.substr(0, ply.size() / 2)), "");
  for (const char* count : {"-1", "4294967295", "99999999999999999999", "x"}) {
    std::string hostile = ply;
    hostile.replace(hostile.find("vertex 8") + 7, 1, count);
    expect_refusal(write("hostile.ply", hostile), "");
  }
}

// Damaged content gives an error of one line, when it is read or when the mesh is cleaned.
TEST_F(MeshFileTest, DamagedContentNeverBecomesAWildMesh) {
  const auto one_line = [&](const std::string& name, const std::string& content, const std::string& reason) {
    const std::string file = write(name, content);
    auto read = read_mesh_file(file, by_program());
    const auto clean = read ? clean_mesh(std::move(read->mesh), file) : Result<CleanMesh>(read.error());
    ASSERT_FALSE(clean) << name;
    EXPECT_TRUE(clean.error().message.starts_with(file + ": ")) << clean.error().message;
    EXPECT_NE(clean.error().message.find(reason), std::string::npos) << clean.error().message;
    EXPECT_EQ(clean.error().message.find('\n'), std::string::npos);
  };
  std::string text = ascii_stl(box);
  text.replace(text.find("vertex ") + 7, 3, "nan");
  one_line("nan.stl", text, "");
  std::string numbers = binary_stl(box);
  const float infinite = HUGE_VALF, far = 1e30F;
  std::memcpy(&numbers[96], &infinite, 4);
  one_line("infinite.stl", numbers, "not a finite number");
  std::memcpy(&numbers[96], &far, 4);
  one_line("far.stl", numbers, "beyond 100 m");
  one_line("out-of-range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n", "");
  one_line("points.ply",
           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nend_header\n0 0 0\n",
           "");
}

TEST_F(MeshFileTest, AnyByteMayBeWrong) {
  const MeshReading reading = by_program();
  Random random(77);
  const int trials = random_cases(12, 150);
  const std::vector<std::pair<std::string, std::string>> files = {{"a.stl", binary_stl(box)},
                                                                  {"b.stl", ascii_stl(box)},
                                                                  {"c.obj", obj_text(box)},
                                                                  {"d.ply", ply_text(box)},
                                                                  {"e.ply", binary_ply(box)}};
  for (int trial = 0; trial < trials; ++trial) {
    for (const auto& [name, content] : files) {
      std::string damaged = content;
      for (int k = 0; k < 4; ++k) {
        const int place = random.integer(0, static_cast<int>(damaged.size()) - 1);
        damaged[static_cast<std::size_t>(place)] = static_cast<char>(random.integer(0, 255));
      }
      const std::string file = write(name, damaged);
      const auto read = read_mesh_file(file, reading);
      const auto clean = read ? clean_mesh(read->mesh, file) : Result<CleanMesh>(read.error());
      if (clean) continue;
      EXPECT_TRUE(clean.error().message.starts_with(file + ": ")) << clean.error().message;
      EXPECT_EQ(clean.error().message.find('\n'), std::string::npos);
    }
  }
}

TEST_F(MeshFileTest, AReaderThatFailsIsOneLine) {
  const std::string file = write("box.stl", binary_stl(box));
  MeshReading hanging = instead("exec sleep 60");
  hanging.patience = 200ms;
  expect_refusal(file, "took longer than", hanging);
  MeshReading closing = instead("exec >&-; exec sleep 60");
  closing.patience = 200ms;
  expect_refusal(file, "took longer than", closing);
  expect_refusal(file, "crashed on it (signal 11)", instead("kill -SEGV $$"));
  expect_refusal(file, "crashed on it (signal 9)", instead("printf spnlmesh; kill -KILL $$"));
  expect_refusal(file, "ended without a mesh (exit code 3)", instead("exit 3"));
  expect_refusal(file, "ended without a mesh (exit code 0)", instead("printf 'spnlmesh'"));
  expect_refusal(file, "gave an invalid answer", instead("exec head -c 1000000 /dev/zero"));
  expect_refusal(file, "18446744073709551615 triangles",
                 instead("printf 'spnlmesh'; head -c 24 /dev/zero | tr '\\000' '\\377'"));
  expect_refusal(
      file, "ended without a mesh",
      instead("printf "
              "'spnlmesh\\144\\0\\0\\0\\0\\0\\0\\0\\003\\0\\0\\0\\0\\0\\0\\0\\001\\0\\0\\0\\0\\0\\0\\0abc'"));
  expect_refusal(file, "cannot be read as STL (a b)",
                 instead("printf 'spnlfail\\003\\0\\0\\0\\0\\0\\0\\0a\\nb'"));
  expect_refusal(file, "more than 4 GiB",
                 instead("printf 'spnlfail\\016\\0\\0\\0\\0\\0\\0\\0bad allocation'"));
  MeshReading missing;
  missing.program = folder_.path() / "nobody";
  expect_refusal(file, ErrorCode::unavailable, missing);
}

// A child process reads clouds too. Every failure of that process gives an error of one line.
TEST_F(MeshFileTest, AReaderOfPointsThatFailsIsOneLine) {
  const std::string file = write("cloud.xyz", "1 2 3\n4 5 6\n");
  const auto expect_no_cloud = [&](const std::string& reason, const MeshReading& reading) {
    const auto cloud = read_cloud_file(file, reading);
    ASSERT_FALSE(cloud) << reason;
    const std::string& line = cloud.error().message;
    EXPECT_TRUE(line.starts_with(file + ": ")) << line;
    EXPECT_NE(line.find(reason), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  };
  const auto cloud = read_cloud_file(file, by_program());
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(cloud.value());
  EXPECT_EQ(cloud.value()->points, (std::vector<Vector3>{{1, 2, 3}, {4, 5, 6}}));
  MeshReading hanging = instead("exec sleep 60");
  hanging.patience = 200ms;
  expect_no_cloud("took longer than", hanging);
  expect_no_cloud("crashed on it (signal 11)", instead("kill -SEGV $$"));
  expect_no_cloud("ended without a cloud (exit code 3)", instead("exit 3"));
  expect_no_cloud("gave an invalid answer", instead("exec head -c 1000000 /dev/zero"));
  expect_no_cloud("gave an invalid answer",
                  instead("printf 'spnlclud'; head -c 32 /dev/zero | tr '\\000' '\\377'"));
  expect_no_cloud("ended without a cloud",
                  instead("printf 'spnlclud\\140\\0\\0\\0\\0\\0\\0\\0\\003\\0\\0\\0\\0\\0\\0\\0'; head -c 16 "
                          "/dev/zero; printf abc"));
  expect_no_cloud(": a b", instead("printf 'spnlfail\\003\\0\\0\\0\\0\\0\\0\\0a\\nb'"));
  expect_no_cloud("more than 4 GiB; thin it out",
                  instead("printf 'spnlfail\\016\\0\\0\\0\\0\\0\\0\\0bad allocation'"));
}

TEST_F(MeshFileTest, TheReaderHasFourGibibytes) {
  if (sanitized) GTEST_SKIP() << "a sanitizer's memory knows no limit";
  // The script sends its limit on address space, 4194304 KiB, as the reason of a failure; 007 is the length
  // of this reason. The script waits first, so that the parent can set the limit.
  expect_refusal(write("box.stl", binary_stl(box)), "(4194304)",
                 instead("sleep 0.3; printf 'spnlfail\\007\\0\\0\\0\\0\\0\\0\\0'; ulimit -v"));
}

// The mesh is a ball of many triangles. The long run uses five million triangles and the real limit.
TEST_F(MeshFileTest, ManyTrianglesAreReadUpToTheLimit) {
  const bool full = is_long_run();
  MeshReading reading = by_program();
  if (!full) reading.triangle_limit = 20'000;
  const int rings = full ? 1118 : 70;
  const TriangleMesh ball = ball_mesh(rings, 2 * rings, 50.0);
  ASSERT_LE(ball.triangles.size(), reading.triangle_limit);
  const std::string file = write("ball.stl", binary_stl(ball));
  auto read = read_mesh_file(file, reading);
  ASSERT_TRUE(read) << read.error().message;
  const auto clean = clean_mesh(std::move(read->mesh), file, reading.triangle_limit);
  ASSERT_TRUE(clean) << clean.error().message;
  EXPECT_EQ(clean->report.closed_parts, 1u);
  EXPECT_EQ(clean->report.open_edges, 0u);
  EXPECT_GE(clean->mesh.triangles.size() + clean->report.degenerate_dropped, ball.triangles.size());

  const int more = full ? 1230 : 72;
  expect_refusal(write("more.stl", binary_stl(ball_mesh(more, 2 * more, 50.0))), "reduce the mesh", reading);
}

TEST_F(MeshFileTest, APearFromAScannerIsATool) {
  const char* scans = std::getenv("SPOONBILL_SCANS");
  if (scans == nullptr) GTEST_SKIP() << "SPOONBILL_SCANS names no folder of scans";
  const std::string file = std::string(scans) + "/ycb_016_pear.ply";
  const auto read = read_mesh_file(file, by_program());
  ASSERT_TRUE(read) << read.error().message;
  const auto clean = clean_mesh(read->mesh, file);
  ASSERT_TRUE(clean) << clean.error().message;
  EXPECT_EQ(clean->report.vertices_read, 35016u);
  // The file has 6,091 distinct vertices, a few of them almost equal.
  EXPECT_NEAR(static_cast<double>(clean->mesh.vertices_m.size()), 6000.0, 100.0);
  EXPECT_EQ(clean->report.sheets, 1u);  // open, because the underside was not scanned
  EXPECT_NEAR(clean->report.size_m.maxCoeff(), 0.088, 0.001);
}

}  // namespace
}  // namespace spoonbill
