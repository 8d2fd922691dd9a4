// The Cholesky factor of a body's matrix, taken a piece each tick while the last one is used.
#pragma once

#include <vector>

#include "engine/base/containers.h"
#include "engine/material/implicit/band_kernels.h"
#include "engine/material/implicit/cell_kernels.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// The cells of a body in batches, layer by layer along it.
struct CellBlock {
  std::vector<CellBatch> batches;
  std::vector<int> layers;  // the first batch of each layer, and the end
  int layer_cells = 0;      // of each layer: the last batch may have lanes to spare
};

// What the matrix is made of: inertia * M + stiffness * K, with rows and columns of held coordinates left
// out.
struct MatrixParts {
  const CellBlock* cells;
  const double* mass;  // by node, kg
  const double* free;  // by coordinate: 1, or 0 where held
  double inertia, stiffness;
};

// How far apart two nodes of a cell can be counted, nodes of a place (LatticeMesh::joined) as one.
int node_reach(const LatticeMesh& mesh);

// Its coordinates are 3 n + axis, and nodes are counted along the body: the matrix is a band. One owner;
// allocates only when made.
class RollingFactor {
 public:
  using Doubles = AlignedVector<double>;

  RollingFactor(const LatticeMesh& mesh, const BandKernels& kernels);
  RollingFactor(RollingFactor&&) = default;
  RollingFactor& operator=(RollingFactor&&) = default;
  RollingFactor(const RollingFactor&) = delete;
  RollingFactor& operator=(const RollingFactor&) = delete;

  // How long vectors must be: zeros after the last coordinate.
  int padded_size() const;

  // The matrix has changed altogether: the next piece is all of it.
  void forget() { next_.stiffness = 0.0; }
  // Takes a piece of the factor of the matrix as it is now; done, it is used from then on.
  void take_piece(const MatrixParts& parts);
  // to = A^-1 from, A of some ticks ago; 0 at held coordinates.
  void solve(const double* from, const double* free, double* to) const;

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Doubles& columns : columns_) visit(columns.data(), columns.size());
  }

 private:
  void begin(double inertia, double stiffness);
  void take_columns(const MatrixParts& parts, int count);
  void clear_slice(const MatrixParts& parts, int k);
  void add_layer(const MatrixParts& parts, int k);
  void add_cell(const MatrixParts& parts, const CellBatch& batch, int lane);

  const BandKernels* kernels_;
  int slice_columns_;  // of the nodes at one k
  BandView used_;
  struct Next {
    BandView band;
    double inertia = 0.0, stiffness = 0.0;
    int layers = 0, columns = 0;  // done
  } next_;
  Doubles columns_[2];
};

}  // namespace spoonbill
