#include "app/start/lump_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/start/shipped_materials.h"
#include "engine/simulation/simulation.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Every kind with its usual sizes is a document that can be simulated as it is.
TEST(LumpChoice, EveryKindMakesALumpToBePressed) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Material clay = shipped_material("modelling-clay").value();
  for (std::size_t kind = 0; kind < lump_kinds().size(); ++kind) {
    const auto document = lump_document(usual_choice(kind), clay);
    ASSERT_TRUE(document.ok()) << lump_kinds()[kind].name << ": " << document.error().message;
    const auto simulation = Simulation::make(document->scene, best_instruction_set());
    EXPECT_TRUE(simulation.ok()) << lump_kinds()[kind].name << ": " << simulation.error().message;
    const ControlNet& net = document->scene.bodies[0].surface.net;
    EXPECT_LE(net.size(), 1200U) << lump_kinds()[kind].name;
  }
}

TEST(LumpChoice, SizesAreThoseThatWereTyped) {
  LumpChoice box = usual_choice(1);
  box.sizes_mm = {50.0, 30.0, 25.0, 2.0};
  const Document document = lump_document(box, shipped_material("clay").value()).value();
  const Surface& surface = document.scene.bodies[0].surface;
  Vector3 high = Vector3::Zero();
  for (double u = 0.0; u < 1.0; u += 0.01) {
    for (double v = 0.0; v <= 1.0; v += 0.01) high = high.cwiseMax(position(surface, u, v));
  }
  EXPECT_LT((high - Vector3(0.025, 0.015, 0.0125)).norm(), 5e-4);
}

TEST(LumpChoice, SaysWhichSizeIsWrong) {
  const Material clay = shipped_material("clay").value();
  for (std::size_t kind = 0; kind < lump_kinds().size(); ++kind) {
    for (std::size_t field = 0; field < lump_kinds()[kind].fields.size(); ++field) {
      for (const double wrong : {-1.0, 0.0, 1e9, std::nan("")}) {
        LumpChoice choice = usual_choice(kind);
        choice.sizes_mm[field] = wrong;
        const auto document = lump_document(choice, clay);
        ASSERT_FALSE(document.ok());
        EXPECT_FALSE(document.error().message.empty());
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
