// Blocks of mass points made of Bullet's soft bodies, like our lattices: count^3 nodes with links along
// edges, face diagonals and body diagonals. One face is fixed, and the block is shaken without any collision.
#pragma once

#include <memory>

namespace spoonbill {

// Returns the acceleration along y that shakes Bullet's blocks and ours at the given step.
inline float block_shaking_m_per_s2(int step) {
  return step / 16 % 2 == 0 ? -20.0f : 20.0f;
}

class BulletBlock {
 public:
  virtual ~BulletBlock() = default;
  virtual void step() = 0;
  virtual int link_count() const = 0;
  // Returns true if the block is still near its start. The time of a diverged block is meaningless.
  virtual bool sane() const = 0;
};

// Returns a block that uses position-based dynamics with one iteration per step.
std::unique_ptr<BulletBlock> bullet_position_based_block(int count);

// Returns a block that uses the explicit scheme of Bullet's deformable bodies, with spring and gravity
// forces.
std::unique_ptr<BulletBlock> bullet_explicit_block(int count);

}  // namespace spoonbill
