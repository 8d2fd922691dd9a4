// The block of jelly (jelly_block.h) as a deformable body of Bullet, made of tetrahedra between the same
// nodes, without any collision.
#pragma once

#include <memory>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// The defaults are the fastest settings that Bullet has for this block, and the force and the tetrahedra with
// the smallest error. Damping by the material would cost more.
struct BulletJellySettings {
  bool is_implicit = false;
  double step_s = 1e-4;
  double poissons_ratio = 0.49;
  double drag_per_s = 0.0;  // damping of all motion; costs nothing and does not change the state of rest
};

class BulletJelly {
 public:
  virtual ~BulletJelly() = default;
  virtual void step() = 0;
  // Returns the displacements of the nodes, m, in the order of jelly_nodes_m().
  virtual std::vector<Vector3> displacements_m() const = 0;
  virtual double largest_speed_m_per_s() const = 0;
};

std::unique_ptr<BulletJelly> make_bullet_jelly(const BulletJellySettings& settings);

}  // namespace spoonbill
