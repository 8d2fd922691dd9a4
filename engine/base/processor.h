// The processor: the instruction sets that kernels are compiled for, and the handling of denormal numbers.
#pragma once

#include <string_view>
#include <vector>

namespace spoonbill {

// A vector instruction set. Results are the same to the last bit with every set, because kernels use no FMA
// contraction and no reduction whose order depends on the vector width.
enum class InstructionSet { baseline, avx2, avx512 };

// Returns the widest set that this processor supports.
InstructionSet best_instruction_set();

// Returns every set that this processor supports, narrowest first.
std::vector<InstructionSet> available_instruction_sets();

// Returns "baseline", "avx2" or "avx512".
std::string_view name_of(InstructionSet set);

// Flushes denormal numbers to zero on this thread while the object exists; its destructor restores the
// previous mode. Arithmetic with denormals is about a hundred times slower. All threads that compute a
// simulation must treat denormals alike, so that they get the same results.
class DenormalsFlushed {
 public:
  DenormalsFlushed();
  ~DenormalsFlushed();
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  unsigned saved_;  // previous value of the control and status register (MXCSR)
};

}  // namespace spoonbill
