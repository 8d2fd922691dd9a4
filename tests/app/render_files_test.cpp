// Tests that the render command draws files of all formats, or refuses them with one line.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "app/program.h"
#include "engine/base/geometry.h"
#include "engine/exchange/file_format.h"
#include "tests/app/mesh_texts.h"
#include "tests/app/process.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

namespace fs = std::filesystem;

const fs::path assets = SPOONBILL_ASSETS;
constexpr int width_px = 160, height_px = 90;

Outcome render(const fs::path& model, const fs::path& picture) {
  fs::remove(picture);
  return run_process(SPOONBILL_PROGRAM, {"render", model.string(), "--transparent", "--size", "160x90",
                                         "--json", "--out", picture.string()});
}

// Returns the larger part of the picture's width or height that opaque pixels cover.
double covered_fraction(const Image& image) {
  Box2 box;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.pixel(x, y)[3] > 240) box.include({x, y});
    }
  }
  if (box.is_empty()) return 0.0;
  return std::max((box.extent().x() + 1.0) / width_px, (box.extent().y() + 1.0) / height_px);
}

void expect_picture(const fs::path& model, const Workplace& place) {
  SCOPED_TRACE(model);
  const fs::path picture = place.path("picture.png");
  const Outcome outcome = render(model, picture);
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const auto image = read_png(picture);
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->width, width_px);
  EXPECT_GT(covered_fraction(image.value()), 0.6);
  EXPECT_LT(covered_fraction(image.value()), 0.95);
}

void expect_refusal(const fs::path& model, const Workplace& place) {
  SCOPED_TRACE(model);
  const fs::path picture = place.path("picture.png");
  const Outcome outcome = render(model, picture);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.code << ": " << outcome.err;
  EXPECT_FALSE(fs::exists(picture));
}

void expect_picture_or_refusal(const fs::path& model, const Workplace& place) {
  SCOPED_TRACE(model);
  const fs::path picture = place.path("picture.png");
  const Outcome outcome = render(model, picture);
  if (outcome.code != exit_done) {
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.code << ": " << outcome.err;
    EXPECT_FALSE(fs::exists(picture));
    return;
  }
  const auto image = read_png(picture);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, width_px);
}

