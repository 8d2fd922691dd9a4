// Conversion of surfaces to and from OpenCASCADE, and the closing of seams and poles that CAD files leave
// slightly open. OpenCASCADE's lengths are millimetres.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

inline constexpr double millimetres_per_metre = 1e3;

// Converts a surface exactly. The result is open and clamped in both directions: a periodic direction is
// opened at its seam by knot insertion, and knots are inserted at the ends of an open direction that is not
// clamped. Refused: knots that differ but that OpenCASCADE treats as equal.
Result<opencascade::handle<Geom_BSplineSurface>> to_occt(const Surface& surface);

// Converts a surface that is neither rational nor periodic exactly. Refused: a degree above max_degree,
// invalid knots, coordinates that are not finite.
Result<Surface> from_occt(const Geom_BSplineSurface& surface);

// Makes the surface periodic in `direction`, in which it must be clamped, if its two edges coincide to
// `tolerance_m`. The seam gets the smallest multiplicity at which no control point of the open form moves by
// more than the tolerance. Returns the surface unchanged if the edges do not coincide, if an edge is a single
// point, or if no multiplicity is sufficient.
Surface close_seam(const Surface& surface, Direction direction, double tolerance_m);

// Moves all control points of an edge to their mean if none is farther than `tolerance_m` from it. Applies to
// the edges at the ends of each direction that is not periodic.
void close_poles(Surface& surface, double tolerance_m);

struct ClosedSurface {
  Surface surface;
  double moved_m = 0.0;  // largest displacement of a sampled surface point
};

// Closes a surface that find_closing() classifies as solid: its seams become periodic and its poles single
// points. A seam or a pole that cannot be closed within the tolerance stays as it is. Any other surface is
// returned unchanged.
ClosedSurface close_exactly(const Surface& surface);

// Returns the Greville parameters, one for each control point. Interpolation at these parameters is well
// conditioned. Each is the mean of the inner knots that a basis function spans (Greville 1964), shifted into
// the domain.
std::vector<double> greville_parameters(const KnotVector& knots);

}  // namespace spoonbill
