#include "engine/material/cells/spring_cell.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// The gradient of cell_volume() by its corners.
CellVector volume_gradient(const CellCorners& p) {
  const Vector3 a = p[7] - p[4], b = p[3] - p[0], c = p[7] - p[2];
  const Vector3 d = p[6] - p[0], e = p[5] - p[0], f = p[7] - p[1];
  const Vector3 ab = a + b, ce = c + e, fd = f + d;
  const Vector3 by_a = c.cross(d) + e.cross(fd), by_b = c.cross(d) + ce.cross(f);
  const Vector3 by_c = d.cross(ab) + f.cross(b), by_d = ab.cross(c) + a.cross(e);
  const Vector3 by_e = f.cross(b) + fd.cross(a), by_f = b.cross(ce) + a.cross(e);
  CellVector gradient;
  gradient << -(by_b + by_d + by_e), -by_f, -by_c, by_b, -by_a, by_e, by_d, by_a + by_c + by_f;
  return gradient / 12.0;
}

// How that changes: it is linear in each single coordinate, so that differences are exact.
CellMatrix volume_hessian(const CellCorners& at, double size) {
  CellMatrix hessian;
  for (int n = 0; n < 24; ++n) {
    CellCorners up = at, down = at;
    up[static_cast<std::size_t>(n / 3)][n % 3] += size;
    down[static_cast<std::size_t>(n / 3)][n % 3] -= size;
    hessian.col(n) = (volume_gradient(up) - volume_gradient(down)) / (2.0 * size);
  }
  return hessian;
}

// From one end of a spring to the other.
Vector3 across(std::size_t spring, const std::array<Vector3, 8>& corners) {
  const auto [from, to] = cell_spring_corners[spring];
  return corners[static_cast<std::size_t>(to)] - corners[static_cast<std::size_t>(from)];
}

void add_spring(CellResponse& response, std::size_t spring, const Vector3& force,
                const Eigen::Matrix3d& tangent) {
  const auto [from, to] = cell_spring_corners[spring];
  response.force_n.segment<3>(3 * to) += force;
  response.force_n.segment<3>(3 * from) -= force;
  for (const int row : {from, to}) {
    for (const int column : {from, to}) {
      response.tangent.block<3, 3>(3 * row, 3 * column) += row == column ? tangent : -tangent;
    }
  }
}

}  // namespace

SpringCell::SpringCell(const CellCorners& rest, const CellSprings& springs, double bulk_stiffness_pa,
                       double share)
    : bulk_(share * bulk_stiffness_pa * springs.volume_m3), rest_volume_(springs.volume_m3) {
  SPOONBILL_ASSERT(share > 0.0);
  Vector3 middle = Vector3::Zero();
  for (const Vector3& corner : rest) middle += corner / 8.0;
  for (std::size_t c = 0; c < 8; ++c) rest_[c] = rest[c] - middle;
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    stiffness_[s] = share * springs.stiffness_n_per_m[s];
    rest_length_[s] = across(s, rest_).norm();
  }
}

CellCorners SpringCell::corners_of(const CellMoves& moves) const {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& move : moves) middle += move / 8.0;
  CellCorners corners;
  for (std::size_t c = 0; c < 8; ++c) corners[c] = rest_[c] + (moves[c] - middle);
  return corners;
}

// L - L0 = (|n + e|^2 - |n|^2) / (L + L0) for the rest vector n, in which a small e keeps its digits.
double SpringCell::extension_m(std::size_t spring, const CellMoves& moves) const {
  const Vector3 before = across(spring, rest_), more = across(spring, moves), now = before + more;
  return more.dot(before + now) / (now.norm() + rest_length_[spring]);
}

double SpringCell::energy_j(const CellMoves& moves) const {
  const double dilation = cell_volume(corners_of(moves)) / rest_volume_ - 1.0;
  double energy = 0.5 * bulk_ * dilation * dilation;
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    const double longer = extension_m(s, moves);
    energy += 0.5 * stiffness_[s] * longer * longer;
  }
  return energy;
}

CellResponse SpringCell::respond(const CellMoves& moves, Tangent tangent) const {
  const CellCorners now = corners_of(moves);
  CellResponse response;
  response.energy_j = energy_j(moves);
  const CellVector gradient = volume_gradient(now) / rest_volume_;
  const double pressure = bulk_ * (cell_volume(now) / rest_volume_ - 1.0);
  response.force_n = pressure * gradient;
  response.tangent = bulk_ * gradient * gradient.transpose();
  if (tangent == Tangent::stressed && pressure != 0.0) {
    response.tangent += pressure / rest_volume_ * volume_hessian(now, std::cbrt(rest_volume_));
  }
  for (std::size_t s = 0; s < cell_spring_count; ++s) {
    const Vector3 apart = across(s, now);
    const double length = apart.norm();
    if (!(length > 0.0)) continue;
    const Vector3 along = apart / length;
    const double pull = stiffness_[s] * extension_m(s, moves), turning = pull / length;
    const double held = tangent == Tangent::stressed ? turning : std::max(turning, 0.0);
    const Eigen::Matrix3d stiffness =
        held * Eigen::Matrix3d::Identity() + (stiffness_[s] - held) * along * along.transpose();
    add_spring(response, s, pull * along, stiffness);
  }
  return response;
}

}  // namespace spoonbill
