// Triangles of simple solids around the y axis, for SolidPass. No GL.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace spoonbill {

struct SolidVertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  // unit, outward
};

// Three vertices a triangle, counter-clockwise seen from outside.
std::vector<SolidVertex> lathe_sphere(int segments);    // radius 1 around the origin
std::vector<SolidVertex> lathe_cylinder(int segments);  // radius 1, from y = 0 to 1, with both ends
std::vector<SolidVertex> lathe_cone(int segments);      // radius 1 at y = 0, tip at y = 1, with its base
std::vector<SolidVertex> unit_pane();                   // the unit square of the xy plane

}  // namespace spoonbill
