#include "engine/trial/verdict.h"

namespace spoonbill {

Verdict judge(const Spill& spill, bool is_settled) {
  if (spill.first_spill_s || spill.left_s) return Verdict::leaves;
  if (!is_settled) return Verdict::undecided;
  return spill.outside_fraction < overhang_limit_fraction ? Verdict::holds : Verdict::overhangs;
}

}  // namespace spoonbill
