#include "render/image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "render/contact_sheet.h"
#include "tests/render/compare.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

// Each test has its own folder, which is removed afterwards.
class ImageFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("spoonbill-image-") + test->name() + "-" + std::to_string(std::random_device()()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

Image noise(int width, int height, bool opaque) {
  std::mt19937 random(7);
  Image image;
  image.resize(width, height);
  for (std::uint8_t& value : image.rgba) value = static_cast<std::uint8_t>(random());
  for (std::size_t i = 3; opaque && i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

Image plain(int width, int height, std::uint8_t value) {
  Image image;
  image.resize(width, height);
  std::fill(image.rgba.begin(), image.rgba.end(), value);
  return image;
}

TEST_F(ImageFiles, PngComesBackUnchanged) {
  const auto path = folder_ / "picture.png";
  PngEncoder encoder;
  // Noise cannot be compressed, and a plain picture compresses to almost nothing.
  for (const Image& image : {noise(61, 37, true), noise(61, 37, false), noise(1, 1, true),
                             noise(1280, 720, true), plain(1280, 720, 255), plain(640, 480, 7)}) {
    ASSERT_TRUE(write_png(path, image, encoder, Durability::later).ok());
    const auto back = read_png(path);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back.value(), image);
  }
}

TEST_F(ImageFiles, EncodingGivesTheSameBytesAgain) {
  PngEncoder first, second;
  const Image image = noise(64, 48, true);
  ASSERT_TRUE(first.encode(plain(200, 100, 9)));
  const auto a = first.encode(image), b = second.encode(image);
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(std::equal(a->begin(), a->end(), b->begin(), b->end()));
}

TEST_F(ImageFiles, BrokenPngIsRefusedByName) {
  const auto path = folder_ / "broken.png";
  ASSERT_TRUE(write_png(path, noise(64, 64, true)).ok());
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  const auto cut = read_png(path);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::malformed);
  EXPECT_NE(cut.error().message.find("broken.png"), std::string::npos);

  std::ofstream(path, std::ios::trunc) << "no picture at all";
  EXPECT_FALSE(read_png(path));
  EXPECT_FALSE(read_png(folder_ / "missing.png"));
  EXPECT_FALSE(read_png(folder_));
}

TEST_F(ImageFiles, AFolderThatIsMissingIsAnErrorAndLeavesNothing) {
  const auto status = write_png(folder_ / "nowhere" / "a.png", noise(8, 8, true));
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::unwritable);
  EXPECT_NE(status.error().message.find("a.png"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ImageFiles, AFolderInItsPlaceIsAnErrorAndLeavesNothingBesideIt) {
  std::filesystem::create_directories(folder_ / "a.png" / "in it");
  EXPECT_FALSE(write_png(folder_ / "a.png", noise(8, 8, true)).ok());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST(PngEncoder, AnEmptyPictureAndATooLargeOneAreRefused) {
  PngEncoder encoder;
  EXPECT_FALSE(encoder.encode(Image{}));
  EXPECT_FALSE(encoder.encode(plain(16385, 1, 0)));
}

TEST(Comparison, OneChangedBlockIsFoundWhereItIs) {
  const Image expected = plain(640, 480, 128);
  Image actual = expected;
  for (int y = 96; y < 112; ++y) {
    for (int x = 320; x < 336; ++x) actual.pixel(x, y)[1] = 138;
  }
  const auto difference = worst_block_difference(expected, actual);
  ASSERT_TRUE(difference);
  EXPECT_DOUBLE_EQ(difference->worst, 10.0);
  EXPECT_EQ(difference->x_px, 320);
  EXPECT_EQ(difference->y_px, 96);
  EXPECT_DOUBLE_EQ(worst_block_difference(expected, expected)->worst, 0.0);

  const auto picture = difference_picture(expected, actual);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->pixel(328, 104)[1], 128 / 4 + 80);
}

TEST(Comparison, SmallerBlocksAtTheEdgeCountInFull) {
  const Image expected = plain(20, 20, 0);
  Image actual = expected;
  for (int y = 16; y < 20; ++y) {
    for (int x = 16; x < 20; ++x) actual.pixel(x, y)[0] = 4;
  }
  EXPECT_DOUBLE_EQ(worst_block_difference(expected, actual)->worst, 4.0);
}

TEST(Comparison, DifferentSizesAreRefused) {
  EXPECT_FALSE(worst_block_difference(plain(4, 4, 0), plain(4, 5, 0)));
}

TEST(Shrink, AveragesInLinearLight) {
  Image checker = plain(4, 4, 255);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      if ((x + y) % 2 == 0) std::fill_n(checker.pixel(x, y), 3, std::uint8_t{0});
    }
  }
  const Image small = shrink(checker, 2, 2);
  EXPECT_EQ(small.pixel(1, 1)[0], 188) << "half the light, not half the code";
  EXPECT_EQ(shrink(plain(30, 20, 77), 7, 5).pixel(6, 4)[0], 77);
}

TEST(ContactSheet, PlacesFramesInAGridWithMargins) {
  ContactSheetLayout layout;
  layout.columns = 2;
  layout.cell_width_px = 40;
  layout.margin_px = 4;
  ContactSheet sheet(layout);
  for (const int value : {10, 60, 110}) sheet.add(plain(80, 60, static_cast<std::uint8_t>(value)));
  const auto picture = sheet.compose();
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 2 * 44 + 4);
  EXPECT_EQ(picture->height, 2 * 34 + 4);
  EXPECT_EQ(picture->pixel(10, 10)[0], 10);
  EXPECT_EQ(picture->pixel(60, 10)[0], 60);
  EXPECT_EQ(picture->pixel(10, 50)[0], 110);
  EXPECT_EQ(picture->pixel(1, 1)[0], 250);
  EXPECT_EQ(picture->pixel(1, 1)[3], 255);
}

TEST(ContactSheet, NeedsFramesAndTheFontOfItsCaptions) {
  EXPECT_EQ(ContactSheet({}).compose().error().code, ErrorCode::too_few);
  ContactSheetLayout layout;
  layout.caption_px = 14;
  layout.caption_font_path = "/nonexistent/font.ttf";
  ContactSheet sheet(layout);
  sheet.add(plain(40, 30, 5), "0.10 s");
  const auto picture = sheet.compose();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::unreadable);
  EXPECT_NE(picture.error().message.find("/nonexistent/font.ttf"), std::string::npos);
}

}  // namespace
}  // namespace spoonbill
