#include "engine/merging/fold_search.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

namespace {

// du x dv at parameters u x v, not of unit length.
class NormalGrid {
 public:
  NormalGrid(const Surface& surface, std::vector<double> u, std::vector<double> v)
      : u_(std::move(u)), v_(std::move(v)) {
    const int columns = surface.net.columns;
    const std::vector<Vector3> lines = along_u(surface.net, blending_matrix(surface.u, u_, 0));
    const std::vector<Vector3> slopes = along_u(surface.net, blending_matrix(surface.u, u_, 1));
    const BlendingMatrix values = blending_matrix(surface.v, v_, 0);
    const BlendingMatrix derivatives = blending_matrix(surface.v, v_, 1);
    normals_.reserve(u_.size() * v_.size());
    for (std::size_t i = 0; i < u_.size(); ++i) {
      for (std::size_t j = 0; j < v_.size(); ++j) {
        Vector3 du = Vector3::Zero(), dv = Vector3::Zero();
        for (int k = 0; k < values.bandwidth; ++k) {
          const std::size_t at = j * static_cast<std::size_t>(values.bandwidth) + k;
          const std::size_t point = i * columns + values.column(static_cast<int>(j), k);
          du += values.values[at] * slopes[point];
          dv += derivatives.values[at] * lines[point];
        }
        normals_.push_back(du.cross(dv));
      }
    }
  }

  const std::vector<double>& u() const { return u_; }
  const std::vector<double>& v() const { return v_; }
  const Vector3& at(std::size_t i, std::size_t j) const { return normals_[i * v_.size() + j]; }
  bool turns(std::size_t i, std::size_t j, std::size_t other_i, std::size_t other_j) const {
    return at(i, j).dot(at(other_i, other_j)) < 0.0;
  }

 private:
  static std::vector<Vector3> along_u(const ControlNet& net, const BlendingMatrix& blending) {
    std::vector<Vector3> result;
    result.reserve(static_cast<std::size_t>(blending.rows) * net.columns);
    for (int i = 0; i < blending.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        Vector3 sum = Vector3::Zero();
        for (int k = 0; k < blending.bandwidth; ++k) {
          sum += blending.values[static_cast<std::size_t>(i) * blending.bandwidth + k] *
                 net.point(blending.column(i, k), j);
        }
        result.push_back(sum);
      }
    }
    return result;
  }

  std::vector<double> u_, v_;
  std::vector<Vector3> normals_;
};

constexpr int cells_in_piece = 4;

struct Cells {
  std::vector<double> middles;
  std::vector<bool> goes_on;  // from each to the next, from the last to the first: not across an edge
};

Cells cells_along(const KnotVector& knots) {
  Cells cells;
  const std::vector<double> ends = knots.breakpoints();
  const std::vector<KnotMultiplicity> starts = knot_multiplicities(knots);
  for (std::size_t piece = 0; piece < starts.size(); ++piece) {
    for (int k = 0; k < cells_in_piece; ++k) {
      cells.middles.push_back(ends[piece] + (ends[piece + 1] - ends[piece]) * (k + 0.5) / cells_in_piece);
      cells.goes_on.push_back(true);
    }
    // Open ends count as clamped, so that nothing goes on across them.
    cells.goes_on.back() = starts[(piece + 1) % starts.size()].multiplicity < knots.degree();
  }
  return cells;
}

// At least so many steps, for strips of few pieces.
constexpr int least_lines = 32, least_steps = 24;

std::vector<double> lines_across(const KnotVector& u) {
  const int pieces = static_cast<int>(u.breakpoints().size()) - 1;
  return uniform_parameters(u, std::max(least_lines, cells_in_piece * pieces) + 1);
}

std::vector<double> steps_along(const KnotVector& v, double start, double end) {
  const std::vector<double> knots = v.breakpoints();
  const auto inside =
      std::count_if(knots.begin(), knots.end(), [&](double knot) { return knot > start && knot < end; });
  const int steps = std::max(least_steps, cells_in_piece * (static_cast<int>(inside) + 1));
  std::vector<double> along;
  for (int k = 0; k <= steps; ++k) along.push_back(start + (end - start) * k / steps);
  return along;
}

bool folds_in_strip(const NormalGrid& normals, std::size_t i, std::size_t j) {
  const std::size_t last = normals.v().size() - 1;
  if (j > 0 && normals.turns(i, j - 1, i, j)) return true;
  if (!normals.turns(i, 0, i, last) && normals.turns(i, 0, i, j) && normals.turns(i, last, i, j)) return true;
  return i > 0 && normals.turns(i - 1, j, i, j) && !normals.turns(i - 1, 0, i, 0) &&
         !normals.turns(i - 1, last, i, last);
}

}  // namespace

std::optional<Vector3> place_of_fold(const Surface& surface) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const Cells along_u = cells_along(surface.u), along_v = cells_along(surface.v);
  const NormalGrid normals(surface, along_u.middles, along_v.middles);
  const std::size_t rows = along_u.middles.size(), columns = along_v.middles.size();
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      if ((along_u.goes_on[i] && normals.turns(i, j, (i + 1) % rows, j)) ||
          (along_v.goes_on[j] && normals.turns(i, j, i, (j + 1) % columns))) {
        return position(surface, normals.u()[i], normals.v()[j]);
      }
    }
  }
  return std::nullopt;
}

std::optional<Vector3> place_of_fold_between(const Surface& surface, double start, double end) {
  SPOONBILL_ASSERT(start <= end);
  const NormalGrid normals(surface, lines_across(surface.u), steps_along(surface.v, start, end));
  for (std::size_t i = 0; i < normals.u().size(); ++i) {
    for (std::size_t j = 0; j < normals.v().size(); ++j) {
      if (folds_in_strip(normals, i, j)) return position(surface, normals.u()[i], normals.v()[j]);
    }
  }
  return std::nullopt;
}

}  // namespace spoonbill
