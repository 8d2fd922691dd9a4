#include "engine/trial/bowl.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/bspline/surface.h"
#include "engine/trial/height_map.h"
#include "engine/trial/rim.h"

namespace spoonbill {
namespace {

constexpr int cells_along_body = 640;
// The least depth of a bowl, as a fraction of the longest side of the body: 0.3 mm on a spoon.
constexpr double least_depth_fraction = 0.002;

// Returns the deepest cell of the hollow that holds most water; empty if no hollow is deep enough.
std::optional<Vector2> find_deepest_point(const HeightMap& map) {
  const std::vector<double> depths_m = find_water_depths_m(map);
  const double least_m = least_depth_fraction * map.cell_m() * std::max(map.rows(), map.columns());
  std::vector<bool> is_seen(depths_m.size());
  std::optional<Vector2> best;
  double most_water = 0.0;
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns()) +
           static_cast<std::size_t>(column);
  };
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      if (is_seen[index(row, column)] || depths_m[index(row, column)] <= 0.0) continue;
      double water = 0.0, deepest = 0.0;
      Vector2 at = Vector2::Zero();
      std::vector<std::pair<int, int>> open{{row, column}};
      is_seen[index(row, column)] = true;
      while (!open.empty()) {
        const auto [r, c] = open.back();
        open.pop_back();
        const double depth = depths_m[index(r, c)];
        water += depth;
        if (depth > deepest) {
          deepest = depth;
          at = map.centre(r, c);
        }
        for (const auto& [dr, dc] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          if (r + dr < 0 || r + dr >= map.rows() || c + dc < 0 || c + dc >= map.columns()) continue;
          const std::size_t next = index(r + dr, c + dc);
          if (is_seen[next] || depths_m[next] <= 0.0) continue;
          is_seen[next] = true;
          open.emplace_back(r + dr, c + dc);
        }
      }
      if (deepest >= least_m && water > most_water) {
        most_water = water;
        best = at;
      }
    }
  }
  return best;
}

// The highest point along a ray over the map, and how far the body goes on behind it.
struct Crest {
  HeightMap::Cell top;
  double distance_m = 0.0, behind_m = 0.0;
};

