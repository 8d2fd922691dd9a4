// The stages in which a contact is found (section 4.1 of Pungotra et al. 2013), as plain data to be looked
// at: hulls of control points, limits of parameters, spheres level by level, triangles, contact points. No
// tick computes them: whoever draws does, on its own thread, and may allocate.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/solids/surface_contact.h"

namespace spoonbill {

// The finest level of the spheres that are shown. A body's own grid in a simulation ends at level 1, and the
// search goes on below by cutting patches in four, as these levels do.
inline constexpr int finest_stage_level = 3;

// What is kept of each kind; beyond, ContactStages::overflow says so.
inline constexpr std::size_t stage_capacity = 1 << 14;

struct StageLine {
  Vector3 start_m, end_m;
};

// One cell's sphere that was looked at.
struct StageSphere {
  CoverSphere cover;
  LevelCell cell;
  int surface = 0;         // counted through all surfaces of the stages
  bool is_second = false;  // of two surfaces
  bool kept = false;       // refined, or triangulated on the last level; dropped otherwise
};

// One of the two triangles of a cell of the last level that can meet the other side: with the slack by which
// the surface may leave it.
struct StageTriangle {
  Triangle corners;
  LevelCell cell;
  int surface = 0;
};

struct StageContact {
  SurfaceContact at;
  bool is_deepest = false;  // of its region
};

struct ContactStages {
  std::vector<StageLine> hulls;   // their edges
  std::vector<StageLine> ranges;  // borders of the elements within the limits of the parameters
  int elements = 0, elements_within = 0;
  std::vector<StageSphere> spheres;  // level by level for each surface
  std::vector<StageTriangle> triangles;
  int triangles_tested = 0;
  std::vector<StageContact> contacts;
  int surfaces = 0;
  bool overflow = false;
};

// The edges of the hull of a surface's control points, which hold the surface.
void add_hull(const ControlNet& net, ContactStages& stages);

// How far the surface over a cell of the finest level can be from the cell's two triangles.
double triangle_slack(SurfaceLevels& levels, const LevelCell& cell);
std::array<Triangle, 2> triangles_of(const PatchCorners& corners);

// Appends up to the capacity.
template <class Item>
void keep(Item item, std::vector<Item>& items, ContactStages& stages) {
  if (items.size() == stage_capacity) {
    stages.overflow = true;
    return;
  }
  items.push_back(std::move(item));
}

}  // namespace spoonbill
