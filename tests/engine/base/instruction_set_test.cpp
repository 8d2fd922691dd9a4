#include "engine/base/instruction_set.h"

#include <gtest/gtest.h>

namespace spoonbill {
namespace {

TEST(InstructionSet, EveryNameLeadsBackToItsSet) {
  for (const InstructionSet set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    EXPECT_EQ(instruction_set_from_name(name_of(set)), set);
  }
  EXPECT_FALSE(instruction_set_from_name("AVX2"));
  EXPECT_FALSE(instruction_set_from_name(""));
}

TEST(InstructionSet, TheBaselineIsAlwaysThereAndTheBestIsTheLast) {
  const auto sets = available_instruction_sets();
  ASSERT_FALSE(sets.empty());
  EXPECT_EQ(sets.front(), InstructionSet::baseline);
  EXPECT_EQ(sets.back(), best_instruction_set());
}

}  // namespace
}  // namespace spoonbill
