// Places where a fitted surface turns against the data, or against itself.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {

struct FoldCheck {
  std::size_t samples = 0, folds = 0, cusps = 0;
  std::vector<bool> span_folds, span_cusps;  // u-major, one for each pair of spans

  bool is_clean() const { return folds + cusps == 0; }
  bool better_than(const FoldCheck& other) const {
    return folds < other.folds || (folds == other.folds && cusps < other.cusps);
  }
};

// The normals of a scan where its points lie on the surface; normals may be none, or estimated where the scan
// has none.
struct NormalsAtParameters {
  std::span<const Vector2> uv;
  std::span<const Vector3> normals;
  bool are_estimated = false;
};

// Samples each span four by four. A sample folds where its normal points against the normals of all of the
// six points nearest in (u, v), counted in spans, the first within a span: on thin walls the point nearest in
// space may lie on the other face, and over a sharp rim the data's normals turn from point to point. Of a
// scan without normals, where it points against estimated ones, of which some places have none, or against
// that of the next sample. Poles, where there is no normal, are passed over.
//
// Cusps are counted twelve by twelve: where the normal turns by more than 120 degrees from one sample to the
// next, the surface turns back on itself in a loop too small for the points to tell, or has an edge far
// sharper than its knots can follow.
FoldCheck check_folds(const Surface& surface, const NormalsAtParameters& data);

}  // namespace spoonbill
