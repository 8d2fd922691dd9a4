// Bullet's soft bodies as blocks of mass points like our lattices: count^3 nodes, edges, face and body
// diagonals as links, one face held, shaken, without any collision.
#pragma once

#include <memory>

namespace spoonbill {

// The acceleration, along y, that shakes the blocks at that step: theirs and ours.
inline float block_shaking_m_per_s2(int step) {
  return step / 16 % 2 == 0 ? -20.0f : 20.0f;
}

class BulletBlock {
 public:
  virtual ~BulletBlock() = default;
  virtual void step() = 0;
  virtual int link_count() const = 0;
  // Whether the block is still about where it was: a diverged body costs another time.
  virtual bool sane() const = 0;
};

// Position-based dynamics, one iteration a step.
std::unique_ptr<BulletBlock> bullet_position_based_block(int count);

// The deformable body's explicit scheme with mass-spring and gravity forces.
std::unique_ptr<BulletBlock> bullet_explicit_block(int count);

}  // namespace spoonbill
