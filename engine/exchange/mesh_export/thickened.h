// The triangles of a shell: its outer face, the face behind it, and walls between the edges of both.
#pragma once

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Each vertex of the outer face once more, `thickness_m` (above 0) behind it along its normal, the mean of
// its triangles' by their areas. Closed where the outer face has no edge of more than two triangles. On a
// face curved by 1 / r the distance between both is the thickness to about the square of a triangle's side
// over r. Refused: what is thicker than it is curved, where triangles of the inner face turn over; the
// message says where. Pure, outside the tick; any thread.
Result<TriangleMesh> thickened(const TriangleMesh& outer, double thickness_m);

}  // namespace spoonbill
