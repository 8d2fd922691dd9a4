#include "engine/bspline/grid_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/constrained_inverse.h"

namespace spoonbill {

namespace {

// Three coordinates in three columns for each of the `inner` points of a line.
using Lines = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Summed in order of the rows, so that the same points give the same bits on every machine, which Eigen's
// product does not promise.
Lines product_in_order(const Eigen::MatrixXd& matrix, const Lines& lines) {
  Lines product = Lines::Zero(matrix.rows(), lines.cols());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) product.row(i) += matrix(i, k) * lines.row(k);
  }
  return product;
}

Lines banded_product(const BlendingMatrix& matrix, const Lines& lines) {
  Lines product = Lines::Zero(matrix.rows, lines.cols());
  for (int i = 0; i < matrix.rows; ++i) {
    for (int k = 0; k < matrix.bandwidth; ++k) {
      product.row(i) +=
          matrix.values[static_cast<std::size_t>(i) * matrix.bandwidth + k] * lines.row(matrix.column(i, k));
    }
  }
  return product;
}

// Rows become columns, each point's three coordinates staying together.
Lines turned(const Lines& lines) {
  Lines result(lines.cols() / 3, lines.rows() * 3);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    for (Eigen::Index j = 0; j < lines.rows(); ++j) {
      result.block(i, 3 * j, 1, 3) = lines.block(j, 3 * i, 1, 3);
    }
  }
  return result;
}

Lines lines_of(const PointGrid& points) {
  const Eigen::Index rows = static_cast<Eigen::Index>(points.u.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(points.v.size());
  Lines lines(rows, 3 * columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      lines.block(i, 3 * j, 1, 3) = points.points_m[static_cast<std::size_t>(i * columns + j)].transpose();
    }
  }
  return lines;
}

ControlNet net_of(const Lines& lines) {
  ControlNet net(static_cast<int>(lines.rows()), static_cast<int>(lines.cols() / 3));
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, lines.block(i, 3 * j, 1, 3).transpose());
  }
  return net;
}

Lines lines_of(const ControlNet& net) {
  Lines lines(net.rows, 3 * net.columns);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) lines.block(i, 3 * j, 1, 3) = net.point(i, j).transpose();
  }
  return lines;
}

Lines sampled(const Surface& surface, const std::vector<double>& u, const std::vector<double>& v) {
  const Lines along_u = banded_product(blending_matrix(surface.u, u, 0), lines_of(surface.net));
  return turned(banded_product(blending_matrix(surface.v, v, 0), turned(along_u)));
}

}  // namespace

Result<Surface> fit_grid(const KnotVector& u, const KnotVector& v, const PointGrid& points,
                         const MetEnds& met) {
  if (points.points_m.size() != points.u.size() * points.v.size()) {
    return Error{std::to_string(points.points_m.size()) + " points for a grid of " +
                 std::to_string(points.u.size()) + " x " + std::to_string(points.v.size()) +
                 "; give one for each pair of parameters"};
  }
  const auto u_inverse = constrained_inverse(u, points.u, {{}, met.u_first, met.u_last});
  if (!u_inverse) return Error{"direction u: " + u_inverse.error().message};
  const auto v_inverse = constrained_inverse(v, points.v, {{}, met.v_first, met.v_last});
  if (!v_inverse) return Error{"direction v: " + v_inverse.error().message};
  const Lines along_u = product_in_order(u_inverse.value(), lines_of(points));
  const Lines control = turned(product_in_order(v_inverse.value(), turned(along_u)));
  return make_surface(u, v, net_of(control));
}

PointGrid point_grid(const Surface& surface, std::vector<double> u, std::vector<double> v) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const Lines samples = sampled(surface, u, v);
  PointGrid grid{std::move(u), std::move(v), {}};
  grid.points_m.reserve(grid.u.size() * grid.v.size());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    for (Eigen::Index j = 0; j < samples.cols() / 3; ++j) {
      grid.points_m.emplace_back(samples.block(i, 3 * j, 1, 3).transpose());
    }
  }
  return grid;
}

double largest_deviation_m(const Surface& surface, const PointGrid& points) {
  SPOONBILL_ASSERT(points.points_m.size() == points.u.size() * points.v.size());
  const Lines difference = sampled(surface, points.u, points.v) - lines_of(points);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < difference.rows(); ++i) {
    for (Eigen::Index j = 0; j < difference.cols() / 3; ++j) {
      largest = std::max(largest, difference.block(i, 3 * j, 1, 3).norm());
    }
  }
  return largest;
}

}  // namespace spoonbill
