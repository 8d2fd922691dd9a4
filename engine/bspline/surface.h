// B-spline surfaces: a knot vector for u, one for v and a control net (Eq. 1 of Pungotra et al. 2013).
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Coordinates of control points in metres, in single or double precision, in the order of ControlNet. A view:
// does not own the coordinates.
template <class Real>
struct NetView {
  const Real* x;
  const Real* y;
  const Real* z;
  int columns;
};

// Returns the same as unit_normal(Surface), but from a view of the control points. u and v are wrapped or
// clamped into the domain. Computes in double precision and does not allocate.
template <class Real>
Vector3 unit_normal(const KnotVector& u_knots, const KnotVector& v_knots, const NetView<Real>& net, double u,
                    double v);

extern template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<float>&, double,
                                    double);
extern template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<double>&, double,
                                    double);

// The control points of a surface in metres, rows x columns, as a structure of arrays. Point (i, j) has the
// index i * columns + j; i runs along u.
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

// Returns the box around the control points, which also contains the surface.
Box bounding_box(const ControlNet& net);

// A B-spline surface: a plain value with one owner. `net` may be changed in place, but must keep the size
// that the knots require.
struct Surface {
  KnotVector u;
  KnotVector v;
  ControlNet net;
};

// Returns whether the net has as many rows and columns as the knots require.
bool has_matching_net(const Surface& surface);
// Returns whether the net has the size that the knots require and only finite coordinates.
bool is_valid(const Surface& surface);

// Returns the knot vector of a direction.
const KnotVector& knots_along(const Surface& surface, Direction direction);

// Makes a surface. Refuses a net whose size differs from the knots' control point counts, and non-finite
// coordinates.
Result<Surface> make_surface(KnotVector u, KnotVector v, ControlNet net);

// Returns the surface moved rigidly by a pose.
Surface placed(Surface surface, const Pose& pose);
// Rotates or reflects the control points of `net` by `turn`, moves them, and writes them to `placed`, which
// must have the same size.
void place(const ControlNet& net, const Eigen::Matrix3d& turn, const Vector3& position_m, ControlNet& placed);

// A point of a surface and its derivatives with respect to the parameters, in metres.
struct SurfacePoint {
  Vector3 position_m;
  Vector3 du, dv;
  Vector3 duu, duv, dvv;
};

// Returns the point and its derivatives. u, v are wrapped or clamped into the domain. Does not allocate.
SurfacePoint evaluate(const Surface& surface, double u, double v);

// Returns only the position, with the same bits as evaluate(), at two fifths of the cost.
Vector3 position(const Surface& surface, double u, double v);

// Returns the unit normal along du x dv. At an edge that is a single point, such as a pole, du x dv vanishes;
// the function then returns the limit from inside the surface. Returns zero if there is no limit, because the
// surface is only a point or a line.
Vector3 unit_normal(const Surface& surface, double u, double v);

// Returns a bound, in metres, of how far a surface point moves when one parameter changes by the length of
// its domain. If u and v change by the fractions a and b of their domains, the point moves by at most
// hypot(a, b) times the bound.
double stretch_bound_m(const Surface& surface);

}  // namespace spoonbill
