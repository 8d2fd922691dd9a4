// The shape of a lattice: a regular block of nodes bent into a body, before any material. Plain data.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

enum class NodePlace : std::uint8_t { beside_body, in_body, on_shell };

// A point that follows a cell: weights that sum to 1, none negative.
struct CellPoint {
  std::array<int, 8> nodes{};
  std::array<double, 8> weights{};
};

// The skin of a body in a box of cells, as coarse as the cells are: closed, so that even pressure on it sums
// to nothing however it is bent.
struct BodySkin {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<CellPoint> points;
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  std::vector<BodyCoordinates> middles;   // of the triangles
};

// i and j run across the body, k along it, slowest: neighbours in memory are near whatever the body's length,
// and what a plane holds of it is one stretch of memory.
struct LatticeMesh {
  std::array<int, 3> count{};
  // i runs once around: nodes of the last i are those of the first and stay one place, whose first stands for
  // both.
  bool closed = false;
  // A thin shell: j runs through its thickness, from the face that its normals point out of.
  bool thin = false;
  std::vector<Vector3> nodes;  // m
  // How much of each cell there is, in the order of its first corners; empty: all of every one.
  std::vector<double> cell_shares;
  std::vector<bool> filled;       // whether a cell holds any of the body, in that order; empty: every one
  std::vector<NodePlace> places;  // of each node; empty: the block is the body
  // Of each node of a tube or ring: where around it, 0 to 1 in the sense of u; 0 on its axis.
  std::vector<double> turns;
  // Of each node of a box about a surface: where along the body, 0 to 1, and how deep in it, not a number
  // beside the body; empty of others, whose block tells both.
  std::vector<double> along, depth_m;
  // Of such a box: where the skin is nearest to the middle of each cell, and how deep that is, 0 outside; the
  // skin that bears its pressure; whether the body is thinner than two cells anywhere.
  std::vector<BodyCoordinates> middles;
  BodySkin skin;
  bool slender = false;

  int index(int i, int j, int k) const { return (k * count[0] + i) * count[1] + j; }
  // The inverse: i, j, k.
  std::array<int, 3> place(int index) const {
    return {index / count[1] % count[0], index % count[1], index / (count[0] * count[1])};
  }
  int node_count() const { return count[0] * count[1] * count[2]; }
  // The other node of the same place; itself where it is alone.
  int twin(int node) const {
    if (!closed) return node;
    const int i = place(node)[0], last = count[0] - 1;
    return i == 0 ? node + last * count[1] : i == last ? node - last * count[1] : node;
  }
  // The node that stands for its place.
  int joined(int node) const { return closed && place(node)[0] == count[0] - 1 ? twin(node) : node; }
  std::size_t cell_count() const {
    return static_cast<std::size_t>((count[0] - 1) * (count[1] - 1) * (count[2] - 1));
  }
  std::size_t cell_index(int i, int j, int k) const {
    return static_cast<std::size_t>((k * (count[0] - 1) + i) * (count[1] - 1) + j);
  }
  double share(int i, int j, int k) const {
    return cell_shares.empty() ? 1.0 : cell_shares[cell_index(i, j, k)];
  }
  bool is_filled(int i, int j, int k) const { return filled.empty() || filled[cell_index(i, j, k)]; }
  // The corners of the cell whose first corner is (i, j, k): bit 0 of the corner adds to k, bit 1 to j, bit 2
  // to i.
  std::array<Vector3, 8> cell(int i, int j, int k) const;
  NodePlace place_of(int i, int j, int k) const;
  // The mean edge length, m.
  double mean_edge() const;
};

using CellCorners = std::array<Vector3, 8>;

// The exact volume of a trilinear cell: each quad face counts as the mean of its two triangulations.
double cell_volume(const CellCorners& corners);

// The smallest Jacobian determinant over the corners, divided by the cell's volume: 1 for a box, at most 0
// for a cell that is folded over.
double smallest_jacobian_ratio(const CellCorners& corners);

// The point at (a, b, c), each 0 to 1 inside the cell, along i, j and k.
Vector3 trilinear(const CellCorners& corners, double a, double b, double c);

// The derivative of that map, columns along i, j and k, m.
Eigen::Matrix3d trilinear_jacobian(const CellCorners& corners, double a, double b, double c);

// Where `point` lies in a cell: the weights of its corners, and by how much (in units of the cell) the point
// lies outside it. Newton's method on the trilinear map; `outside` is infinite where it does not converge.
struct CellLocation {
  std::array<double, 8> weights{};
  double outside = 0.0;
};
CellLocation locate_in_cell(const CellCorners& corners, const Vector3& point);

// A box with one corner at the origin, its edges along x (count[0]), y (count[1]) and z (count[2]).
LatticeMesh box_mesh(const Vector3& size_m, std::array<int, 3> counts);

// Refused when a cell is folded over; the message names the worst cell.
Status check_cells(const LatticeMesh& mesh);

}  // namespace spoonbill
