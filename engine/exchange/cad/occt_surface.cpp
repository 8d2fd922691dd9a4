#include "engine/exchange/cad/occt_surface.h"

#include <Eigen/LU>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

// One direction of an OpenCASCADE surface. `controls` has, for each pole (OpenCASCADE's control point), the
// index of the same control point in the program's surface.
struct OcctDirection {
  TColStd_Array1OfReal knots;
  TColStd_Array1OfInteger multiplicities;
  std::vector<int> controls;
};

// Returns the knots of one period with clamped ends. The multiplicity of the knot at the seam must equal the
// degree.
std::vector<double> clamped_period(const KnotVector& knots) {
  const auto degree = static_cast<std::size_t>(knots.degree());
  std::vector<double> period(degree + 1, knots.domain_start());
  for (const double knot : knots.extended_knots()) {
    if (knot > knots.domain_start() && knot < knots.domain_end()) period.push_back(knot);
  }
  period.insert(period.end(), degree + 1, knots.domain_end());
  return period;
}

OcctDirection to_occt_direction(const KnotVector& direction) {
  const bool periodic = direction.is_periodic();
  const std::vector<double> all = periodic ? clamped_period(direction) : direction.knots();
  std::vector<double> distinct = all;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const int count = static_cast<int>(distinct.size());
  OcctDirection result{TColStd_Array1OfReal(1, count), TColStd_Array1OfInteger(1, count), {}};
  for (int i = 0; i < count; ++i) {
    const double knot = distinct[static_cast<std::size_t>(i)];
    result.knots(i + 1) = knot;
    result.multiplicities(i + 1) = static_cast<int>(std::count(all.begin(), all.end(), knot));
  }
  const int poles = static_cast<int>(all.size()) - direction.degree() - 1;
  const int first = periodic ? direction.control_index(direction.find_span(direction.domain_start()), 0) : 0;
  for (int i = 0; i < poles; ++i) {
    result.controls.push_back(periodic ? (first + i) % direction.control_point_count() : i);
  }
  return result;
}

// Raises the multiplicity of the seam's knot of a periodic direction to the degree.
Result<Surface> insert_full_seam(const Surface& surface, Direction direction) {
  const KnotVector& knots = direction == Direction::u ? surface.u : surface.v;
  if (!knots.is_periodic()) return surface;
  return insert_knot(surface, direction, knots.domain_start(), knots.degree());
}

bool is_clamped(const KnotVector& knots) {
  return knots.is_clamped(false) && knots.is_clamped(true);
}

bool has_unclamped_end(const KnotVector& knots) {
  return !knots.is_periodic() && !is_clamped(knots);
}

std::vector<double> flat_knots(const TColStd_Array1OfReal& knots,
                               const TColStd_Array1OfInteger& multiplicities) {
  std::vector<double> flat;
  for (int i = knots.Lower(); i <= knots.Upper(); ++i) {
    flat.insert(flat.end(), static_cast<std::size_t>(multiplicities(i)), knots(i));
  }
  return flat;
}

using ControlMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Returns the control points as a matrix. Row k has the coordinates of all control points whose index along
// `direction` is k.
ControlMatrix control_lines(const Surface& surface, Direction direction) {
  const ControlNet& net = surface.net;
  const bool along_u = direction == Direction::u;
  ControlMatrix lines(along_u ? net.rows : net.columns, 3 * (along_u ? net.columns : net.rows));
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const Vector3 point = net.point(i, j);
      for (int axis = 0; axis < 3; ++axis) {
        (along_u ? lines(i, 3 * j + axis) : lines(j, 3 * i + axis)) = point[axis];
      }
    }
  }
  return lines;
}

// Returns the surface `like` with other knots and control points along `direction`.
Surface replace_controls(const Surface& like, Direction direction, const KnotVector& knots,
                         const ControlMatrix& lines) {
  const bool along_u = direction == Direction::u;
  const auto rows = static_cast<int>(along_u ? lines.rows() : lines.cols() / 3);
  const auto columns = static_cast<int>(along_u ? lines.cols() / 3 : lines.rows());
  Surface surface{along_u ? knots : like.u, along_u ? like.v : knots, ControlNet(rows, columns)};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const auto at = [&](int axis) { return along_u ? lines(i, 3 * j + axis) : lines(j, 3 * i + axis); };
      surface.net.set_point(i, j, {at(0), at(1), at(2)});
    }
  }
  return surface;
}

