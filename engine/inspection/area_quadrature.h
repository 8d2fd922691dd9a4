// Quadrature over what trims keep of a surface. Pure functions, outside the tick; any thread.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// `weight` is the part of the domain that the place stands for: |du x dv| times it is an area.
using AreaVisitor = std::function<void(const SurfacePoint& point, double weight)>;

// Of a whole surface exact up to degree 4 p + 1 along a direction of degree p (Gauss 1814). Of a trimmed one
// up to degree 5 over triangles, eight of a whole polynomial piece (Radon 1948), and as near to the loops as
// the edges of the area are.
void visit_area(const Surface& surface, const TrimmedArea& area, const AreaVisitor& visit);

}  // namespace spoonbill
