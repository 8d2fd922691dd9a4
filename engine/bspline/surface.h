// A B-spline surface: a knot vector for u, one for v, and a control net (Eq. 1 of Pungotra et al. 2013).
#pragma once

#include <vector>

#include "engine/base/box.h"
#include "engine/base/pose.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// The r x s control points in metres as a structure of arrays; point (i, j) lies at index i * columns + j,
// i along u.
struct ControlNet {
  int rows = 0;
  int columns = 0;
  std::vector<double> x, y, z;

  ControlNet() = default;
  ControlNet(int row_count, int column_count)
      : rows(row_count), columns(column_count), x(size()), y(size()), z(size()) {}

  std::size_t size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(j);
  }
  Vector3 point(int i, int j) const { return {x[index(i, j)], y[index(i, j)], z[index(i, j)]}; }
  void set_point(int i, int j, const Vector3& p) {
    x[index(i, j)] = p.x();
    y[index(i, j)] = p.y();
    z[index(i, j)] = p.z();
  }
};

// Returns the box about the control points, in which the surface is as well.
Box box_of(const ControlNet& net);

// A plain value with one owner. `net` may be changed in place; its size must stay what the knots ask for.
struct Surface {
  KnotVector u;
  KnotVector v;
  ControlNet net;
};

// Whether the net has the size that the knots ask for, and whether its coordinates are finite besides.
bool has_size_of_knots(const Surface& surface);
bool is_valid(const Surface& surface);

// Refused: a net whose size differs from the knots' control point counts, non-finite coordinates.
Result<Surface> make_surface(KnotVector u, KnotVector v, ControlNet net);

// The surface as a rigid thing at a pose; at the identity, as it was.
Surface placed(Surface surface, const Pose& pose);
// The same of its control net, over one of the same structure: turned, perhaps mirrored too, then moved.
void place(const ControlNet& net, const Eigen::Matrix3d& turn, const Vector3& position_m, ControlNet& placed);

// One point of a surface with its derivatives by the parameters, in double.
struct SurfacePoint {
  Vector3 position_m;
  Vector3 du, dv;
  Vector3 duu, duv, dvv;
};

// u, v are wrapped or clamped into the domain. Allocates nothing.
SurfacePoint evaluate(const Surface& surface, double u, double v);

// The position alone, to the same bits, at two fifths of the cost.
Vector3 position(const Surface& surface, double u, double v);

// The unit normal along du x dv. At poles and collapsed edges, where that product vanishes, the limit from
// inside the surface; zero where the surface has no normal at all (a single point or a line).
Vector3 unit_normal(const Surface& surface, double u, double v);

}  // namespace spoonbill
