#include "tests/pictures/approved.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/render/compare.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

const std::filesystem::path approved_folder = SPOONBILL_SCREENSHOTS;
const std::filesystem::path failure_folder = SPOONBILL_PICTURE_FAILURES;

}  // namespace

void compare_with_approved(const std::string& name, const Image& actual) {
  const auto approved_file = approved_folder / (name + ".png");
  if (std::getenv("SPOONBILL_APPROVE") != nullptr) {
    ASSERT_TRUE(write_png(approved_file, actual));
    return;
  }
  const auto approved = read_png(approved_file);
  ASSERT_TRUE(approved) << approved.error().message << "; look at the picture, then run tests/approve";
  const auto difference = worst_block_difference(approved.value(), actual);
  ASSERT_TRUE(difference) << difference.error().message;
  if (difference->worst <= picture_tolerance) return;
  std::filesystem::create_directories(failure_folder);
  ASSERT_TRUE(write_png(failure_folder / (name + ".expected.png"), approved.value()));
  ASSERT_TRUE(write_png(failure_folder / (name + ".actual.png"), actual));
  ASSERT_TRUE(write_png(failure_folder / (name + ".difference.png"),
                        difference_picture(approved.value(), actual).value()));
  FAIL() << name << " differs by " << difference->worst << " in the block at " << difference->x_px << ", "
         << difference->y_px << "; see " << failure_folder.string();
}

}  // namespace spoonbill
