// The points of a set that lie nearest to a place.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Keeps no points of its own: those given must outlive it and stay as they are. Any thread may ask.
class NearestPoints {
 public:
  // At least one point, all finite.
  explicit NearestPoints(std::span<const Vector3> points);
  ~NearestPoints();
  NearestPoints(NearestPoints&&) noexcept;
  NearestPoints& operator=(NearestPoints&&) noexcept;

  struct Found {
    std::uint32_t index = 0;
    double distance = 0.0;
  };
  Found nearest(const Vector3& place) const;
  // At most `count`, the nearest first.
  void nearest(const Vector3& place, std::size_t count, std::vector<Found>& found) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace spoonbill
