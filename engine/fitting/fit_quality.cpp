#include "engine/fitting/fit_quality.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/bspline/piece_basis.h"
#include "engine/fitting/fit_surface.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scattered_fit.h"

namespace spoonbill {
namespace {

constexpr int start_samples_per_span = 3;

std::vector<double> sample_parameters(const KnotVector& knots) {
  const std::vector<double> breaks = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
    for (int k = 0; k < start_samples_per_span; ++k) {
      parameters.push_back(breaks[s] + (breaks[s + 1] - breaks[s]) * k / start_samples_per_span);
    }
  }
  if (!knots.is_periodic()) parameters.push_back(breaks.back());
  return parameters;
}

std::vector<Vector2> sample_grid(const Surface& surface) {
  std::vector<Vector2> uv;
  for (const double u : sample_parameters(surface.u)) {
    for (const double v : sample_parameters(surface.v)) uv.emplace_back(u, v);
  }
  return uv;
}

std::vector<Vector3> evaluate_positions(const Surface& surface, const std::vector<Vector2>& uv) {
  std::vector<Vector3> points(uv.size());
  for (std::size_t k = 0; k < uv.size(); ++k) points[k] = position(surface, uv[k].x(), uv[k].y());
  return points;
}

double longest_step(const KnotVector& knots) {
  return 0.75 * knots.domain_length() / static_cast<double>(span_count(knots));
}

}  // namespace

ClosestParameters::ClosestParameters(const Surface& surface)
    : surface_(&surface),
      u_(surface.u),
      v_(surface.v),
      longest_step_(longest_step(surface.u), longest_step(surface.v)),
      samples_(),
      sample_uv_(sample_grid(surface)),
      nearest_((samples_ = evaluate_positions(surface, sample_uv_), samples_)) {}

Vector3 ClosestParameters::position_at(const Vector2& uv) const {
  return position({surface_, &u_, &v_}, uv.x(), uv.y());
}

ClosestPoint ClosestParameters::project_from(const Vector3& point, const Vector2& start, int steps) const {
  const PiecewiseSurface piecewise{surface_, &u_, &v_};
  Vector2 uv(surface_->u.into_domain(start.x()), surface_->v.into_domain(start.y()));
  SurfacePoint at = evaluate(piecewise, uv.x(), uv.y());
  double distance = (at.position_m - point).norm();
  for (int step = 0; step < steps; ++step) {
    const Vector3 away = at.position_m - point;
    const double a = at.du.squaredNorm(), b = at.du.dot(at.dv), c = at.dv.squaredNorm();
    const double p = at.du.dot(away), q = at.dv.dot(away);
    // Uses the matrix of Newton's method where it is positive definite, otherwise the matrix of the
    // Gauss-Newton method.
    double m = a + at.duu.dot(away), n = b + at.duv.dot(away), o = c + at.dvv.dot(away);
    if (!(m > 0.1 * a && o > 0.1 * c && m * o - n * n > 0.1 * (a * c - b * b))) m = a, n = b, o = c;
    const double ridge = 1e-9 * (m + o) + 1e-300;
    m += ridge, o += ridge;
    const double determinant = m * o - n * n;
    if (!(determinant > 0.0)) break;
    Vector2 move(-(o * p - n * q) / determinant, -(m * q - n * p) / determinant);
    const double fraction =
        std::max(std::abs(move.x()) / longest_step_.x(), std::abs(move.y()) / longest_step_.y());
    if (!std::isfinite(fraction)) break;
    if (fraction > 1.0) move /= fraction;
    bool nearer = false;
    for (int halving = 0; halving < 4 && !nearer; ++halving, move *= 0.5) {
      const Vector2 next(surface_->u.into_domain(uv.x() + move.x()),
                         surface_->v.into_domain(uv.y() + move.y()));
      const double reached = (position_at(next) - point).norm();
      if (reached >= distance) continue;
      nearer = distance - reached > 1e-6 * distance;
      distance = reached;
      uv = next;
      break;
    }
    if (!nearer) break;
    if (step + 1 < steps) at = evaluate(piecewise, uv.x(), uv.y());
  }
  return {uv, distance, position_at(uv)};
}

ClosestPoint ClosestParameters::project(const Vector3& point, int steps) const {
  return project_from(point, sample_uv_[nearest_.nearest(point).index], steps);
}