double median(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

class Rays {
 public:
  Rays(const HeightMap& map, const Vector2& from_m)
      : map_(map), from_m_(from_m), step_m_(0.5 * map.cell_m()) {
    for (int k = 0; k < bowl_rim_corners; ++k) crests_.push_back(find_crest(k));
    find_free_rays();
  }

  // Returns the corners of the ridge. A ray along which the body goes on ends where it reaches the height of
  // the ridge beside it.
  std::vector<Vector2> find_ridge() const {
    std::vector<Vector2> corners;
    for (int k = 0; k < bowl_rim_corners; ++k) {
      corners.push_back(is_free_[index(k)] ? crests_[index(k)].top.parameters : cross_ridge(k).parameters);
    }
    return corners;
  }

 private:
  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  // Returns what `get` finds for each free ray.
  template <class Get>
  std::vector<double> on_free_rays(const Get& get) const {
    std::vector<double> values;
    for (int k = 0; k < bowl_rim_corners; ++k) {
      if (is_free_[index(k)]) values.push_back(get(k));
    }
    return values;
  }

  // Finds the rays that end at the rim: behind the crest the body ends about as soon as on most rays, and the
  // crest is near a plane through the others. A handle that rises from the bowl has its crest far above.
  void find_free_rays() {
    is_free_.assign(index(bowl_rim_corners), true);
    const double wall_m =
        2.0 * median(on_free_rays([&](int k) { return crests_[index(k)].behind_m; })) + 4.0 * map_.cell_m();
    const double radius_m = median(on_free_rays([&](int k) { return crests_[index(k)].distance_m; }));
    for (int k = 0; k < bowl_rim_corners; ++k) is_free_[index(k)] = crests_[index(k)].behind_m <= wall_m;
    for (int round = 0; round < 8; ++round) {
      Eigen::Matrix3d moments = 1e-12 * Eigen::Matrix3d::Identity();
      Vector3 sums = Vector3::Zero();
      const auto place = [&](int k) {
        return Vector3(1.0, crests_[index(k)].distance_m / radius_m * direction(k).x(),
                       crests_[index(k)].distance_m / radius_m * direction(k).y());
      };
      for (int k = 0; k < bowl_rim_corners; ++k) {
        if (!is_free_[index(k)]) continue;
        moments += place(k) * place(k).transpose();
        sums += crests_[index(k)].top.height_m * place(k);
      }
      const Vector3 plane = moments.ldlt().solve(sums);
      const auto above_m = [&](int k) { return crests_[index(k)].top.height_m - plane.dot(place(k)); };
      const double typical_m = median(on_free_rays([&](int k) { return std::abs(above_m(k)); }));
      const double limit_m = std::max(3.0 * typical_m, 0.1 * radius_m);
      for (int k = 0; k < bowl_rim_corners; ++k) {
        is_free_[index(k)] = crests_[index(k)].behind_m <= wall_m && std::abs(above_m(k)) <= limit_m;
      }
      if (on_free_rays(above_m).empty()) break;
    }
  }

  Vector2 direction(int k) const {
    const double angle = 2.0 * std::numbers::pi * k / bowl_rim_corners;
    return {std::cos(angle), std::sin(angle)};
  }

  // Calls `visit(cell, distance)` along a ray until that returns false or the body has ended.
  template <class Visit>
  void walk(int k, const Visit& visit) const {
    double void_m = 0.0;
    for (double distance = 0.0; void_m <= 2.0 * map_.cell_m(); distance += step_m_) {
      const HeightMap::Cell& cell = map_.cell_at(from_m_ + distance * direction(k));
      void_m = cell.height_m == -infinity ? void_m + step_m_ : 0.0;
      if (cell.height_m != -infinity && !visit(cell, distance)) return;
    }
  }

  Crest find_crest(int k) const {
    Crest crest;
    double end_m = 0.0;
    walk(k, [&](const HeightMap::Cell& cell, double distance) {
      if (cell.height_m > crest.top.height_m) {
        crest.top = cell;
        crest.distance_m = distance;
      }
      end_m = distance;
      return true;
    });
    crest.behind_m = end_m - crest.distance_m;
    return crest;
  }

  HeightMap::Cell cross_ridge(int k) const {
    const auto beside = [&](int step) {
      int count = 1;
      const auto at = [&] { return index((k + count * step + 2 * bowl_rim_corners) % bowl_rim_corners); };
      while (count < bowl_rim_corners && !is_free_[at()]) ++count;
      return std::pair{crests_[at()].top.height_m, count};
    };
    const auto [height_before, before] = beside(-1);
    const auto [height_after, after] = beside(1);
    const double level = (height_before * after + height_after * before) / (before + after);
    HeightMap::Cell found = crests_[index(k)].top;
    walk(k, [&](const HeightMap::Cell& cell, double) {
      if (cell.height_m < level) return true;
      found = cell;
      return false;
    });
    return found;
  }

  const HeightMap& map_;
  Vector2 from_m_;
  double step_m_;
  std::vector<Crest> crests_;
  std::vector<bool> is_free_;
};

// Samples a known rim, whose corners may be far apart.
std::vector<Vector2> sample_rim(const Surface& surface, const std::vector<Vector2>& corners) {
  std::vector<Vector2> samples;
  const int steps = std::max(1, bowl_rim_corners / static_cast<int>(corners.size()));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2 &from = corners[k], &to = corners[(k + 1) % corners.size()];
    const bool is_one_point =
        (position(surface, from.x(), from.y()) - position(surface, to.x(), to.y())).norm() <= 1e-9;
    for (int s = 0; s < (is_one_point ? 1 : steps); ++s) samples.push_back(from + (to - from) * s / steps);
  }
  return samples;
}

