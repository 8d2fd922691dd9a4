#include "engine/fitting/folds.h"

#include <optional>

#include "engine/base/assert.h"
#include "engine/bspline/piece_basis.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/scattered_fit.h"

namespace spoonbill {
namespace {

constexpr int samples_a_span = 4, cusp_samples_a_span = 12;
constexpr double cusp_cosine = -0.5;

// Normals at the middles of a sample's cell, so that no pole or seam is hit.
struct NormalGrid {
  std::size_t rows = 0, columns = 0;
  std::vector<Vector2> places;
  std::vector<Vector3> normals;
};

std::vector<double> middles(const KnotVector& knots, int samples) {
  const std::vector<double> breaks = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
    for (int k = 0; k < samples; ++k) {
      parameters.push_back(breaks[s] + (breaks[s + 1] - breaks[s]) * (k + 0.5) / samples);
    }
  }
  return parameters;
}

NormalGrid sample(const Surface& surface, int samples) {
  const std::vector<double> u = middles(surface.u, samples), v = middles(surface.v, samples);
  const PieceBasis u_basis(surface.u), v_basis(surface.v);
  NormalGrid grid{u.size(), v.size(), {}, {}};
  for (const double at_u : u) {
    for (const double at_v : v) {
      const SurfacePoint at = evaluate({&surface, &u_basis, &v_basis}, at_u, at_v);
      grid.places.emplace_back(at_u, at_v);
      grid.normals.push_back(at.du.cross(at.dv).normalized());
    }
  }
  return grid;
}

bool turns_from_next(const NormalGrid& grid, bool u_closes, double cosine, std::size_t i, std::size_t j) {
  const Vector3& normal = grid.normals[i * grid.columns + j];
  const bool in_u = (i + 1 < grid.rows || u_closes) &&
                    normal.dot(grid.normals[(i + 1) % grid.rows * grid.columns + j]) < cosine;
  return in_u || (j + 1 < grid.columns && normal.dot(grid.normals[i * grid.columns + j + 1]) < cosine);
}

// The data's normals by their place in (u, v), in spans; near a seam on both of its sides.
class DataNormals {
 public:
  DataNormals(const Surface& surface, const NormalsAtParameters& data)
      : scale_(static_cast<double>(span_count(surface.u)), static_cast<double>(span_count(surface.v))) {
    constexpr double seam = 0.1;
    const auto put = [&](double u, double v, const Vector3& normal) {
      places_.emplace_back(u * scale_.x(), v * scale_.y(), 0.0);
      normals_.push_back(normal);
    };
    for (std::size_t p = 0; p < data.normals.size(); ++p) {
      const Vector2& uv = data.uv[p];
      if (uv.hasNaN() || data.normals[p].isZero()) continue;
      put(uv.x(), uv.y(), data.normals[p]);
      if (!surface.u.is_periodic()) continue;
      if (uv.x() < seam) put(uv.x() + 1.0, uv.y(), data.normals[p]);
      if (uv.x() > 1.0 - seam) put(uv.x() - 1.0, uv.y(), data.normals[p]);
    }
    if (any()) nearest_.emplace(places_);
  }

  bool any() const { return !places_.empty(); }
  bool points_against(const Vector2& uv, const Vector3& normal) const {
    constexpr std::size_t count = 6;
    nearest_->nearest({uv.x() * scale_.x(), uv.y() * scale_.y(), 0.0}, count, found_);
    bool against = found_.front().distance < 1.0;
    for (const NearestPoints::Found& found : found_) {
      against = against && normals_[found.index].dot(normal) < 0.0;
    }
    return against;
  }

 private:
  Vector2 scale_;
  std::vector<Vector3> places_, normals_;
  std::optional<NearestPoints> nearest_;
  mutable std::vector<NearestPoints::Found> found_;
};

void count_cusps(const Surface& surface, FoldCheck& check) {
  const NormalGrid grid = sample(surface, cusp_samples_a_span);
  const std::size_t v_spans = grid.columns / cusp_samples_a_span;
  check.span_cusps.assign(check.span_folds.size(), false);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      if (!turns_from_next(grid, surface.u.is_periodic(), cusp_cosine, i, j)) continue;
      ++check.cusps;
      check.span_cusps[i / cusp_samples_a_span * v_spans + j / cusp_samples_a_span] = true;
    }
  }
}

}  // namespace

FoldCheck check_folds(const Surface& surface, const NormalsAtParameters& data) {
  SPOONBILL_ASSERT(data.normals.empty() || data.normals.size() >= data.uv.size());
  const NormalGrid grid = sample(surface, samples_a_span);
  const DataNormals data_normals(surface, data);
  const std::size_t v_spans = grid.columns / samples_a_span;
  FoldCheck check;
  check.samples = grid.places.size();
  check.span_folds.assign(grid.places.size() / (samples_a_span * samples_a_span), false);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const std::size_t k = i * grid.columns + j;
      const bool against = data_normals.any() && data_normals.points_against(grid.places[k], grid.normals[k]);
      const bool may_turn = data_normals.any() && !data.are_estimated;
      if (!against && (may_turn || !turns_from_next(grid, surface.u.is_periodic(), 0.0, i, j))) continue;
      ++check.folds;
      check.span_folds[i / samples_a_span * v_spans + j / samples_a_span] = true;
    }
  }
  count_cusps(surface, check);
  return check;
}

}  // namespace spoonbill
