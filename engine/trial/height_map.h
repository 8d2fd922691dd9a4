// The top of a surface, seen from above: its height over a plane, in cells.
#pragma once

#include <array>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A map of the heights of a surface along a unit vector, in square cells. Plain data; used by one thread.
class HeightMap {
 public:
  // Heights are those of triangles between samples of the surface, about `cell_m` apart or, on a large
  // surface, as close as a few ten thousand samples allow. The longer side has at most max_cells cells.
  HeightMap(const Surface& surface, const Vector3& up, double cell_m);
  static constexpr int max_cells = 800;

  struct Cell {
    double height_m = -infinity;           // of the highest point over the cell; -infinity: no surface
    Vector2 parameters = Vector2::Zero();  // (u, v) of that point
  };

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  double cell_m() const { return cell_m_; }
  // Row and column may be outside the map, where there is no surface.
  const Cell& cell(int row, int column) const;
  // Returns the cell that has a point of the plane.
  const Cell& cell_at(const Vector2& plan_m) const;
  // Returns a point of space as a point of the plane, and the centre of a cell as such a point.
  Vector2 plan(const Vector3& point_m) const { return {across_.dot(point_m), along_.dot(point_m)}; }
  Vector2 centre(int row, int column) const;
  // Returns the point of the surface over the centre of a cell, which must have one.
  Vector3 point(int row, int column) const;

 private:
  void add_triangle(const std::array<Vector3, 3>& corners_m, const std::array<Vector2, 3>& parameters);

  Vector3 up_, across_, along_;
  Vector2 low_m_ = Vector2::Zero();
  double cell_m_ = 0.0;
  int rows_ = 0, columns_ = 0;
  std::vector<Cell> cells_;
};

// The water that a height map holds: a depth for each cell, after rain has filled every hollow up to where it
// overflows (priority flood, Barnes et al. 2014). Where there is no surface, water drains.
std::vector<double> find_water_depths_m(const HeightMap& map);

}  // namespace spoonbill