// Fills the frame and the sizes of a bowl from its rim. `body_centre_m` is the centre of the box about the
// body.
void set_frame(const Surface& surface, const Rim& rim, const Vector3& body_centre_m, Bowl& bowl) {
  bowl.centre_m = rim.centre_m();
  bowl.normal = rim.normal();
  const auto level = [&](const Vector3& v) -> Vector3 { return v - bowl.normal.dot(v) * bowl.normal; };
  std::vector<Vector3> points;
  for (const Vector2& corner : bowl.rim)
    points.push_back(position(surface, corner.x(), corner.y()) - bowl.centre_m);
  double radius = 0.0;
  for (const Vector3& point : points) radius = std::max(radius, point.norm());
  const Vector3 away = level(bowl.centre_m - body_centre_m);
  if (away.norm() > 0.1 * radius) {
    bowl.front = away.normalized();
  } else {
    const Vector3 x = level(Vector3::UnitX()), z = level(Vector3::UnitZ());
    const auto reach = [&](const Vector3& axis) {
      double most = 0.0;
      for (const Vector3& point : points) most = std::max(most, std::abs(axis.normalized().dot(point)));
      return most;
    };
    const bool is_along_z = x.norm() < 0.1 || (z.norm() >= 0.1 && reach(z) > 1.001 * reach(x));
    bowl.front = (is_along_z ? z : x).normalized();
  }
  Box2 box;
  std::size_t first = 0;
  double turned_m2 = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3& next = points[(k + 1) % points.size()];
    box.include({bowl.front.dot(points[k]), bowl.left().dot(points[k])});
    turned_m2 += points[k].cross(next).dot(bowl.normal);
    const auto aside_m = [&](const Vector3& point) {
      return bowl.front.dot(point) > 0.0 ? std::abs(bowl.left().dot(point)) : infinity;
    };
    if (aside_m(points[k]) < aside_m(points[first])) first = k;
  }
  bowl.length_m = box.extent().x();
  bowl.width_m = box.extent().y();
  std::rotate(bowl.rim.begin(), bowl.rim.begin() + static_cast<std::ptrdiff_t>(first), bowl.rim.end());
  if (turned_m2 < 0.0) std::reverse(bowl.rim.begin() + 1, bowl.rim.end());
}

double find_depth_m(const HeightMap& map, const Rim& rim, const Vector3& up, const Bowl& bowl) {
  double lowest = infinity;
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      const HeightMap::Cell& cell = map.cell(row, column);
      if (cell.height_m == -infinity || cell.height_m >= lowest) continue;
      const Vector3 point = map.point(row, column);
      if (!rim.is_outside(point)) lowest = std::min(lowest, cell.height_m);
    }
  }
  return up.dot(bowl.centre_m) - lowest;
}

}  // namespace

double Bowl::pitch_deg(const Vector3& up) const {
  return std::asin(std::clamp(front.dot(up), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

Result<Bowl> find_bowl(const Body& body, const Vector3& up) {
  const std::string where = "body \"" + excerpt(body.name) + "\": ";
  if (body.mesh) {
    return Error{ErrorCode::unsupported, where + "it is a mesh, on which no rim is found; fit surfaces to it",
                 "mesh"};
  }
  const Box extent = bounding_box(body.surface.net);
  const double cell_m = extent.extent().maxCoeff() / cells_along_body;
  const Error no_bowl{ErrorCode::missing,
                      where + "nothing on it would hold water; turn the opening of the bowl upwards",
                      "rim_uv"};
  Bowl bowl;
  std::optional<Rim> rim;
  Vector3 above = up;
  // The ridge is the highest line along the normal of the rim, which is known after a first search.
  for (int pass = 0; pass < 2; ++pass) {
    if (body.rim.empty()) {
      const HeightMap map(body.surface, above, cell_m);
      const std::optional<Vector2> deepest = find_deepest_point(map);
      if (!deepest) return no_bowl;
      bowl.rim = Rays(map, *deepest).find_ridge();
    } else {
      bowl.rim = sample_rim(body.surface, body.rim);
    }
    rim = Rim::on_surface(body.surface, bowl.rim, up);
    if (!rim) return no_bowl;
    above = rim->normal();
  }
  set_frame(body.surface, *rim, extent.centre(), bowl);
  bowl.depth_m = find_depth_m(HeightMap(body.surface, above, cell_m), *rim, above, bowl);
  // A known rim may be that of a plate or a dome.
  if (!(bowl.depth_m >= least_depth_fraction * extent.extent().maxCoeff())) return no_bowl;
  return bowl;
}

}  // namespace spoonbill
