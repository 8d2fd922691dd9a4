// What is touched of a thin shell: its surface, which is the one face of it, from the side of its normals;
// and from behind its far face, a thickness away. Neither is felt through the other.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/collision/proximity/surface_proximity.h"

namespace spoonbill {

// By how much a shell is nearer to something than its surface is, in some place: where that pushes it along
// the unit `push`, outward there as far as its normal has a part of it. Exact for what is flat.
double far_face_lead_m(double thickness_m, const Vector3& normal, const Vector3& push);

// Of a point near the surface's point (u, v), the gap to the face on whose side it is, and the normal out of
// that face: behind the middle of the thickness it is on the far side. False where the point lies beside the
// rim, so that it touches neither, or beyond the margin.
bool gap_to_shell(const Surface& shell, double thickness_m, double u, double v, const Vector3& point_m,
                  double margin_m, Vector3& normal, double& gap_m);

// What a near point of one surface is to another where either is a shell's; a thickness of 0 is none. False
// where it is not near after all. Allocates nothing.
struct MaybeShell {
  const Surface* surface;
  double thickness_m;
};
bool settle_shell_gap(const MaybeShell& of, const MaybeShell& other, double margin_m, NearPoint& near);

}  // namespace spoonbill
