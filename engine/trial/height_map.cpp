#include "engine/trial/height_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr int most_samples = 384;  // in each direction

// Returns the number of steps along a direction in which a surface of this length has samples `cell_m` apart.
int count_steps(double length_m, double cell_m) {
  return std::clamp(static_cast<int>(std::ceil(length_m / cell_m)), 16, most_samples);
}

struct Samples {
  int rows = 0, columns = 0;
  std::vector<Vector3> points_m;
  std::vector<Vector2> parameters;
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

// Returns the length of the longest line of the control net along a direction.
double longest_line_m(const ControlNet& net, bool along_u) {
  double longest = 0.0;
  const int lines = along_u ? net.columns : net.rows, points = along_u ? net.rows : net.columns;
  for (int line = 0; line < lines; ++line) {
    double length = 0.0;
    for (int k = 1; k < points; ++k) {
      length += along_u ? (net.point(k, line) - net.point(k - 1, line)).norm()
                        : (net.point(line, k) - net.point(line, k - 1)).norm();
    }
    longest = std::max(longest, length);
  }
  return longest;
}

Samples sample_surface(const Surface& surface, double cell_m) {
  Samples samples;
  samples.rows = count_steps(longest_line_m(surface.net, true), cell_m) + 1;
  samples.columns = count_steps(longest_line_m(surface.net, false), cell_m) + 1;
  for (int i = 0; i < samples.rows; ++i) {
    const double u = surface.u.parameter_at(static_cast<double>(i) / (samples.rows - 1));
    for (int j = 0; j < samples.columns; ++j) {
      const double v = surface.v.parameter_at(static_cast<double>(j) / (samples.columns - 1));
      samples.parameters.emplace_back(u, v);
      samples.points_m.push_back(position(surface, u, v));
    }
  }
  return samples;
}

}  // namespace

HeightMap::HeightMap(const Surface& surface, const Vector3& up, double cell_m)
    : up_(up), across_(up.unitOrthogonal()), along_(up.cross(across_)) {
  SPOONBILL_ASSERT(cell_m > 0.0);
  const Samples samples = sample_surface(surface, cell_m);
  Box2 box;
  for (const Vector3& point : samples.points_m) box.include(plan(point));
  const Vector2 extent = box.high - box.low;
  cell_m_ = std::max(cell_m, extent.maxCoeff() / (max_cells - 1));
  low_m_ = box.low;
  rows_ = static_cast<int>(extent.x() / cell_m_) + 1;
  columns_ = static_cast<int>(extent.y() / cell_m_) + 1;
  cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_));
  for (int i = 0; i + 1 < samples.rows; ++i) {
    for (int j = 0; j + 1 < samples.columns; ++j) {
      const std::size_t a = samples.index(i, j), b = samples.index(i + 1, j), c = samples.index(i + 1, j + 1),
                        d = samples.index(i, j + 1);
      for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{a, c, d}}) {
        add_triangle({samples.points_m[p], samples.points_m[q], samples.points_m[r]},
                     {samples.parameters[p], samples.parameters[q], samples.parameters[r]});
      }
    }
  }
}

const HeightMap::Cell& HeightMap::cell(int row, int column) const {
  static const Cell none;
  if (row < 0 || row >= rows_ || column < 0 || column >= columns_) return none;
  return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(column)];
}

const HeightMap::Cell& HeightMap::cell_at(const Vector2& plan_m) const {
  const Vector2 place = (plan_m - low_m_) / cell_m_;
  // The comparison is false for coordinates far outside, which have no int.
  if (!(place.minCoeff() >= 0.0 && place.maxCoeff() < max_cells + 1)) return cell(-1, -1);
  return cell(static_cast<int>(place.x()), static_cast<int>(place.y()));
}

Vector2 HeightMap::centre(int row, int column) const {
  return low_m_ + cell_m_ * Vector2(row + 0.5, column + 0.5);
}

Vector3 HeightMap::point(int row, int column) const {
  const Vector2 at = centre(row, column);
  return at.x() * across_ + at.y() * along_ + cell(row, column).height_m * up_;
}

void HeightMap::add_triangle(const std::array<Vector3, 3>& corners_m,
                             const std::array<Vector2, 3>& parameters) {
  const Vector2 a = plan(corners_m[0]), b = plan(corners_m[1]), c = plan(corners_m[2]);
  const double heights[3] = {up_.dot(corners_m[0]), up_.dot(corners_m[1]), up_.dot(corners_m[2])};
  const auto raise = [&](int row, int column, double height, const Vector2& at) {
    Cell& found = cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(column)];
    if (height > found.height_m) found = {height, at};
  };
  // A triangle smaller than a cell may cover no centre, so its corners count as well.
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector2 place = (plan(corners_m[k]) - low_m_) / cell_m_;
    raise(std::clamp(static_cast<int>(place.x()), 0, rows_ - 1),
          std::clamp(static_cast<int>(place.y()), 0, columns_ - 1), heights[k], parameters[k]);
  }
  const double doubled_area = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  if (doubled_area == 0.0) return;
  const Vector2 low = (a.cwiseMin(b).cwiseMin(c) - low_m_) / cell_m_,
                high = (a.cwiseMax(b).cwiseMax(c) - low_m_) / cell_m_;
  for (int row = static_cast<int>(low.x()); row <= std::min(rows_ - 1, static_cast<int>(high.x())); ++row) {
    for (int column = static_cast<int>(low.y()); column <= std::min(columns_ - 1, static_cast<int>(high.y()));
         ++column) {
      const Vector2 p = centre(row, column);
      const auto part = [&](const Vector2& from, const Vector2& to) {
        return ((to - from).x() * (p - from).y() - (to - from).y() * (p - from).x()) / doubled_area;
      };
      const double wa = part(b, c), wb = part(c, a), wc = part(a, b);
      if (wa < 0.0 || wb < 0.0 || wc < 0.0) continue;
      raise(row, column, wa * heights[0] + wb * heights[1] + wc * heights[2],
            wa * parameters[0] + wb * parameters[1] + wc * parameters[2]);
    }
  }
}

std::vector<double> find_water_depths_m(const HeightMap& map) {
  const int rows = map.rows(), columns = map.columns();
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  };
  std::vector<double> depths_m(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  std::vector<bool> is_reached(depths_m.size());
  using Flooded = std::pair<double, std::size_t>;  // level of the water and cell
  std::priority_queue<Flooded, std::vector<Flooded>, std::greater<>> front;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double height = map.cell(row, column).height_m;
      const bool is_border = row == 0 || row == rows - 1 || column == 0 || column == columns - 1;
      if (height != -infinity && !is_border) continue;
      front.emplace(height, index(row, column));
      is_reached[index(row, column)] = true;
    }
  }
  while (!front.empty()) {
    const auto [level, at] = front.top();
    front.pop();
    const int row = static_cast<int>(at / static_cast<std::size_t>(columns)),
              column = static_cast<int>(at % static_cast<std::size_t>(columns));
    for (const auto& [step_row, step_column] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int next_row = row + step_row, next_column = column + step_column;
      if (next_row < 0 || next_row >= rows || next_column < 0 || next_column >= columns) continue;
      const std::size_t next = index(next_row, next_column);
      if (is_reached[next]) continue;
      is_reached[next] = true;
      const double height = map.cell(next_row, next_column).height_m;
      depths_m[next] = std::max(0.0, level - height);
      front.emplace(std::max(level, height), next);
    }
  }
  return depths_m;
}

}  // namespace spoonbill
