// Stages of a contact search (section 4.1 of Pungotra et al. 2013) as data for drawing: hulls of control
// points, parameter ranges, spheres by level, triangles and contact points. They are computed on the drawing
// thread, not in the tick, and may allocate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/solids/surface_contact.h"

namespace spoonbill {

// The convex hull of points as triangles and edges, given by indices into the points.
struct HullFacets {
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::array<int, 2>> edges;      // edges where the hull bends by more than half a degree
};

// Builds the convex hull of points that are rounded to a grid, so that the signs of volumes are exact. The
// grid has 2^20 steps along the longest side of the points' box. The points are less than one step outside
// the hull. The hull is empty if there are fewer than four points, if all are in one plane or if one is not
// finite.
//
// The time is proportional to points times triangles, up to half a second for the largest control nets. May
// be called from any thread.
HullFacets hull_facets(const std::vector<Vector3>& points_m);

// Finest level of the spheres that are drawn. The grid of a contact search may have fewer levels. Beyond the
// grid's finest level, the search cuts patches into four, as the drawing does at each level.
inline constexpr int finest_stage_level = 3;

// Largest number of stored items of each kind. If there are more, ContactStages::overflow is set.
inline constexpr std::size_t stage_capacity = 1 << 14;

// A line segment.
struct StageLine {
  Vector3 start_m, end_m;
};

// The sphere of a visited cell.
struct StageSphere {
  CoverSphere cover;
  LevelCell cell;
  int surface = 0;         // index over all surfaces in the stages
  bool is_second = false;  // true for the second of two surfaces
  // True if the cell was refined or, at the last level, triangulated; false if it was dropped.
  bool kept = false;
};

// One of the two triangles of a cell of the last level. A triangle is stored if the surface near it may meet
// the other body.
struct StageTriangle {
  Triangle corners;
  LevelCell cell;
  int surface = 0;
};

// A contact point.
struct StageContact {
  SurfaceContact at;
  bool is_deepest = false;  // true for the deepest point of a region
};

// All stages of one or more contact searches.
struct ContactStages {
  std::vector<StageLine> hulls;   // edges of the convex hulls of the control points
  std::vector<StageLine> ranges;  // borders of the elements within the parameter ranges that may meet
  int elements = 0, elements_within = 0;
  std::vector<StageSphere> spheres;  // for each surface, level by level
  std::vector<StageTriangle> triangles;
  int triangles_tested = 0;
  std::vector<StageContact> contacts;
  int surfaces = 0;
  bool overflow = false;
};

// Adds the edges of the convex hull of the control points, which contains the surface.
void add_hull(const ControlNet& net, ContactStages& stages);

// Returns an upper bound, in metres, of the distance between the surface over a finest cell and the two
// triangles of that cell.
double triangle_slack(SurfaceLevels& levels, const LevelCell& cell);
// Returns the two triangles of a cell with the given corners.
std::array<Triangle, 2> cell_triangles(const PatchCorners& corners);

// Appends an item. If there are stage_capacity items already, it sets the overflow flag instead.
template <class Item>
void append(Item item, std::vector<Item>& items, ContactStages& stages) {
  if (items.size() == stage_capacity) {
    stages.overflow = true;
    return;
  }
  items.push_back(std::move(item));
}

// A set of elements of one surface, for drawing their borders. Not thread-safe. The levels must outlive the
// set, and SurfaceLevels::begin() must have been called.
class ElementMarks {
 public:
  explicit ElementMarks(SurfaceLevels& levels)
      : levels_(levels),
        rows_((levels.nested().grid.rows() - 1) / levels.step(0)),
        columns_((levels.nested().grid.columns() - 1) / levels.step(0)),
        within_(static_cast<std::size_t>(rows_ * columns_), 0) {}

  void mark(const LevelCell& element) {
    within_[static_cast<std::size_t>(element.i / levels_.step(0) * columns_ + element.j / levels_.step(0))] =
        1;
  }
  template <class Visit>
  void visit(const Visit& visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (is_within(row, column)) visit(LevelCell{row * levels_.step(0), column * levels_.step(0), 0});
      }
    }
  }
  // Adds the borders and the number of the marked elements to the stages.
  void add_to(ContactStages& stages) const;

 private:
  bool is_within(int row, int column) const {
    const Grid& grid = levels_.nested().grid;
    if (grid.u.knots.is_periodic()) row = (row + rows_) % rows_;
    if (grid.v.knots.is_periodic()) column = (column + columns_) % columns_;
    if (row < 0 || row >= rows_ || column < 0 || column >= columns_) return false;
    return within_[static_cast<std::size_t>(row * columns_ + column)] != 0;
  }
  // Adds one side of an element as a line. The line connects the element's samples from (i, j) on, with the
  // given step in rows or columns.
  void add_border(int i, int j, int row_step, int column_step, ContactStages& stages) const;

  SurfaceLevels& levels_;
  int rows_, columns_;
  std::vector<std::uint8_t> within_;
};

}  // namespace spoonbill
