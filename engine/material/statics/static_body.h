// Body of a static study: the cells of a lattice with the material's own stiffness, in double precision,
// and their loads and fixtures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/base/result.h"
#include "engine/material/cells/corotated_cell.h"
#include "engine/material/cells/spring_cell.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice_materials.h"

namespace spoonbill {

// Pressure on the skin of a body in a box of cells. The force on a triangle is its pressure times its
// deformed area, a third at each corner. A corner's force is distributed to the lattice nodes that the corner
// follows, so the forces do the same work as the pressure on the enclosed volume. Has one owner.
class PressedSkin {
 public:
  bool empty() const { return triangles_.empty(); }

  // Adds a pressure on a triangle, Pa; it acts inwards. All triangles must be of one skin.
  void press(const BodySkin& skin, std::size_t triangle, double pressure_pa);

  std::vector<int> nodes() const;  // Returns the loaded nodes in ascending order.

  // Calls `receive(node, force_n)` for the forces on nodes at the positions `position_of(node)`, m. A node
  // may occur more than once. Allocates nothing.
  template <class PositionOf, class Receive>
  void find_forces(const PositionOf& position_of, const Receive& receive) {
    for (std::size_t p = 0; p < points_.size(); ++p) {
      position_m_[p].setZero();
      force_n_[p].setZero();
      for (std::size_t c = 0; c < 8; ++c) {
        position_m_[p] += points_[p].weights[c] * position_of(points_[p].nodes[c]);
      }
    }
    update_point_forces();
    for (std::size_t p = 0; p < points_.size(); ++p) {
      for (std::size_t c = 0; c < 8; ++c) receive(points_[p].nodes[c], points_[p].weights[c] * force_n_[p]);
    }
  }

 private:
  struct Pressed {
    BodySkin::Triangle points{};
    double pressure_pa = 0.0;
  };
  void update_point_forces();

  std::vector<CellPoint> points_;  // corners of the pressed triangles
  std::vector<Pressed> triangles_;
  std::vector<int> point_index_;               // index in points_ for each point of the skin, or -1
  std::vector<Vector3> position_m_, force_n_;  // working memory: one entry for each point
};

enum class CellKind : std::uint8_t {
  springs,    // springs as in sculpting; Poisson's ratio must be at least 1/4
  hexahedra,  // hexahedra: far fewer cells for the same error in bending; any Poisson's ratio
};

struct NodeForce {
  int node = 0;
  Vector3 force_n = Vector3::Zero();
};

// Pressure on a face of the body, with corners counter-clockwise seen from outside. It acts inwards and
// follows the face.
struct PressedFace {
  std::array<int, 4> nodes{};
  double pressure_pa = 0.0;
};

struct StaticLoads {
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  std::vector<NodeForce> forces;
  std::vector<PressedFace> pressures;
  PressedSkin pressed_skin = {};
};

// A prescribed coordinate of a node.
struct FixedAxis {
  int node = 0;
  int axis = 0;  // 0 to 2: x, y, z
  double displacement_m = 0.0;
};

// Fixes all three coordinates of a node.
void fix_node(int node, const Vector3& displacement_m, std::vector<FixedAxis>& fixed);

// Cells of a lattice and the masses of its nodes. Immutable. It is built for a study, never within a tick.
class StaticBody {
 public:
  // Builds the body of a study. Fails on materials outside their ranges, on folded cells, and on springs with
  // a Poisson's ratio below 1/4.
  static Result<StaticBody> make(const LatticeMesh& mesh, const LatticeMaterials& materials, CellKind kind);

  const LatticeMesh& mesh() const { return mesh_; }
  std::size_t cell_count() const { return cells_.size(); }
  // Nodes in the corner order of LatticeMesh::cell().
  const std::array<int, 8>& cell_nodes(std::size_t cell) const { return cells_[cell].nodes; }
  CellResponse respond(std::size_t cell, const CellMoves& moves, Tangent tangent) const;
  double energy_j(std::size_t cell, const CellMoves& moves) const;
  double mass_kg(int node) const { return mass_[static_cast<std::size_t>(node)]; }

 private:
  struct Cell {
    std::array<int, 8> nodes{};
    std::variant<SpringCell, CorotatedCell> model;
  };

  LatticeMesh mesh_;
  std::vector<Cell> cells_;
  std::vector<double> mass_;
};

}  // namespace spoonbill
