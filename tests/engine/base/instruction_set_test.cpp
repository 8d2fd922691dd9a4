#include <gtest/gtest.h>

#include "engine/base/processor.h"

namespace spoonbill {
namespace {

TEST(InstructionSet, EveryNameLeadsBackToItsSet) {
  EXPECT_EQ(name_of(InstructionSet::baseline), "baseline");
  EXPECT_EQ(name_of(InstructionSet::avx2), "avx2");
  EXPECT_EQ(name_of(InstructionSet::avx512), "avx512");
}

TEST(InstructionSet, TheBaselineIsAlwaysThereAndTheBestIsTheLast) {
  const auto sets = available_instruction_sets();
  ASSERT_FALSE(sets.empty());
  EXPECT_EQ(sets.front(), InstructionSet::baseline);
  EXPECT_EQ(sets.back(), best_instruction_set());
}

}  // namespace
}  // namespace spoonbill
