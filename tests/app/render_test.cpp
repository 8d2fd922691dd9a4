// Tests the render command of the built program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/program.h"
#include "engine/base/geometry.h"
#include "tests/app/mesh_texts.h"
#include "tests/app/process.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

const std::string handle = std::string(SPOONBILL_ASSETS) + "/models/spoon-handle.json";

Outcome render(std::vector<std::string> arguments, const std::string& out) {
  arguments.insert(arguments.begin(), "render");
  for (const std::string& word :
       {std::string("--size"), std::string("320x180"), std::string("--json"), std::string("--out"), out})
    arguments.push_back(word);
  return run_process(SPOONBILL_PROGRAM, arguments);
}

Image picture_of(std::vector<std::string> arguments, const Workplace& place) {
  const Outcome outcome = render(std::move(arguments), place.text("picture.png"));
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  auto image = read_png(place.path("picture.png"));
  return image ? std::move(image).value() : Image{};
}

// Bounds of the pixels that a picture without background covers with more than a soft shadow.
Box2 covered(const Image& image) {
  Box2 box;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.pixel(x, y)[3] > 240) box.include({x, y});
    }
  }
  return box;
}

TriangleMesh tetrahedron() {
  return {{{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {0.0, 10.0, 0.0}, {0.0, 0.0, 10.0}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

std::string sphere_points() {
  std::string text;
  for (int i = 0; i < 2000; ++i) {  // a Fibonacci lattice on a sphere of 10 mm
    const double y = 1.0 - 2.0 * (i + 0.5) / 2000.0, angle = 2.399963 * i, r = std::sqrt(1.0 - y * y);
    text += std::to_string(10.0 * r * std::cos(angle)) + ' ' + std::to_string(10.0 * y) + ' ' +
            std::to_string(10.0 * r * std::sin(angle)) + '\n';
  }
  return text;
}

// A model of any kind is centred and fills most of the picture in one direction.
TEST(Render, ShowsModelsOfAllKinds) {
  const Workplace place;
  place.write("corner.stl", binary_stl(tetrahedron()));
  place.write("corner.ply", ply_text(tetrahedron()));
  place.write("cloud.xyz", sphere_points());
  ASSERT_EQ(run_process(SPOONBILL_PROGRAM, {"convert", handle, place.text("handle.step")}).code, exit_done);
  const std::string recording = place.record("press.recording.jsonl").string();
  for (const std::string& model :
       {handle, recording, place.text("script.json"), place.text("handle.step"), place.text("corner.stl"),
        place.text("corner.ply"), place.text("cloud.xyz")}) {
    SCOPED_TRACE(model);
    const Image image = picture_of({model, "--transparent"}, place);
    ASSERT_EQ(image.width, 320);
    const Box2 box = covered(image);
    ASSERT_FALSE(box.is_empty());
    const Eigen::Vector2d middle = box.centre(), size = box.extent();
    EXPECT_NEAR(middle.x(), 160.0, 16.0);
    EXPECT_NEAR(middle.y(), 90.0, 16.0);
    EXPECT_GT(std::max(size.x() / 320.0, size.y() / 180.0), 0.6);
    EXPECT_LT(std::max(size.x() / 320.0, size.y() / 180.0), 0.95);
  }
}

// The discs of a cloud cover nearly all of it.
TEST(Render, ShowsACloudAsASurface) {
  const Workplace place;
  place.write("cloud.xyz", sphere_points());
  const Image image = picture_of({place.text("cloud.xyz"), "--transparent", "--view", "front"}, place);
  const Box2 box = covered(image);
  const double radius_px = 0.25 * box.extent().sum();
  int inside = 0, opaque = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if ((Eigen::Vector2d(x, y) - box.centre()).norm() > 0.95 * radius_px) continue;
      ++inside;
      opaque += image.pixel(x, y)[3] > 240;
    }
  }
  EXPECT_GT(opaque, 0.98 * inside);
}

TEST(Render, LooksFromTheChosenSide) {
  const Workplace place;
  // The handle is 102 mm long, 13 mm wide and 6 mm high.
  const Eigen::Vector2d front =
      covered(picture_of({handle, "--transparent", "--view", "front"}, place)).extent();
  const Eigen::Vector2d top = covered(picture_of({handle, "--transparent", "--view", "top"}, place)).extent();
  EXPECT_GT(front.x(), 10.0 * front.y());
  EXPECT_GT(top.y(), 1.5 * front.y());
  EXPECT_EQ(picture_of({handle, "--view", "0,0"}, place), picture_of({handle, "--view", "front"}, place));
}

TEST(Render, ShowsTheChosenMaterialAndOverlays) {
  const Workplace place;
  const Image plain = picture_of({handle}, place);
  EXPECT_NE(picture_of({handle, "--material", "steel"}, place), plain);
  EXPECT_NE(picture_of({handle, "--overlays", "grid"}, place), plain);
  EXPECT_NE(picture_of({handle, "--overlays", "net,scale"}, place), plain);
  EXPECT_NE(picture_of({handle, "--overlays", "tool"}, place), plain);
  EXPECT_EQ(plain.pixel(0, 0)[3], 255);
  const Image alone = picture_of({handle, "--transparent"}, place);
  EXPECT_EQ(alone.pixel(0, 0)[3], 0);
  const std::uint8_t *in_middle = plain.pixel(160, 90), *without = alone.pixel(160, 90);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(in_middle[c], without[c]);
}

TEST(Render, ShowsSeveralModelsTogether) {
  const Workplace place;
  const Outcome outcome =
      render({handle, std::string(SPOONBILL_ASSETS) + "/models/bowl.json"}, place.text("picture.png"));
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["bodies"], 2);
}

TEST(Render, ShowsTheToolOnMeshesToo) {
  const Workplace place;
  place.write("corner.stl", binary_stl(tetrahedron()));
  const std::string corner = place.text("corner.stl");
  EXPECT_NE(picture_of({corner, "--overlays", "tool", "--force"}, place),
            picture_of({corner, "--force"}, place));
}

TEST(Render, ReadsMeshesInTheGivenUnit) {
  const Workplace place;
  place.write("corner.stl", binary_stl(tetrahedron()));
  for (const auto& [unit, size_m] : {std::pair("mm", 0.01), std::pair("in", 0.254)}) {
    const Outcome outcome =
        render({place.text("corner.stl"), "--unit", unit, "--force"}, place.text("picture.png"));
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    EXPECT_NEAR(json_of(outcome.out)["size_m"][0].get<double>(), size_m, 1e-6);
  }
}

TEST(Render, RefusesWhatItCannotDraw) {
  const Workplace place;
  place.write("empty.ply", "");
  place.write("damaged.step", "ISO-10303-21; nothing");
  const std::string picture = place.text("picture.png");
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {place.text("missing.json")},
           {place.text("empty.ply")},
           {place.text("damaged.step")},
           {std::string(SPOONBILL_ASSETS) + "/materials/wax.json"},
           {handle, "--view", "behind"},
           {handle, "--view", "10,95"},
           {handle, "--overlays", "grid,fog"},
           {handle, "--studio", "dusk"},
           {handle, "--unit", "m"},
           {handle, "--material", "unobtainium"},
           {handle, "--turntable", "10"},
       }) {
    const Outcome outcome = render(wrong, picture);
    EXPECT_TRUE(is_clean_failure(outcome)) << wrong.back() << ": " << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(picture)) << wrong.back();
  }
  EXPECT_TRUE(is_clean_failure(render({handle}, place.text("picture.jpg"))));
}

}  // namespace
}  // namespace spoonbill
