// Compares the last frames of trials with approved pictures: a jelly that lies in a spoon.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "tests/app/workplace.h"
#include "tests/engine/effort.h"
#include "tests/pictures/approved.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

// Compares the end of a trial that tilts the spoon, half a second after the turn. The bodies have the given
// friction.
void compare_tilted(const std::string& tilt, double friction, const std::string& name) {
  const Workplace place;
  Document document = read_document(std::string(SPOONBILL_ASSETS) + "/models/jelly-on-spoon.json").value();
  for (Body& body : document.scene.bodies) body.material.friction = friction;
  place.write("jelly-on-spoon.json", json_to_page(document_to_json(document)));
  const Outcome outcome = run({"try", place.text("jelly-on-spoon.json"), "--tilt", tilt, "--seconds", "0.5",
                               "--every", "1000000", "--out", place.text("frames")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::vector<std::filesystem::path> frames;
  for (const auto& entry : std::filesystem::directory_iterator(place.path("frames"))) {
    frames.push_back(entry.path());
  }
  ASSERT_EQ(frames.size(), 2u) << "the first and the last frame";
  const auto last = read_png(*std::max_element(frames.begin(), frames.end()));
  ASSERT_TRUE(last) << last.error().message;
  compare_with_approved(name, last.value());
}

TEST(TrialPictures, AJellyInATiltedSpoon) {
  compare_tilted("10deg", 0.1, "jelly-tilted-10");
}

// Only a full run draws these, because the first one runs the same code.
TEST(TrialPictures, AJellyInASpoonAtOtherAngles) {
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  compare_tilted("0deg", 0.1, "jelly-level");
  compare_tilted("20deg", 0.1, "jelly-tilted-20");
  compare_tilted("30deg", 0.3, "jelly-tilted-30");  // with the bundled friction, it leaves the spoon
}

}  // namespace
}  // namespace spoonbill
