#include "engine/material/lattice/box_lattice.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Of the longest side: flatter boxes have cells that no spring holds open.
constexpr double least_thickness = 1e-4;
constexpr int samples_a_side = 5;

struct InCell {
  std::array<int, 3> cell;
  Vector3 local;  // 0 to 1 each
};

InCell locate(const LatticeMesh& box, const Vector3& point) {
  const Vector3 low = box.nodes.front(), size = box.nodes.back() - low;
  InCell in;
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = box.count[axis] - 1;
    const double along = (point[axis] - low[axis]) / size[axis] * cells;
    in.cell[axis] = std::clamp(static_cast<int>(std::floor(along)), 0, cells - 1);
    in.local[axis] = along - in.cell[axis];
  }
  return in;
}

double inside_share(const ShellDistance& solid, const CellCorners& corners) {
  const Vector3 middle = 0.5 * (corners[0] + corners[7]);
  const double at_middle = solid.at(middle).distance_m, reach = (middle - corners[0]).norm();
  if (std::abs(at_middle) >= reach) return at_middle < 0.0 ? 1.0 : 0.0;
  int within = 0;
  for (int s = 0; s < samples_a_side * samples_a_side * samples_a_side; ++s) {
    const auto share = [](int index) { return (index + 0.5) / samples_a_side; };
    const Vector3 point = trilinear(corners, share(s / (samples_a_side * samples_a_side)),
                                    share(s / samples_a_side % samples_a_side), share(s % samples_a_side));
    within += solid.at(point).distance_m < 0.0 ? 1 : 0;
  }
  return static_cast<double>(within) / (samples_a_side * samples_a_side * samples_a_side);
}

// Of the body are the corners of its cells; on the shell, those of void ones too, or of the box's sides.
void find_places(LatticeMesh& box) {
  box.places.assign(static_cast<std::size_t>(box.node_count()), NodePlace::beside_body);
  for (int n = 0; n < box.node_count(); ++n) {
    const std::array<int, 3> at = box.place(n);
    int cells = 0;
    for (int c = 0; c < 8; ++c) {
      const std::array<int, 3> cell = {at[0] - (c >> 2 & 1), at[1] - (c >> 1 & 1), at[2] - (c & 1)};
      bool exists = true;
      for (int axis = 0; axis < 3; ++axis) exists &= cell[axis] >= 0 && cell[axis] < box.count[axis] - 1;
      if (exists && box.is_filled(cell[0], cell[1], cell[2])) ++cells;
    }
    NodePlace& place = box.places[static_cast<std::size_t>(n)];
    if (cells > 0) place = cells == 8 ? NodePlace::in_body : NodePlace::on_shell;
  }
}

}  // namespace

Result<LatticeMesh> box_lattice(const ShellDistance& inside, double volume_m3,
                                std::span<const Vector3> skin_m, std::array<int, 3> counts) {
  SPOONBILL_ASSERT(volume_m3 > 0.0);
  SPOONBILL_ASSERT(counts[0] >= 2 && counts[1] >= 2 && counts[2] >= 2);
  const Box& bounds = inside.bounds();
  const Vector3 size = bounds.high - bounds.low;
  if (!(size.minCoeff() >= least_thickness * size.maxCoeff())) {
    return Error{"mesh: " + number_text(size.minCoeff() * 1e3) + " mm thick where it is " +
                 number_text(size.maxCoeff() * 1e3) +
                 " mm long: too flat for a lattice; make it at least a ten-thousandth as thick"};
  }
  LatticeMesh box = box_mesh(size, counts);
  for (Vector3& node : box.nodes) node += bounds.low;
  box.filled.assign(box.cell_count(), false);
  for (const Vector3& point : skin_m) {
    const auto [i, j, k] = locate(box, point).cell;
    box.filled[box.cell_index(i, j, k)] = true;
  }
  box.cell_shares.assign(box.cell_count(), void_share);
  double volume = 0.0;
  for (int k = 0; k + 1 < counts[2]; ++k) {
    for (int i = 0; i + 1 < counts[0]; ++i) {
      for (int j = 0; j + 1 < counts[1]; ++j) {
        const CellCorners corners = box.cell(i, j, k);
        const double share = inside_share(inside, corners);
        const std::size_t cell = box.cell_index(i, j, k);
        box.filled[cell] = box.filled[cell] || share > 0.0;
        if (box.filled[cell]) box.cell_shares[cell] = std::max(share, least_filled_share);
        volume += box.cell_shares[cell] * cell_volume(corners);
      }
    }
  }
  for (double& share : box.cell_shares) share *= volume_m3 / volume;
  find_places(box);
  return box;
}

CellPoint point_in_box(const LatticeMesh& box, const Vector3& point_m) {
  const auto [cell, local] = locate(box, point_m);
  CellPoint point;
  for (int c = 0; c < 8; ++c) {
    const std::array<int, 3> bit = {c >> 2 & 1, c >> 1 & 1, c & 1};
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= bit[axis] == 1 ? local[axis] : 1.0 - local[axis];
    point.nodes[c] = box.index(cell[0] + bit[0], cell[1] + bit[1], cell[2] + bit[2]);
    point.weights[c] = weight;
  }
  return point;
}

EmbeddedPoint embed_in_box(const LatticeMesh& box, const Vector3& point_m) {
  const CellPoint in_cell = point_in_box(box, point_m);
  EmbeddedPoint point;
  point.count = 8;
  for (int c = 0; c < 8; ++c) {
    point.node[c] = in_cell.nodes[c];
    point.weight[c] = static_cast<float>(in_cell.weights[c]);
  }
  return point;
}

}  // namespace spoonbill
