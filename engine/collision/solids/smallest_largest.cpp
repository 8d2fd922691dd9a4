#include "engine/collision/solids/smallest_largest.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Planes = std::array<FacePlane, most_faces>;

double model(const Planes& planes, int count, const Matrix2d& quadratic, const Vector2d& step) {
  double largest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) largest = std::max(largest, planes[i].value + planes[i].slope.dot(step));
  return largest + 0.5 * step.dot(quadratic * step);
}

// Every candidate is a step that can be taken, so the one with the least model is the answer.
struct Search {
  const Planes& planes;
  int count;
  const Matrix2d& quadratic;
  Matrix2d inverse;
  SmallestLargest best;

  void offer(const Vector2d& step, std::initializer_list<std::pair<int, double>> weights) {
    if (!step.allFinite()) return;
    const double value = model(planes, count, quadratic, step);
    if (!(value < best.value)) return;
    best.step = step;
    best.value = value;
    best.weights.fill(0.0);
    for (const auto& [index, weight] : weights) best.weights[index] = weight;
  }

  void offer_one(int i) { offer(-(inverse * planes[i].slope), {{i, 1.0}}); }

  void offer_two(int i, int j) {
    const Vector2d apart = planes[i].slope - planes[j].slope;
    const double bend = apart.dot(inverse * apart);
    if (!(bend > 0.0)) return;
    const double share = (planes[i].value - planes[j].value - apart.dot(inverse * planes[j].slope)) / bend;
    if (!(share >= 0.0 && share <= 1.0)) return;
    offer(-(inverse * (planes[j].slope + share * apart)), {{i, share}, {j, 1.0 - share}});
  }

  void offer_three(int i, int j, int k) {
    Matrix2d apart;
    apart.row(0) = (planes[i].slope - planes[k].slope).transpose();
    apart.row(1) = (planes[j].slope - planes[k].slope).transpose();
    const double determinant = apart.determinant();
    if (!(std::abs(determinant) > 1e-12 * apart.squaredNorm())) return;
    const Matrix2d solve = apart.inverse();
    const Vector2d step =
        solve * Vector2d(planes[k].value - planes[i].value, planes[k].value - planes[j].value);
    const Vector2d shares = -(solve.transpose() * (planes[k].slope + quadratic * step));
    const double last = 1.0 - shares.sum();
    if (!(shares.minCoeff() >= 0.0 && last >= 0.0)) return;
    offer(step, {{i, shares[0]}, {j, shares[1]}, {k, last}});
  }
};

}  // namespace

SmallestLargest smallest_largest(const Planes& planes, int count, const Matrix2d& quadratic) {
  SPOONBILL_ASSERT_DEBUG(count >= 1 && count <= most_faces);
  Search search{planes, count, quadratic, quadratic.inverse(), {}};
  search.best.value = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    search.offer_one(i);
    for (int j = i + 1; j < count; ++j) {
      search.offer_two(i, j);
      for (int k = j + 1; k < count; ++k) search.offer_three(i, j, k);
    }
  }
  return search.best;
}

}  // namespace spoonbill
