#include "engine/base/instruction_set.h"

#include <array>
#include <utility>

namespace spoonbill {

namespace {

constexpr std::array<std::pair<InstructionSet, std::string_view>, 3> names{
    {{InstructionSet::baseline, "baseline"},
     {InstructionSet::avx2, "avx2"},
     {InstructionSet::avx512, "avx512"}}};

bool runs_here(InstructionSet set) {
  switch (set) {
    case InstructionSet::baseline:
      return true;
    case InstructionSet::avx2:
      return __builtin_cpu_supports("avx2");
    case InstructionSet::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  }
  return false;
}

}  // namespace

InstructionSet best_instruction_set() {
  return available_instruction_sets().back();
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets;
  for (const auto& [set, name] : names) {
    if (runs_here(set)) sets.push_back(set);
  }
  return sets;
}

std::string_view name_of(InstructionSet set) {
  return names[static_cast<std::size_t>(set)].second;
}

}  // namespace spoonbill
