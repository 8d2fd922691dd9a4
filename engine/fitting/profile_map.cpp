#include "engine/fitting/profile_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/quantiles.h"

namespace spoonbill {
namespace {

constexpr double roundness = 0.1;
// Of the size: a wall is thin below, and two faces are told apart from so many cells on.
constexpr double thin_share = 0.1;
constexpr double told_apart_cells = 3.0;
// So many points a cell of the profile, were they all on a way three times the size.
constexpr double points_a_cell = 12.0;
constexpr double face_share = 0.2;  // of the wall's thickness
// Of the wall's thickness: where half the points lie deeper, they may be one face with its noise.
constexpr double between_share = 0.25;
constexpr double seen_share = 0.85;
constexpr int least_points = 2;           // in a cell that counts
constexpr int dilation = 2;               // cells
constexpr double near_axis_share = 0.05;  // of the largest distance from it

struct Axis {
  Vector3 middle = Vector3::Zero(), along = Vector3::UnitZ(), first = Vector3::UnitX();
  Vector3 second() const { return along.cross(first); }
};

std::optional<Axis> round_axis(const std::vector<Vector3>& points_m) {
  Axis axis;
  const auto count = static_cast<double>(points_m.size());
  for (const Vector3& point : points_m) axis.middle += point / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3& point : points_m) {
    spread += (point - axis.middle) * (point - axis.middle).transpose() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Vector3& squares = solver.eigenvalues();
  const bool flat = squares[2] - squares[1] < roundness * squares[2];
  const bool slender = squares[1] - squares[0] < roundness * squares[1];
  if (flat == slender) return {};
  axis.along = solver.eigenvectors().col(flat ? 0 : 2);
  axis.first = solver.eigenvectors().col(1);
  return axis;
}

// Distance from the axis and height along it, of each point.
struct AxisProfile {
  std::vector<Vector2> places;
  Box2 box;  // from the axis outwards
};

AxisProfile profile_of(const std::vector<Vector3>& points_m, const Axis& axis) {
  AxisProfile profile;
  profile.box.low.x() = profile.box.high.x() = 0.0;
  for (const Vector3& point : points_m) {
    const Vector3 way = point - axis.middle;
    const double height = way.dot(axis.along);
    const Vector2 place((way - height * axis.along).norm(), height);
    profile.places.push_back(place);
    profile.box.include(place);
  }
  return profile;
}

// Cells of the half plane beside the axis, which is the left side of column 0; with a margin elsewhere.
class Picture {
 public:
  Picture(const AxisProfile& profile, double cell_m) : cell_m_(cell_m), low_(profile.box.low) {
    constexpr int margin = dilation + 2;
    low_.y() -= margin * cell_m;
    columns_ = static_cast<int>((profile.box.high.x() - profile.box.low.x()) / cell_m) + 1 + margin;
    rows_ = static_cast<int>((profile.box.high.y() - low_.y()) / cell_m) + 1 + margin;
    std::vector<int> counts(static_cast<std::size_t>(columns_) * rows_, 0);
    for (const Vector2& place : profile.places) ++counts[index(column_of(place), row_of(place))];
    filled_.assign(counts.size(), false);
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        // Rings near the axis are short and have few points: one there stands for all from it to the axis.
        const bool near_axis = column < near_axis_share * columns_;
        if (counts[index(column, row)] < (near_axis ? 1 : least_points)) continue;
        for (int c = near_axis ? 0 : column; c <= column; ++c) fill_around(c, row);
      }
    }
    flood_outside();
  }

