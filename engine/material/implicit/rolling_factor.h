// Cholesky factor of an implicit body's matrix, updated in parts over several ticks while the last complete
// factor is in use.
#pragma once

#include <vector>

#include "engine/base/containers.h"
#include "engine/base/geometry.h"
#include "engine/material/implicit/band_kernels.h"
#include "engine/material/implicit/cell_kernels.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Cells of a body in batches, layer by layer along the body.
struct CellBlock {
  std::vector<CellBatch> batches;
  std::vector<int> layers;  // index of the first batch of each layer; at the end the number of batches
  int layer_cells = 0;      // cells per layer; the last batch of a layer may have unused lanes
};

// Terms of the matrix inertia * M + stiffness * K in a frame, without the rows and columns of fixed
// coordinates.
struct MatrixParts {
  const CellBlock* cells;
  const double* mass;     // mass of each node, kg
  const double* free;     // for each coordinate: 1 if free, 0 if fixed
  Eigen::Matrix3d frame;  // rotation of the frame; the identity if a coordinate is fixed
  double inertia, stiffness;
};

// Returns the largest difference of node numbers within a cell; joined nodes (LatticeMesh::joined) count as
// one.
int node_reach(const LatticeMesh& mesh);

// Factor of the matrix that MatrixParts describes. Coordinates are 3 n + axis, and nodes are numbered along
// the body, so the matrix is a band matrix. Has one owner and allocates only at construction.
class RollingFactor {
 public:
  using Doubles = AlignedVector<double>;

  RollingFactor(const LatticeMesh& mesh, const BandKernels& kernels);
  RollingFactor(RollingFactor&&) = default;
  RollingFactor& operator=(RollingFactor&&) = default;
  RollingFactor(const RollingFactor& other);
  RollingFactor& operator=(const RollingFactor&) = delete;

  // Length of the vectors passed to solve(); they have zeros after the last coordinate.
  int padded_size() const;

  // Discards the factor: the next advance() factorises the whole matrix.
  void forget() { next_.stiffness = 0.0; }
  // Factorises the next part of the present matrix. When the new factor is complete, it replaces the one in
  // use. If the inertia or the stiffness has changed, as with the length of a step, factorises the whole
  // matrix: responses to contacts would otherwise be wrong.
  void advance(const MatrixParts& parts);
  // Sets `to` to A^-1 `from` with the matrix A of a few ticks ago; 0 at fixed coordinates. Both are in the
  // frame.
  void solve(const double* from, const double* free, double* to) const;

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Doubles& columns : columns_) visit(columns.data(), columns.size());
  }

 private:
  void begin(double inertia, double stiffness);
  void factorise_columns(const MatrixParts& parts, int count);
  void clear_slice(const MatrixParts& parts, int k);
  void add_layer(const MatrixParts& parts, int k);
  void add_cell(const MatrixParts& parts, const CellBatch& batch, int lane);

  const BandKernels* kernels_;
  int slice_columns_;  // number of columns of the nodes with one grid index k
  BandView used_;
  struct Next {
    BandView band;
    double inertia = 0.0, stiffness = 0.0;
    int layers = 0, columns = 0;  // layers added and columns factorised so far
  } next_;
  Doubles columns_[2];
};

}  // namespace spoonbill
