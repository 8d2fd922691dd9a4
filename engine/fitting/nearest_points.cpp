#include "engine/fitting/nearest_points.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "engine/base/assert.h"

namespace spoonbill {

struct NearestPoints::Tree {
  struct Points {
    std::span<const Vector3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t index, std::size_t axis) const {
      return points[index][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3,
                                                    std::uint32_t>;

  explicit Tree(std::span<const Vector3> given)
      : points{given}, index(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}

  Points points;
  Index index;
};

NearestPoints::NearestPoints(std::span<const Vector3> points) : tree_(std::make_unique<Tree>(points)) {
  SPOONBILL_ASSERT(!points.empty());
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(points.begin(), points.end(), [](const Vector3& at) { return at.allFinite(); }));
}
NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

NearestPoints::Found NearestPoints::nearest(const Vector3& place) const {
  Found found;
  tree_->index.knnSearch(place.data(), 1, &found.index, &found.distance);
  found.distance = std::sqrt(found.distance);
  return found;
}

void NearestPoints::nearest(const Vector3& place, std::size_t count, std::vector<Found>& found) const {
  thread_local std::vector<std::uint32_t> indices;
  thread_local std::vector<double> squares;
  indices.resize(count);
  squares.resize(count);
  const std::size_t held = tree_->index.knnSearch(place.data(), count, indices.data(), squares.data());
  found.resize(held);
  for (std::size_t k = 0; k < held; ++k) found[k] = {indices[k], std::sqrt(squares[k])};
}

}  // namespace spoonbill