namespace {

constexpr int samples_per_span = 4, cusp_samples_per_span = 12;
constexpr double cusp_cosine = -0.5;

// Unit normals at the centres of equal cells, into which the knot spans are divided. The centres are never at
// a pole or a seam.
struct NormalGrid {
  std::size_t rows = 0, columns = 0;
  std::vector<Vector2> uv;
  std::vector<Vector3> normals;
};

std::vector<double> cell_centres(const KnotVector& knots, int samples) {
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
  const std::vector<double> u = cell_centres(surface.u, samples), v = cell_centres(surface.v, samples);
  const PieceBasis u_basis(surface.u), v_basis(surface.v);
  NormalGrid grid{u.size(), v.size(), {}, {}};
  for (const double at_u : u) {
    for (const double at_v : v) {
      const SurfacePoint at = evaluate({&surface, &u_basis, &v_basis}, at_u, at_v);
      grid.uv.emplace_back(at_u, at_v);
      grid.normals.push_back(at.du.cross(at.dv).normalized());
    }
  }
  return grid;
}

bool turns_at(const NormalGrid& grid, bool u_closes, double cosine, std::size_t i, std::size_t j) {
  const Vector3& normal = grid.normals[i * grid.columns + j];
  const bool in_u = (i + 1 < grid.rows || u_closes) &&
                    normal.dot(grid.normals[(i + 1) % grid.rows * grid.columns + j]) < cosine;
  return in_u || (j + 1 < grid.columns && normal.dot(grid.normals[i * grid.columns + j + 1]) < cosine);
}

// Search structure for the normals of the data by position in (u, v), in units of a mean knot span. Normals
// near a periodic seam are stored on both sides of it.
class DataNormals {
 public:
  DataNormals(const Surface& surface, const NormalsAtParameters& data)
      : scale_(static_cast<double>(span_count(surface.u)), static_cast<double>(span_count(surface.v))) {
    constexpr double seam = 0.1;
    const auto put = [&](double u, double v, const Vector3& normal) {
      positions_.emplace_back(u * scale_.x(), v * scale_.y(), 0.0);
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
    if (is_known()) nearest_.emplace(positions_);
  }

  bool is_known() const { return !positions_.empty(); }
  bool points_against(const Vector2& uv, const Vector3& normal) const {
    constexpr std::size_t count = 6;
    nearest_->nearest({uv.x() * scale_.x(), uv.y() * scale_.y(), 0.0}, count, found_);
    bool is_against = found_.front().distance < 1.0;
    for (const NearestPoints::Neighbour& found : found_) {
      is_against = is_against && normals_[found.index].dot(normal) < 0.0;
    }
    return is_against;
  }

 private:
  Vector2 scale_;
  std::vector<Vector3> positions_, normals_;
  std::optional<NearestPoints> nearest_;
  mutable std::vector<NearestPoints::Neighbour> found_;
};

void count_cusps(const Surface& surface, FoldCheck& check) {
  const NormalGrid grid = sample(surface, cusp_samples_per_span);
  const std::size_t v_spans = grid.columns / cusp_samples_per_span;
  check.span_cusps.assign(check.span_folds.size(), false);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      if (!turns_at(grid, surface.u.is_periodic(), cusp_cosine, i, j)) continue;
      ++check.cusps;
      check.span_cusps[i / cusp_samples_per_span * v_spans + j / cusp_samples_per_span] = true;
    }
  }
}

}  // namespace

FoldCheck check_folds(const Surface& surface, const NormalsAtParameters& data) {
  SPOONBILL_ASSERT(data.normals.empty() || data.normals.size() >= data.uv.size());
  const NormalGrid grid = sample(surface, samples_per_span);
  const DataNormals data_normals(surface, data);
  const std::size_t v_spans = grid.columns / samples_per_span;
  FoldCheck check;
  check.samples = grid.uv.size();
  check.span_folds.assign(grid.uv.size() / (samples_per_span * samples_per_span), false);
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const std::size_t k = i * grid.columns + j;
      const bool is_against =
          data_normals.is_known() && data_normals.points_against(grid.uv[k], grid.normals[k]);
      const bool may_turn = data_normals.is_known() && !data.are_estimated;
      if (!is_against && (may_turn || !turns_at(grid, surface.u.is_periodic(), 0.0, i, j))) continue;
      ++check.folds;
      check.span_folds[i / samples_per_span * v_spans + j / samples_per_span] = true;
    }
  }
  count_cusps(surface, check);
  return check;
}