double largest_point_distance(const ControlMatrix& a, const ControlMatrix& b) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j + 2 < a.cols(); j += 3) {
      largest = std::max(largest, (a.block(i, j, 1, 3) - b.block(i, j, 1, 3)).norm());
    }
  }
  return largest;
}

// Returns periodic knots that have the inner knots of an open, clamped direction, and a seam of the given
// multiplicity.
Result<KnotVector> periodic_knots(const KnotVector& open, int seam_multiplicity) {
  std::vector<double> knots(static_cast<std::size_t>(seam_multiplicity), open.domain_start());
  for (const double knot : open.knots()) {
    if (knot > open.domain_start() && knot < open.domain_end()) knots.push_back(knot);
  }
  knots.push_back(open.domain_end());
  return KnotVector::periodic(open.degree(), std::move(knots));
}

// Returns the control points that a periodic surface has after it is opened at its seam, for comparison with
// those of an open surface.
ControlMatrix opened_lines(const Surface& periodic, Direction direction) {
  const KnotVector& before = direction == Direction::u ? periodic.u : periodic.v;
  const auto full = insert_knot(periodic, direction, before.domain_start(), before.degree());
  if (!full) return {};
  const KnotVector& knots = direction == Direction::u ? full->u : full->v;
  const ControlMatrix lines = control_lines(full.value(), direction);
  const int count = knots.control_point_count();
  const int first = knots.control_index(knots.find_span(knots.domain_start()), 0);
  ControlMatrix opened(lines.rows() + 1, lines.cols());
  for (int i = 0; i <= count; ++i) opened.row(i) = lines.row((first + i) % count);
  return opened;
}

// An edge is joined to a pole if none of its control points is farther from their mean than this multiple of
// closing_tolerance_m. It is above 1, because control points are farther apart than the points of the edge.
constexpr double control_spread = 10.0;
constexpr int moved_samples = 64;

}  // namespace

Result<opencascade::handle<Geom_BSplineSurface>> to_occt(const Surface& surface) {
  auto opened = insert_full_seam(surface, Direction::u);
  if (opened) opened = insert_full_seam(opened.value(), Direction::v);
  if (!opened) return opened.error();
  const OcctDirection u = to_occt_direction(opened->u), v = to_occt_direction(opened->v);
  TColgp_Array2OfPnt poles(1, static_cast<int>(u.controls.size()), 1, static_cast<int>(v.controls.size()));
  for (std::size_t i = 0; i < u.controls.size(); ++i) {
    for (std::size_t j = 0; j < v.controls.size(); ++j) {
      const Vector3 point = millimetres_per_metre * opened->net.point(u.controls[i], v.controls[j]);
      poles(static_cast<int>(i) + 1, static_cast<int>(j) + 1) = gp_Pnt(point.x(), point.y(), point.z());
    }
  }
  try {
    opencascade::handle<Geom_BSplineSurface> result = new Geom_BSplineSurface(
        poles, u.knots, v.knots, u.multiplicities, v.multiplicities, surface.u.degree(), surface.v.degree());
    if (has_unclamped_end(surface.u) || has_unclamped_end(surface.v)) {
      result->Segment(surface.u.domain_start(), surface.u.domain_end(), surface.v.domain_start(),
                      surface.v.domain_end(), 0.0, 0.0);
    }
    return result;
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::degenerate, std::string("its knots are too close together for a CAD file (") +
                                            failure.DynamicType()->Name() + "); make near ones equal"};
  }
}

Result<Surface> from_occt(const Geom_BSplineSurface& surface) {
  auto u = KnotVector::open(surface.UDegree(), flat_knots(surface.UKnots(), surface.UMultiplicities()));
  if (!u) return u.error().in("along u");
  auto v = KnotVector::open(surface.VDegree(), flat_knots(surface.VKnots(), surface.VMultiplicities()));
  if (!v) return v.error().in("along v");
  ControlNet net(surface.NbUPoles(), surface.NbVPoles());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const gp_Pnt pole = surface.Pole(i + 1, j + 1);
      net.set_point(i, j, Vector3(pole.X(), pole.Y(), pole.Z()) / millimetres_per_metre);
    }
  }
  return make_surface(std::move(u).value(), std::move(v).value(), std::move(net));
}

