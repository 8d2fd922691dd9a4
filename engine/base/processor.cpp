#include "engine/base/processor.h"

#include <xmmintrin.h>

#include <array>
#include <utility>

namespace spoonbill {

namespace {

constexpr std::array<std::pair<InstructionSet, std::string_view>, 3> names{
    {{InstructionSet::baseline, "baseline"},
     {InstructionSet::avx2, "avx2"},
     {InstructionSet::avx512, "avx512"}}};

constexpr unsigned flush_to_zero = 0x8000u;
constexpr unsigned denormals_are_zero = 0x0040u;

bool is_supported(InstructionSet set) {
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
    if (is_supported(set)) sets.push_back(set);
  }
  return sets;
}

std::string_view name_of(InstructionSet set) {
  return names[static_cast<std::size_t>(set)].second;
}

DenormalsFlushed::DenormalsFlushed() : saved_(_mm_getcsr()) {
  _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
}

DenormalsFlushed::~DenormalsFlushed() {
  _mm_setcsr(saved_);
}

}  // namespace spoonbill
