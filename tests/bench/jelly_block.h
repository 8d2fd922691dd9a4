// The block of jelly that is compared with Bullet's deformable body and with finite elements: 12 x 6 x 10
// nodes, 30 x 15 x 24 mm. It stands on a fixed base and sags under its own weight.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

inline constexpr std::array<int, 3> jelly_counts{12, 6, 10};  // nodes along x, y and z
inline const Vector3 jelly_size_m{0.030, 0.015, 0.024};

// Returns gelatin with a Young's modulus of 4.3 kPa and a Poisson's ratio of 0.49, without relaxation.
Material jelly_material();

// Returns the index of a node in the lists of this file. The base comes last, because Bullet's implicit
// scheme gives forces to the wrong nodes if fixed nodes precede free ones.
int jelly_node_index(int i, int j, int k);
// Nodes at rest, m. The origin is the centre of the base.
std::vector<Vector3> jelly_nodes_m();
int jelly_free_node_count();
// Mass of each node, kg: an eighth of each cell that meets there.
std::vector<double> jelly_node_masses_kg();

// Displacements of the nodes at rest under gravity by finite elements (calculix/jelly.py), m.
Result<std::vector<Vector3>> read_jelly_solution_m(const std::string& file);

// Returns the root of the mean square of the differences, over the root of the mean square of the solution.
// Infinite if a displacement is not finite.
double relative_jelly_error(std::span<const Vector3> displacements_m, std::span<const Vector3> solution_m);
// Returns the mean drop of the top, m.
double jelly_sag_m(std::span<const Vector3> displacements_m);

}  // namespace spoonbill
