#include "engine/fitting/outliers.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/fitting/nearest_points.h"

namespace spoonbill {
namespace {

constexpr std::size_t neighbours_of_a_point = 8, neighbours_of_a_plane = 16;
// Against noise of a scanner, which keeps within three deviations of its neighbours' distances.
constexpr double outlier_deviations = 6.0;
// Of the usual spacing of points given: no surface is seen so much less densely a voxel further on.
constexpr double sparse_spacings = 8.0;
// Of the spread of neighbours along a plane: those of a surface lie no further off it, those of what fills
// space about twice as far.
constexpr double flat_share = 0.3;

// Values below which a share of the points given lies.
class UsualValues {
 public:
  UsualValues(const std::vector<double>& values, const std::vector<double>& counts)
      : values_(values), counts_(counts), order_(values.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    total_ = std::accumulate(counts.begin(), counts.end(), 0.0);
  }
  double at(double share) const {
    double below = 0.0;
    for (const std::size_t place : order_) {
      below += counts_[place];
      if (below > share * (total_ - 1.0)) return values_[place];
    }
    return values_[order_.back()];
  }

 private:
  const std::vector<double>&values_, &counts_;
  std::vector<std::size_t> order_;
  double total_ = 0.0;
};

std::vector<double> reaches(const std::vector<Vector3>& points_m, const NearestPoints& nearest) {
  std::vector<NearestPoints::Found> found;
  std::vector<double> reach(points_m.size());
  for (std::size_t p = 0; p < reach.size(); ++p) {
    nearest.nearest(points_m[p], neighbours_of_a_point + 1, found);
    double sum = 0.0;
    for (const NearestPoints::Found& other : found) sum += other.distance;
    reach[p] = sum / static_cast<double>(neighbours_of_a_point);
  }
  return reach;
}

std::vector<bool> are_sparse(const std::vector<double>& reach, const std::vector<double>& counts) {
  std::vector<double> spacing(reach.size());
  for (std::size_t p = 0; p < spacing.size(); ++p) spacing[p] = reach[p] / std::sqrt(counts[p]);
  const UsualValues usual_reach(reach, counts);
  const double median = usual_reach.at(0.5);
  const double longest = median + outlier_deviations * std::max(usual_reach.at(0.84) - median, 0.1 * median);
  const double widest = sparse_spacings * UsualValues(spacing, counts).at(0.5);
  std::vector<bool> sparse(reach.size());
  for (std::size_t p = 0; p < sparse.size(); ++p) sparse[p] = reach[p] > longest || spacing[p] > widest;
  return sparse;
}

// Its neighbours spread along a plane, and it lies on that.
bool lies_flat(const Vector3& point, const std::vector<Vector3>& points_m,
               const std::vector<NearestPoints::Found>& found) {
  Vector3 mean = Vector3::Zero();
  for (const NearestPoints::Found& near : found) mean += points_m[near.index];
  mean /= static_cast<double>(found.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const NearestPoints::Found& near : found) {
    const Vector3 way = points_m[near.index] - mean;
    scatter += way * way.transpose() / static_cast<double>(found.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const double along = flat_share * std::sqrt(axes.eigenvalues()[1]);
  return std::sqrt(std::max(0.0, axes.eigenvalues()[0])) < along &&
         std::abs(axes.eigenvectors().col(0).dot(point - mean)) < 2.0 * along;
}

// Some of what fills space lies flat by chance, but most around it does not.
void keep_surfaces(const std::vector<Vector3>& points_m, const NearestPoints& nearest,
                   std::vector<bool>& apart) {
  std::vector<NearestPoints::Found> found;
  std::vector<bool> flat(apart.size(), true);
  const auto look_around = [&](std::size_t p) {
    nearest.nearest(points_m[p], neighbours_of_a_plane + 1, found);
    std::erase_if(found, [&](const NearestPoints::Found& near) { return near.index == p; });
  };
  for (std::size_t p = 0; p < apart.size(); ++p) {
    if (!apart[p]) continue;
    look_around(p);
    flat[p] = lies_flat(points_m[p], points_m, found);
  }
  for (std::size_t p = 0; p < apart.size(); ++p) {
    if (!apart[p] || !flat[p]) continue;
    look_around(p);
    const auto around =
        std::count_if(found.begin(), found.end(), [&](const auto& near) { return flat[near.index]; });
    apart[p] = 3 * static_cast<std::size_t>(around) < 2 * found.size();
  }
}

}  // namespace

std::vector<bool> lie_apart(const std::vector<Vector3>& points_m, const std::vector<double>& counts) {
  SPOONBILL_ASSERT(counts.size() == points_m.size());
  const NearestPoints nearest(points_m);
  std::vector<bool> apart = are_sparse(reaches(points_m, nearest), counts);
  const bool is_thinned = std::any_of(counts.begin(), counts.end(), [](double count) { return count > 1.0; });
  if (is_thinned) keep_surfaces(points_m, nearest, apart);
  return apart;
}

}  // namespace spoonbill
