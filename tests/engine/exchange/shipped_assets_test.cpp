// Checks that the bundled assets can be read and used.
#include <gtest/gtest.h>

#include "engine/base/processor.h"
#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {
namespace {

const std::filesystem::path assets = SPOONBILL_ASSETS;

TEST(ShippedAssets, MaterialsAreNamedLikeTheirFilesAndSaySources) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(assets / "materials")) {
    const Result<Material> material = read_material(entry.path());
    ASSERT_TRUE(material.ok()) << material.error().message;
    EXPECT_EQ(material->name, entry.path().stem().string());
    EXPECT_GT(material->source.size(), 20u) << material->name;
    ++count;
  }
  EXPECT_GE(count, 8);
}

// In every bundled material, the springs of the handle are stable in the first tick: no node has to be slowed
// down.
TEST(ShippedAssets, TheHandleCanBeSculptedInEveryMaterial) {
  Result<Document> document = read_document(assets / "models" / "spoon-handle.json");
  ASSERT_TRUE(document.ok()) << document.error().message;
  Result<Simulation> simulation = Simulation::make(document->scene, best_instruction_set());
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  for (const auto& entry : std::filesystem::directory_iterator(assets / "materials")) {
    const Status applied = simulation->apply(SetMaterial{read_material(entry.path()).value()});
    ASSERT_TRUE(applied.ok()) << applied.error().message;
    const Reaction reaction = simulation->advance({});
    EXPECT_EQ(reaction.flags & tick_flag_nodes_slowed, 0u) << entry.path();
    EXPECT_GE(simulation->inertia_scale(), 1.0) << entry.path();
  }
}

}  // namespace
}  // namespace spoonbill
