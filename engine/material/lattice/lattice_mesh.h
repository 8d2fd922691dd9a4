// Geometry of a lattice, without material: a regular block of nodes bent into a body, its cells, and the
// choice of node counts.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Location of a node relative to the body. `on_shell` means on the body's surface or, in a box of cells about
// the body, on the boundary of the filled cells.
enum class NodeLocation : std::uint8_t { outside_body, in_body, on_shell };

// A point as a weighted mean of a cell's corner nodes, with which it moves. Weights sum to 1; inside the cell
// they are not negative.
struct CellPoint {
  std::array<int, 8> nodes{};
  std::array<double, 8> weights{};
};

// Closed triangle mesh of the surface of a body in a box of cells, about as coarse as the cells. Because it
// is closed, a uniform pressure on it has no resultant in any deformed shape.
struct BodySkin {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<CellPoint> points;
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  std::vector<BodyCoordinates> triangle_centres;
};

// Nodes and cells of a lattice. Plain data. i and j run across the body, k along it and slowest in memory.
// Nodes of neighbouring slices of constant k are thus close in memory, and the nodes that a plane across the
// body fixes are contiguous.
struct LatticeMesh {
  std::array<int, 3> count{};
  // True if i runs once around the body. The nodes of the last i then coincide with those of the first i,
  // which represent both.
  bool closed = false;
  // True for a thin shell. j then runs through the thickness, from the surface against its normals.
  bool thin = false;
  // True for the frame of a rigid body (rigid_frame()): a single cell, whose nodes move with the body's pose.
  bool is_frame = false;
  std::vector<Vector3> nodes;  // m
  // Fraction of each cell that belongs to the body, by cell_index(); empty if all are 1.
  std::vector<double> cell_fractions;
  std::vector<bool> filled;  // true if a cell contains part of the body, by cell_index(); empty if all do
  std::vector<NodeLocation> node_locations;  // by node; empty if the body fills its block
  // Position of each node around a tube, ring or bowl, as a fraction of a turn, 0 to 1. It grows with the
  // surface's periodic parameter. 0 on the axis of a tube.
  std::vector<double> turns;
  // For a box of cells around a surface: position of each node along the body, 0 to 1, and its depth below
  // the surface. NaN for nodes outside the body. Empty for other lattices.
  std::vector<double> along, depth_m;
  // Data of a box of cells around a surface. `cell_centres` are the body coordinates of the surface sample
  // nearest to each cell's centre, with the depth of the centre (0 outside). `skin` is the mesh on which
  // pressure acts. `slender` is true if the body is thinner than two cells anywhere.
  std::vector<BodyCoordinates> cell_centres;
  BodySkin skin;
  bool slender = false;

  int index(int i, int j, int k) const { return (k * count[0] + i) * count[1] + j; }
  // Inverse of index(): returns {i, j, k}.
  std::array<int, 3> grid_index(int node) const {
    return {node / count[1] % count[0], node % count[1], node / (count[0] * count[1])};
  }
  int node_count() const { return count[0] * count[1] * count[2]; }
  // Returns the node that coincides with `node` at the seam of a closed block; elsewhere `node` itself.
  int twin(int node) const {
    if (!closed) return node;
    const int i = grid_index(node)[0], last = count[0] - 1;
    return i == 0 ? node + last * count[1] : i == last ? node - last * count[1] : node;
  }
  // Returns the node that represents `node`: at the seam of a closed block the node of the first i, elsewhere
  // `node` itself.
  int joined(int node) const { return closed && grid_index(node)[0] == count[0] - 1 ? twin(node) : node; }
  std::size_t cell_count() const {
    return static_cast<std::size_t>((count[0] - 1) * (count[1] - 1) * (count[2] - 1));
  }
  std::size_t cell_index(int i, int j, int k) const {
    return static_cast<std::size_t>((k * (count[0] - 1) + i) * (count[1] - 1) + j);
  }
  double cell_fraction(int i, int j, int k) const {
    return cell_fractions.empty() ? 1.0 : cell_fractions[cell_index(i, j, k)];
  }
  bool is_filled(int i, int j, int k) const { return filled.empty() || filled[cell_index(i, j, k)]; }
  // Returns the corners of the cell whose first corner is node (i, j, k). Bit 0 of a corner's number adds 1
  // to k, bit 1 to j, bit 2 to i.
  std::array<Vector3, 8> cell(int i, int j, int k) const;
  NodeLocation node_location(int i, int j, int k) const;
  // Returns the mean distance between neighbours along i, j and k, m.
  double mean_edge() const;
};

using CellCorners = std::array<Vector3, 8>;

// Returns the exact volume of a trilinear cell, m^3. The result is the mean over the two triangulations of
// each face, which equals the volume under the bilinear face.
double cell_volume(const CellCorners& corners);

// Returns the volume between the origin and a quad face, m^3, positive if a, b, c, d run counter-clockwise
// seen from the side away from the origin. The face counts as the mean of its two triangulations.
double quad_cone_volume(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

// Returns the smallest Jacobian determinant at the corners divided by the cell's volume: 1 for a box, at most
// 0 for a folded cell.
double smallest_jacobian_ratio(const CellCorners& corners);

// Returns the point at (a, b, c) along i, j and k, each 0 to 1 inside the cell.
Vector3 trilinear(const CellCorners& corners, double a, double b, double c);

// Returns the derivative of trilinear(), m, with columns along i, j and k.
Eigen::Matrix3d trilinear_jacobian(const CellCorners& corners, double a, double b, double c);

// Position of a point relative to a cell: the weights of the corners, and its distance outside the cell, in
// units of the cell. Found by Newton's method on the trilinear map; `outside` is infinite if the method does
// not converge.
struct CellLocation {
  std::array<double, 8> weights{};
  double outside = 0.0;
};
CellLocation locate_in_cell(const CellCorners& corners, const Vector3& point);

// Returns a box with one corner at the origin and edges along x (count[0]), y (count[1]) and z (count[2]).
LatticeMesh box_mesh(const Vector3& size_m, std::array<int, 3> counts);

// Checks that no cell is folded; the message names the worst cell.
Status check_cells(const LatticeMesh& mesh);

// Returns the node counts along i, j, k for a body of these extents, which must be above zero. Fails on
// requested counts below 2.
Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m);
// Returns the node counts for a shell, which may be a single layer of cells. `closed` is true if i runs once
// around the shell. Fails on requested counts below 2, and on fewer than min_cells_around cells around a
// closed shell.
Result<std::array<int, 3>> shell_counts(const LatticeRequest& request, const Vector3& size_m, bool closed);

// Smallest number of cells around a closed shell.
inline constexpr int min_cells_around = 3;

}  // namespace spoonbill
