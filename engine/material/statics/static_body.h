// A body as a study sees it: the cells of a lattice with the material's own stiffness, in double, and what
// loads and holds it.
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/base/result.h"
#include "engine/material/cells/corotated_cell.h"
#include "engine/material/cells/spring_cell.h"
#include "engine/material/lattice_materials.h"
#include "engine/material/statics/pressed_skin.h"

namespace spoonbill {

enum class CellKind : std::uint8_t {
  springs,    // what sculpting steps; Poisson's ratio from 1/4 on
  hexahedra,  // far fewer cells for the same error where bodies bend; any Poisson's ratio
};

struct NodeForce {
  int node = 0;
  Vector3 force_n = Vector3::Zero();
};

// A face of the body, its corners counter-clockwise seen from outside; the pressure pushes inwards and
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

// One coordinate of a node that is given.
struct HeldAxis {
  int node = 0;
  int axis = 0;  // 0 to 2: x, y, z
  double displacement_m = 0.0;
};

// All three coordinates of a node.
void hold_node(int node, const Vector3& displacement_m, std::vector<HeldAxis>& held);

// One owner; immutable. Made for a study, never in the tick.
class StaticBody {
 public:
  // Refused: materials outside their ranges, folded cells, springs below a Poisson's ratio of 1/4.
  static Result<StaticBody> make(const LatticeMesh& mesh, const LatticeMaterials& materials, CellKind kind);

  const LatticeMesh& mesh() const { return mesh_; }
  std::size_t cell_count() const { return cells_.size(); }
  // Corner by corner, as LatticeMesh::cell() counts them.
  const std::array<int, 8>& nodes_of(std::size_t cell) const { return cells_[cell].nodes; }
  CellResponse respond(std::size_t cell, const CellMoves& moves, Tangent tangent) const;
  double energy_j(std::size_t cell, const CellMoves& moves) const;
  double mass_kg(int node) const { return mass_[static_cast<std::size_t>(node)]; }

 private:
  struct Cell {
    std::array<int, 8> nodes{};
    std::variant<SpringCell, CorotatedCell> is;
  };

  LatticeMesh mesh_;
  std::vector<Cell> cells_;
  std::vector<double> mass_;
};

}  // namespace spoonbill