std::vector<double> greville_parameters(const KnotVector& knots) {
  const std::vector<double>& all = knots.extended_knots();
  const auto degree = static_cast<std::size_t>(knots.degree());
  std::vector<double> parameters;
  // In a periodic direction, the first control point is the one whose basis function is the first to start
  // in the period.
  const std::size_t first = knots.is_periodic() ? degree : 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(knots.control_point_count()); ++i) {
    double sum = 0.0;
    for (std::size_t k = 1; k <= degree; ++k) sum += all[first + i + k];
    parameters.push_back(knots.into_domain(sum / knots.degree()));
  }
  return parameters;
}

Surface close_seam(const Surface& surface, Direction direction, double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m >= 0.0);
  const KnotVector& open = direction == Direction::u ? surface.u : surface.v;
  if (open.is_periodic()) return surface;
  const ControlMatrix lines = control_lines(surface, direction);
  const ControlMatrix first = lines.topRows(1), last = lines.bottomRows(1);
  if (largest_point_distance(first, last) > tolerance_m) return surface;
  const ControlMatrix one_point = first.leftCols(3).replicate(1, first.cols() / 3);
  if (largest_point_distance(first, one_point) <= tolerance_m) return surface;
  for (int multiplicity = 1; multiplicity <= open.degree(); ++multiplicity) {
    auto knots = periodic_knots(open, multiplicity);
    if (!knots) continue;
    const std::vector<double> parameters = greville_parameters(knots.value());
    const Eigen::PartialPivLU<Eigen::MatrixXd> solver(blending_matrix(knots.value(), parameters, 0).dense());
    const ControlMatrix controls = solver.solve(blending_matrix(open, parameters, 0).dense() * lines);
    if (!controls.allFinite()) continue;
    Surface closed = replace_controls(surface, direction, knots.value(), controls);
    const ControlMatrix opened = opened_lines(closed, direction);
    if (opened.rows() == lines.rows() && largest_point_distance(opened, lines) <= tolerance_m) return closed;
  }
  return surface;
}

void close_poles(Surface& surface, double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m >= 0.0);
  ControlNet& net = surface.net;
  const auto close = [&](int count, const auto& point, const auto& set) {
    Vector3 mean = Vector3::Zero();
    for (int k = 0; k < count; ++k) mean += point(k) / count;
    for (int k = 0; k < count; ++k) {
      if ((point(k) - mean).norm() > tolerance_m) return;
    }
    for (int k = 0; k < count; ++k) set(k, mean);
  };
  for (const int i : {0, net.rows - 1}) {
    if (surface.u.is_periodic()) break;
    close(
        net.columns, [&](int j) { return net.point(i, j); },
        [&](int j, const Vector3& p) { net.set_point(i, j, p); });
  }
  for (const int j : {0, net.columns - 1}) {
    if (surface.v.is_periodic()) break;
    close(
        net.rows, [&](int i) { return net.point(i, j); },
        [&](int i, const Vector3& p) { net.set_point(i, j, p); });
  }
}

ClosedSurface close_exactly(const Surface& surface) {
  ClosedSurface closed{surface, 0.0};
  const Closing closing = find_closing(surface);
  if (closing.closedness != Closedness::solid) return closed;
  if (is_clamped(surface.u) && closing.u.apart_m <= closing_tolerance_m) {
    closed.surface = close_seam(closed.surface, Direction::u, closing_tolerance_m);
  }
  if (is_clamped(surface.v) && closing.v.apart_m <= closing_tolerance_m) {
    closed.surface = close_seam(closed.surface, Direction::v, closing_tolerance_m);
  }
  close_poles(closed.surface, control_spread * closing_tolerance_m);
  for (int i = 0; i <= moved_samples; ++i) {
    for (int j = 0; j <= moved_samples; ++j) {
      const double u = surface.u.parameter_at(static_cast<double>(i) / moved_samples);
      const double v = surface.v.parameter_at(static_cast<double>(j) / moved_samples);
      const Vector3 move = position(closed.surface, u, v) - position(surface, u, v);
      closed.moved_m = std::max(closed.moved_m, move.norm());
    }
  }
  return closed;
}

}  // namespace spoonbill
