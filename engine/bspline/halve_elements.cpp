#include "engine/bspline/halve_elements.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/reparameterise.h"

namespace spoonbill {
namespace {

std::vector<double> ends_and_midpoints(const KnotVector& knots) {
  const std::vector<double> ends = knots.breakpoints();
  std::vector<double> stations = {ends.front()};
  for (std::size_t e = 1; e < ends.size(); ++e) {
    stations.push_back(0.5 * (ends[e - 1] + ends[e]));
    stations.push_back(ends[e]);
  }
  return stations;
}

// Returns the midpoints of the elements that are too long in a direction.
std::vector<double> find_long_elements(const Surface& surface, Direction direction, double longest_m) {
  const bool along_u = direction == Direction::u;
  const std::vector<double> along = ends_and_midpoints(along_u ? surface.u : surface.v);
  const std::vector<double> across = ends_and_midpoints(along_u ? surface.v : surface.u);
  std::vector<double> midpoints;
  for (std::size_t e = 0; e + 2 < along.size(); e += 2) {
    double length_m = 0.0;
    for (const double at : across) {
      const auto point = [&](double parameter) {
        return along_u ? position(surface, parameter, at) : position(surface, at, parameter);
      };
      const Vector3 mid_point = point(along[e + 1]);
      length_m =
          std::max(length_m, (mid_point - point(along[e])).norm() + (point(along[e + 2]) - mid_point).norm());
    }
    if (length_m > longest_m) midpoints.push_back(along[e + 1]);
  }
  return midpoints;
}

}  // namespace

Result<Surface> halve_long_elements(Surface surface, double longest_m, int most_control_points,
                                    int most_in_direction) {
  SPOONBILL_ASSERT(longest_m > 0.0);
  while (true) {
    const std::vector<double> u = find_long_elements(surface, Direction::u, longest_m);
    const std::vector<double> v = find_long_elements(surface, Direction::v, longest_m);
    const int rows = surface.net.rows + static_cast<int>(u.size());
    const int columns = surface.net.columns + static_cast<int>(v.size());
    const bool is_too_large =
        rows * columns > most_control_points || std::max(rows, columns) > most_in_direction;
    if ((u.empty() && v.empty()) || is_too_large) return surface;
    for (const auto& [direction, midpoints] : {std::pair{Direction::u, &u}, std::pair{Direction::v, &v}}) {
      for (const double midpoint : *midpoints) {
        Result<Surface> halved = insert_knot(surface, direction, midpoint, 1);
        if (!halved.ok()) return halved.error();
        surface = std::move(halved).value();
      }
    }
  }
}

}  // namespace spoonbill