  // Along the sides of cells between what is filled and the outside, from the axis to the axis; and the area
  // within. Empty where it does not come back to the axis.
  std::vector<Vector2> outline() const;
  double area() const {
    return cell_m_ * cell_m_ * static_cast<double>(std::count(outside_.begin(), outside_.end(), false));
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  int column_of(const Vector2& place) const { return static_cast<int>(place.x() / cell_m_); }
  int row_of(const Vector2& place) const { return static_cast<int>((place.y() - low_.y()) / cell_m_); }
  bool inside(int column, int row) const {
    return column >= 0 && column < columns_ && row >= 0 && row < rows_ && !outside_[index(column, row)];
  }

  void fill_around(int column, int row) {
    for (int dc = -dilation; dc <= dilation; ++dc) {
      for (int dr = -dilation; dr <= dilation; ++dr) {
        if (dc * dc + dr * dr > dilation * dilation + 1) continue;
        const int c = std::clamp(column + dc, 0, columns_ - 1), r = std::clamp(row + dr, 0, rows_ - 1);
        filled_[index(c, r)] = true;
      }
    }
  }

  void flood_outside() {
    outside_.assign(filled_.size(), false);
    std::vector<std::array<int, 2>> waiting{{columns_ - 1, rows_ - 1}};
    outside_[index(columns_ - 1, rows_ - 1)] = true;
    while (!waiting.empty()) {
      const auto [column, row] = waiting.back();
      waiting.pop_back();
      static constexpr std::array<std::array<int, 2>, 4> steps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
      for (const auto& [dc, dr] : steps) {
        const int c = column + dc, r = row + dr;
        if (c < 0 || c >= columns_ || r < 0 || r >= rows_ || filled_[index(c, r)] || outside_[index(c, r)]) {
          continue;
        }
        outside_[index(c, r)] = true;
        waiting.push_back({c, r});
      }
    }
  }

  double cell_m_;
  Vector2 low_;
  int columns_ = 0, rows_ = 0;
  std::vector<bool> filled_, outside_;
};

std::vector<Vector2> Picture::outline() const {
  // Corners of cells are (column, row) of the cell above and to the right of them. What is filled stays on
  // the right hand: down from the top of the axis, the first filled cell's upper side.
  int row = rows_;
  while (row > 0 && !inside(0, row - 1)) --row;
  if (row == 0) return {};
  int column = 0, dc = 1, dr = 0;
  std::vector<Vector2> way;
  const auto put = [&] { way.emplace_back(cell_m_ * column, low_.y() + cell_m_ * row); };
  put();
  for (std::size_t step = 0; step < 4 * filled_.size(); ++step) {
    column += dc;
    row += dr;
    put();
    if (column == 0) return way;
    // The two cells ahead, to the left and the right of the way.
    const auto ahead = [&](bool left) {
      const int side = left ? 1 : -1;
      // Of a corner, the cell in direction (x, y) with x, y = +-1.
      const int x = dc + side * -dr, y = dr + side * dc;
      return inside(x > 0 ? column : column - 1, y > 0 ? row : row - 1);
    };
    const int old_dc = dc, old_dr = dr;
    if (ahead(true)) {
      dc = -old_dr, dr = old_dc;  // left
    } else if (!ahead(false)) {
      dc = old_dr, dr = -old_dc;  // right
    }
  }
  return {};
}

// Without the steps of the cells.
std::vector<Vector2> smoothed(const std::vector<Vector2>& way) {
  std::vector<Vector2> smooth = way;
  constexpr int reach = 3;
  const int last = static_cast<int>(way.size()) - 1;
  for (int k = 1; k < last; ++k) {
    const int near = std::min({reach, k, last - k});
    Vector2 sum = Vector2::Zero();
    for (int m = k - near; m <= k + near; ++m) sum += way[static_cast<std::size_t>(m)];
    smooth[static_cast<std::size_t>(k)] = sum / (2 * near + 1);
  }
  return smooth;
}

// Shares of the way's length at its corners.
std::vector<double> shares_along(const std::vector<Vector2>& way) {
  std::vector<double> shares(way.size(), 0.0);
  for (std::size_t k = 1; k < way.size(); ++k) shares[k] = shares[k - 1] + (way[k] - way[k - 1]).norm();
  const double length = shares.back();
  for (double& share : shares) share /= length;
  return shares;
}

double length_of(const std::vector<Vector2>& way) {
  double length = 0.0;
  for (std::size_t k = 1; k < way.size(); ++k) length += (way[k] - way[k - 1]).norm();
  return length;
}

// How much of both faces has points on it, no deeper than a face is thick: of a grid of sectors and lengths.
// Sheets with waves fill the profile as well, but each place of it somewhere else.
double seen_all_around(const std::vector<Vector2>& uv, const std::vector<double>& depths, double reach) {
  constexpr int sectors = 8, lengths = 16;
  std::array<bool, sectors * lengths> seen{};
  for (std::size_t p = 0; p < uv.size(); ++p) {
    if (depths[p] > reach) continue;
    const int sector = std::min(sectors - 1, static_cast<int>(uv[p].x() * sectors));
    const int length = std::min(lengths - 1, static_cast<int>(uv[p].y() * lengths));
    seen[static_cast<std::size_t>(sector * lengths + length)] = true;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
}

}  // namespace

std::optional<ProfileMap> profile_map(const std::vector<Vector3>& points_m) {
  const auto axis = round_axis(points_m);
  if (!axis) return {};
  const AxisProfile profile = profile_of(points_m, *axis);
  const double size = (profile.box.high - profile.box.low).norm();
  const double cell =
      size * std::clamp(3.0 * points_a_cell / static_cast<double>(points_m.size()), 1.0 / 250.0, 1.0 / 80.0);
  const Picture picture(profile, cell);
  const std::vector<Vector2> way = smoothed(picture.outline());
  if (way.size() < 20) return {};
  const double thickness = 2.0 * picture.area() / length_of(way) - 2.0 * dilation * cell;
  if (thickness > thin_share * size || thickness < told_apart_cells * cell) return {};
  std::vector<Vector3> corners;
  corners.reserve(way.size());
  for (const Vector2& place : way) corners.emplace_back(place.x(), place.y(), 0.0);
  const NearestPoints nearest(corners);
  const std::vector<double> shares = shares_along(way);
  Parameterisation start;
  start.kind = ShapeKind::closed;
  std::vector<double> depths;
  for (std::size_t p = 0; p < points_m.size(); ++p) {
    const Vector3 out = points_m[p] - axis->middle;
    const double turn = std::atan2(out.dot(axis->second()), out.dot(axis->first)) / (2.0 * std::numbers::pi);
    const auto found = nearest.nearest({profile.places[p].x(), profile.places[p].y(), 0.0});
    start.uv.emplace_back(turn - std::floor(turn), shares[found.index]);
    depths.push_back(found.distance - dilation * cell);
  }
  if (seen_all_around(start.uv, depths, face_share * thickness + 1.5 * cell) < seen_share) return {};
  return ProfileMap{std::move(start), median_of(depths) > between_share * thickness};
}

}  // namespace spoonbill
