#include <gtest/gtest.h>

#include <cmath>

#include "app/files/documents.h"
#include "engine/simulation/simulation.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Every stock shape of default size gives a document that can be simulated.
TEST(LumpChoice, EveryKindMakesALumpToBePressed) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Material clay = shipped_material("modelling-clay").value();
  for (std::size_t kind = 0; kind < stock_shape_kinds().size(); ++kind) {
    const auto document = make_stock_shape_document(default_stock_shape(kind), clay);
    ASSERT_TRUE(document.ok()) << stock_shape_kinds()[kind].name << ": " << document.error().message;
    const auto simulation = Simulation::make(document->scene, best_instruction_set());
    EXPECT_TRUE(simulation.ok()) << stock_shape_kinds()[kind].name << ": " << simulation.error().message;
    const ControlNet& net = document->scene.bodies[0].surface.net;
    EXPECT_LE(net.size(), 1200U) << stock_shape_kinds()[kind].name;
  }
}

TEST(LumpChoice, SizesAreThoseThatWereTyped) {
  StockShapeChoice box = default_stock_shape(1);
  box.sizes_mm = {50.0, 30.0, 25.0, 2.0};
  const Document document = make_stock_shape_document(box, shipped_material("clay").value()).value();
  const Surface& surface = document.scene.bodies[0].surface;
  Vector3 high = Vector3::Zero();
  for (double u = 0.0; u < 1.0; u += 0.01) {
    for (double v = 0.0; v <= 1.0; v += 0.01) high = high.cwiseMax(position(surface, u, v));
  }
  EXPECT_LT((high - Vector3(0.025, 0.015, 0.0125)).norm(), 5e-4);
}

TEST(LumpChoice, SaysWhichSizeIsWrong) {
  const Material clay = shipped_material("clay").value();
  for (std::size_t kind = 0; kind < stock_shape_kinds().size(); ++kind) {
    for (std::size_t field = 0; field < stock_shape_kinds()[kind].fields.size(); ++field) {
      for (const double wrong : {-1.0, 0.0, 1e9, std::nan("")}) {
        StockShapeChoice choice = default_stock_shape(kind);
        choice.sizes_mm[field] = wrong;
        const auto document = make_stock_shape_document(choice, clay);
        ASSERT_FALSE(document.ok());
        EXPECT_FALSE(document.error().message.empty());
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