namespace {

constexpr int distance_steps = 4;
constexpr int error_samples_per_span = 4;
constexpr std::size_t plane_points = 10;
// A surface sample counts as scanned if its distance from the nearest data point, measured along the surface,
// is at most this number of mean spacings. If that data point is at a boundary, its distance in space must
// also be at most one mean spacing.
constexpr double seen_spacings = 3.0;

// Returns true if errors are measured at the fitted points instead of the given ones. This is so for a
// refined mesh, because its given vertices may be just the few corners of large triangles.
bool measures_fitted_points(const FitPoints& points) {
  return points.is_mesh && points.scan.points_m.size() > points.given_m.size();
}

void measure_data(const FittedSurface& fit, const FitPoints& points, FitErrors& errors) {
  const bool are_fitted = measures_fitted_points(points);
  errors.positions_m = are_fitted ? points.scan.points_m : points.given_m;
  const ClosestParameters closest(fit.surface);
  std::vector<double> trusted;
  for (std::size_t g = 0; g < errors.positions_m.size(); ++g) {
    const std::size_t fitted = are_fitted ? g : points.representative[g];
    const Vector3& point = errors.positions_m[g];
    ClosestPoint found = closest.project_from(point, fit.uv[fitted], distance_steps);
    // The point may be caught in a local minimum, so the search also starts from the nearest sample.
    if (found.distance_m > 1.5 * fit.distance_m[fitted] || fit.trust[fitted] < 1.0) {
      const ClosestPoint other = closest.project(point, distance_steps);
      if (other.distance_m < found.distance_m) found = other;
    }
    errors.uv.push_back(found.uv);
    errors.distance_m.push_back(found.distance_m);
    errors.is_stray.push_back(fit.trust[fitted] == 0.0);
    if (!errors.is_stray.back()) trusted.push_back(found.distance_m);
  }
  const auto is_stray = [&](std::uint32_t fitted) { return fit.trust[fitted] == 0.0; };
  errors.strays = static_cast<std::size_t>(
      std::count_if(points.representative.begin(), points.representative.end(), is_stray));
  errors.data_to_surface = compute_deviation(std::move(trusted));
  errors.all_to_surface = compute_deviation(errors.distance_m);
}

std::vector<Vector3> surface_samples(const Surface& surface) {
  const auto parameters = [](const KnotVector& knots) {
    const std::vector<double> breaks = knots.breakpoints();
    std::vector<double> centres;
    for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
      for (int k = 0; k < error_samples_per_span; ++k) {
        centres.push_back(breaks[s] + (breaks[s + 1] - breaks[s]) * (k + 0.5) / error_samples_per_span);
      }
    }
    return centres;
  };
  std::vector<Vector3> samples;
  for (const double u : parameters(surface.u)) {
    for (const double v : parameters(surface.v)) samples.push_back(position(surface, u, v));
  }
  return samples;
}

// Returns the distance of the sample from a plane fitted through the found points.
double plane_distance(const Vector3& sample, const std::vector<Vector3>& points,
                      const std::vector<NearestPoints::Neighbour>& found) {
  Vector3 mean = Vector3::Zero();
  for (const NearestPoints::Neighbour& near : found) {
    mean += points[near.index] / static_cast<double>(found.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const NearestPoints::Neighbour& near : found) {
    spread += (points[near.index] - mean) * (points[near.index] - mean).transpose();
  }
  const Vector3 normal = decompose_symmetric(spread).vectors.col(0);
  return std::abs(normal.dot(sample - mean));
}

// Returns the mean distance to the sixth neighbour, measured at up to about 2000 points.
double mean_spacing(const std::vector<Vector3>& points, const NearestPoints& nearest) {
  constexpr std::size_t neighbours = 6, most = 2000;
  std::vector<NearestPoints::Neighbour> found;
  double sum = 0.0, count = 0.0;
  for (std::size_t p = 0; p < points.size(); p += 1 + points.size() / most, count += 1.0) {
    nearest.nearest(points[p], neighbours + 1, found);
    sum += found.back().distance;
  }
  return sum / count;
}

void measure_surface(const FittedSurface& fit, const FitPoints& points, FitErrors& errors) {
  const std::vector<Vector3>& data = points.scan.points_m;
  const NearestPoints nearest(data);
  const double spacing = mean_spacing(data, nearest);
  const std::vector<Vector3> samples = surface_samples(fit.surface);
  std::vector<bool> is_at_boundary(points.graph.size(), false);
  for (const BoundaryLoop& loop : points.boundary_loops) {
    for (const std::uint32_t node : loop.nodes) {
      is_at_boundary[node] = true;
      for (const std::uint32_t near : points.graph.adjacent(node)) is_at_boundary[near] = true;
    }
  }
  std::vector<NearestPoints::Neighbour> found;
  std::vector<double> distances;
  for (const Vector3& sample : samples) {
    nearest.nearest(sample, plane_points, found);
    const double away = found.front().distance, plane = plane_distance(sample, data, found);
    const double aside = std::sqrt(std::max(0.0, away * away - plane * plane));
    const bool is_beyond_boundary = is_at_boundary[points.node_index[found.front().index]] && away > spacing;
    if (is_beyond_boundary || aside > seen_spacings * spacing) continue;
    distances.push_back(std::min(away, plane));
  }
  errors.unseen_fraction = 1.0 - static_cast<double>(distances.size()) / static_cast<double>(samples.size());
  errors.surface_to_data = compute_deviation(std::move(distances));
}

}  // namespace

Deviation compute_deviation(std::vector<double> distances_m) {
  if (distances_m.empty()) return {};
  std::sort(distances_m.begin(), distances_m.end());
  const double sum = std::accumulate(distances_m.begin(), distances_m.end(), 0.0);
  const std::size_t last = distances_m.size() - 1;
  const auto index = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(last)));
  return {distances_m[last], distances_m[index], sum / static_cast<double>(distances_m.size())};
}

FitErrors measure_errors(const FittedSurface& fit, const FitPoints& points) {
  SPOONBILL_ASSERT(fit.uv.size() == points.scan.points_m.size());
  SPOONBILL_ASSERT(fit.trust.size() == fit.uv.size());
  FitErrors errors;
  measure_data(fit, points, errors);
  measure_surface(fit, points, errors);
  return errors;
}

}  // namespace spoonbill
