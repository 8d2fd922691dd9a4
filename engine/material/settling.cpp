#include "engine/material/settling.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {

double settling_damping_per_s(double quotient) {
  return std::isfinite(quotient) ? 2.0 * settling_ratio * std::sqrt(std::max(0.0, quotient)) : 0.0;
}

double rayleigh_quotient(const SpringLattice& lattice, const LatticeView& view) {
  LatticeView along = view;
  along.power_x = view.moved_x;
  along.power_y = view.moved_y;
  along.power_z = view.moved_z;
  for (int n = 0; n < view.padded_count; ++n) {
    along.power_x[n] = view.vx[n] * view.free_node[n];
    along.power_y[n] = view.vy[n] * view.free_node[n];
    along.power_z[n] = view.vz[n] * view.free_node[n];
  }
  // w = M^-1 K v / |M^-1 K v|, and what was divided by.
  const double growth = static_cast<double>(lattice.kernels().power_step(along, lattice.free_mass()));
  double with_image = 0.0, of_motion = 0.0, of_image = 0.0;
  for (int n = 0; n < view.padded_count; ++n) {
    const double mass = static_cast<double>(lattice.free_mass()[n]);
    const Vector3 v(view.vx[n], view.vy[n], view.vz[n]);
    const Vector3 w(along.power_x[n], along.power_y[n], along.power_z[n]);
    with_image += mass * v.dot(w);
    of_motion += mass * v.squaredNorm();
    of_image += mass * w.squaredNorm();
  }
  const double sizes = std::sqrt(of_motion * of_image);
  return sizes > 0.0 ? growth * with_image / sizes : 0.0;
}

}  // namespace spoonbill
