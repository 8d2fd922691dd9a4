// The vector instruction sets that the kernels are compiled for. Every set gives the same bits: the kernels
// use no FMA contraction and no reduction whose order depends on the vector width.
#pragma once

#include <string_view>
#include <vector>

namespace spoonbill {

enum class InstructionSet { baseline, avx2, avx512 };

// The widest set that this processor runs.
InstructionSet best_instruction_set();

// Every set that this processor runs, narrowest first.
std::vector<InstructionSet> available_instruction_sets();

// "baseline", "avx2", "avx512".
std::string_view name_of(InstructionSet set);

}  // namespace spoonbill
