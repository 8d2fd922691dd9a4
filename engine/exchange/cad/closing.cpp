#include "engine/exchange/cad/closing.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The control points that share an index along the direction are a row.
Points lines_of(const Surface& surface, Direction direction) {
  const ControlNet& net = surface.net;
  const bool along_u = direction == Direction::u;
  Points lines(along_u ? net.rows : net.columns, 3 * (along_u ? net.columns : net.rows));
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

Surface surface_of(const Surface& like, Direction direction, const KnotVector& knots, const Points& lines) {
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

double largest_point_distance(const Points& a, const Points& b) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j + 2 < a.cols(); j += 3) {
      largest = std::max(largest, (a.block(i, j, 1, 3) - b.block(i, j, 1, 3)).norm());
    }
  }
  return largest;
}

// One period whose seam has that multiplicity, of the clamped knots of an open direction.
Result<KnotVector> periodic_knots(const KnotVector& open, int seam_multiplicity) {
  std::vector<double> knots(static_cast<std::size_t>(seam_multiplicity), open.domain_start());
  for (const double knot : open.knots()) {
    if (knot > open.domain_start() && knot < open.domain_end()) knots.push_back(knot);
  }
  knots.push_back(open.domain_end());
  return KnotVector::periodic(open.degree(), std::move(knots));
}

// The open form's control points of what a periodic surface is, to compare.
Points opened_lines(const Surface& periodic, Direction direction) {
  const KnotVector& before = direction == Direction::u ? periodic.u : periodic.v;
  const auto full = insert_knot(periodic, direction, before.domain_start(), before.degree());
  if (!full) return {};
  const KnotVector& knots = direction == Direction::u ? full->u : full->v;
  const Points lines = lines_of(full.value(), direction);
  const int count = knots.control_point_count();
  const int first = knots.control_index(knots.find_span(knots.domain_start()), 0);
  Points opened(lines.rows() + 1, lines.cols());
  for (int i = 0; i <= count; ++i) opened.row(i) = lines.row((first + i) % count);
  return opened;
}

bool is_clamped(const KnotVector& knots) {
  return !knots.is_periodic() && knots.knots().front() == knots.domain_start() &&
         knots.knots().back() == knots.domain_end();
}

// Control points of an edge may be as much farther apart than the edge is wide.
constexpr double points_beyond_curve = 10.0;
constexpr int moved_samples = 64;

double at_share(const KnotVector& knots, double share) {
  return knots.domain_start() + share * (knots.domain_end() - knots.domain_start());
}

}  // namespace

std::vector<double> greville_parameters(const KnotVector& knots) {
  const std::vector<double>& all = knots.extended_knots();
  const auto degree = static_cast<std::size_t>(knots.degree());
  std::vector<double> parameters;
  // Of a periodic direction, those of the control points whose basis functions start in the period.
  const std::size_t first = knots.is_periodic() ? degree : 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(knots.control_point_count()); ++i) {
    double sum = 0.0;
    for (std::size_t k = 1; k <= degree; ++k) sum += all[first + i + k];
    parameters.push_back(knots.into_domain(sum / knots.degree()));
  }
  return parameters;
}

Surface closed_where_it_meets(const Surface& surface, Direction direction, double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m >= 0.0);
  const KnotVector& open = direction == Direction::u ? surface.u : surface.v;
  if (open.is_periodic()) return surface;
  const Points lines = lines_of(surface, direction);
  const Points first = lines.topRows(1), last = lines.bottomRows(1);
  if (largest_point_distance(first, last) > tolerance_m) return surface;
  const Points one_point = first.leftCols(3).replicate(1, first.cols() / 3);
  if (largest_point_distance(first, one_point) <= tolerance_m) return surface;
  for (int multiplicity = 1; multiplicity <= open.degree(); ++multiplicity) {
    auto knots = periodic_knots(open, multiplicity);
    if (!knots) continue;
    const std::vector<double> parameters = greville_parameters(knots.value());
    const Eigen::PartialPivLU<Eigen::MatrixXd> solver(blending_matrix(knots.value(), parameters, 0).dense());
    const Points controls = solver.solve(blending_matrix(open, parameters, 0).dense() * lines);
    if (!controls.allFinite()) continue;
    Surface closed = surface_of(surface, direction, knots.value(), controls);
    const Points opened = opened_lines(closed, direction);
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

ClosedExactly closed_exactly(const Surface& surface) {
  ClosedExactly closed{surface, 0.0};
  const Closing closing = find_closing(surface);
  if (closing.closedness != Closedness::solid) return closed;
  if (is_clamped(surface.u) && closing.u.apart_m <= closing_tolerance_m) {
    closed.surface = closed_where_it_meets(closed.surface, Direction::u, closing_tolerance_m);
  }
  if (is_clamped(surface.v) && closing.v.apart_m <= closing_tolerance_m) {
    closed.surface = closed_where_it_meets(closed.surface, Direction::v, closing_tolerance_m);
  }
  close_poles(closed.surface, points_beyond_curve * closing_tolerance_m);
  for (int i = 0; i <= moved_samples; ++i) {
    for (int j = 0; j <= moved_samples; ++j) {
      const double u = at_share(surface.u, static_cast<double>(i) / moved_samples);
      const double v = at_share(surface.v, static_cast<double>(j) / moved_samples);
      const Vector3 move = position(closed.surface, u, v) - position(surface, u, v);
      closed.moved_m = std::max(closed.moved_m, move.norm());
    }
  }
  return closed;
}

}  // namespace spoonbill