std::vector<fs::path> files_in(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(assets / folder)) {
    if (format_from_name(entry.path()) != FileFormat::unknown || entry.path().extension() == ".jsonl")
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(RenderFiles, EveryBundledModelIsDrawn) {
  const Workplace place;
  const std::vector<fs::path> models = files_in("models");
  ASSERT_GE(models.size(), 16u);
  for (const fs::path& model : models) expect_picture(model, place);
}

TEST(RenderFiles, EveryBundledRecordingIsDrawn) {
  const Workplace place;
  const std::vector<fs::path> recordings = files_in("recordings");
  ASSERT_GE(recordings.size(), 14u);
  for (const fs::path& recording : recordings) expect_picture(recording, place);
}

// An octahedron with corners at 10 units of length.
TriangleMesh octahedron() {
  TriangleMesh mesh{{{10, 0, 0}, {-10, 0, 0}, {0, 10, 0}, {0, -10, 0}, {0, 0, 10}, {0, 0, -10}}, {}};
  for (const std::uint32_t x : {0u, 1u}) {
    for (const std::uint32_t y : {2u, 3u}) {
      for (const std::uint32_t z : {4u, 5u}) {
        const bool is_odd = (x + y + z) % 2 != 0;
        mesh.triangles.push_back(is_odd ? TriangleCorners{x, z, y} : TriangleCorners{x, y, z});
      }
    }
  }
  return mesh;
}

constexpr int point_count = 800;

// A Fibonacci lattice on a sphere with a radius of 10.
std::array<double, 3> point_on_sphere(int i) {
  const double y = 1.0 - 2.0 * (i + 0.5) / point_count, angle = 2.399963 * i, r = std::sqrt(1.0 - y * y);
  return {10.0 * r * std::cos(angle), 10.0 * y, 10.0 * r * std::sin(angle)};
}

std::string point_lines(const char* between) {
  std::string text;
  for (int i = 0; i < point_count; ++i) {
    const auto [x, y, z] = point_on_sphere(i);
    text += std::to_string(x) + between + std::to_string(y) + between + std::to_string(z) + "\n";
  }
  return text;
}

std::string pcd_header(const char* data) {
  const std::string count = std::to_string(point_count);
  return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + data + "\n";
}

std::string binary_pcd() {
  std::string text = pcd_header("binary");
  for (int i = 0; i < point_count; ++i) {
    for (const double coordinate : point_on_sphere(i)) {
      const auto number = static_cast<float>(1e-3 * coordinate);
      text.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }
  return text;
}

std::string ply_points() {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(point_count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + point_lines(" ");
}

// Writes a model in every format that the command reads. Returns the files.
std::vector<fs::path> write_all_formats(const Workplace& place) {
  std::vector<fs::path> files;
  const auto convert = [&](const char* name) {
    const Outcome outcome = run_process(
        SPOONBILL_PROGRAM, {"convert", (assets / "models" / "spoon-handle.json").string(), place.text(name)});
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    files.push_back(place.path(name));
  };
  const auto write = [&](const char* name, const std::string& text) {
    files.push_back(place.write(name, text));
  };
  for (const char* name : {"handle.step", "handle.iges", "handle.stl", "handle.obj", "handle.ply"})
    convert(name);
  for (const auto& [from, to] :
       {std::pair{"handle.step", "handle.stp"}, std::pair{"handle.iges", "capital.IGS"}}) {
    fs::copy_file(place.path(from), place.path(to));
    files.push_back(place.path(to));
  }
  write("text.stl", ascii_stl(octahedron()));
  write("binary.stl", binary_stl(octahedron()));
  write("text.obj", obj_text(octahedron()));
  write("text.ply", ply_text(octahedron()));
  write("binary.ply", binary_ply(octahedron()));
  write("points.ply", ply_points());
  write("text.pcd", pcd_header("ascii") + point_lines(" "));
  write("binary.pcd", binary_pcd());
  for (const char* name : {"points.xyz", "points.txt", "points.asc", "points.pts"})
    write(name, point_lines(" "));
  write("points.csv", point_lines(","));
  fs::copy_file(place.path("model.json"), place.path("document.json"));
  files.push_back(place.path("document.json"));
  files.push_back(place.path("script.json"));
  files.push_back(place.record("press.recording.jsonl"));
  return files;
}

TEST(RenderFiles, EveryFormatIsDrawn) {
  const Workplace place;
  const std::vector<fs::path> files = write_all_formats(place);
  EXPECT_GE(files.size(), 20u);
  for (const fs::path& file : files) expect_picture(file, place);
}

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A file that ends too early is drawn as far as it goes, or refused.
TEST(RenderFiles, ACutFileIsDrawnOrRefused) {
  const Workplace place;
  for (const fs::path& file : write_all_formats(place)) {
    const std::string content = content_of(file);
    expect_picture_or_refusal(
        place.write("cut-" + file.filename().string(), content.substr(0, content.size() / 2)), place);
  }
}

TEST(RenderFiles, AnEmptyFileIsRefused) {
  const Workplace place;
  for (const FileEnding& ending : file_endings) {
    expect_refusal(place.write("empty." + std::string(ending.ending), ""), place);
  }
  expect_refusal(place.write("empty.recording.jsonl", ""), place);
  expect_refusal(place.write("unknown.xyzw", "1 2 3"), place);
}

// Writes the octahedron with each coordinate times `scale`.
std::string scaled_obj(double scale) {
  TriangleMesh mesh = octahedron();
  for (Vector3& vertex : mesh.vertices_m) vertex *= scale;
  return obj_text(mesh);
}

TEST(RenderFiles, HugeAndTinyModelsAreRefusedAndOthersDrawn) {
  const Workplace place;
  for (const double scale : {1e-300, 1e-30, 1e-9, 1e-5, 1e6, 1e15, 1e38, 1e300}) {
    expect_refusal(place.write("scaled.obj", scaled_obj(scale)), place);
  }
  for (const double scale : {1e-3, 1e-2, 1.0, 1e2, 1e3}) {
    expect_picture(place.write("scaled.obj", scaled_obj(scale)), place);
  }
}

TEST(RenderFiles, DegenerateModelsAreDrawnOrRefused) {
  const Workplace place;
  std::string same, line;
  for (int i = 0; i < 100; ++i) {
    same += "1 2 3\n";
    line += std::to_string(i) + " 0 0\n";
  }
  const std::pair<const char*, std::string> texts[] = {
      {"same.xyz", same},
      {"line.xyz", line},
      {"one.xyz", "1 2 3\n"},
      {"two.xyz", "1 2 3\n4 5 6\n"},
      {"wide.xyz", "0 0 0\n1 0 0\n0 1 0\n1000000 1000000 1000000\n"},
      {"nan.xyz", "nan 0 0\n0 nan 0\n0 0 inf\n"},
      {"point.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n"},
      {"sliver.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"},
      {"missing.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"},
      {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
  };
  for (const auto& [name, text] : texts) expect_picture_or_refusal(place.write(name, text), place);
}

}  // namespace
}  // namespace spoonbill
