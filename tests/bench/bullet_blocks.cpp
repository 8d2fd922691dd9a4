#include "tests/bench/bullet_blocks.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <vector>

namespace spoonbill {
namespace {

constexpr btScalar side_m = 0.1f, mass_kg = 1.0f, step_s = 1e-3f;

// The acceleration alternates between up and down, so that the block deforms all the time: Bullet spends less
// time on a block at rest.
btVector3 shaking(int step) {
  return {0, block_shaking_m_per_s2(step), 0};
}

// Links are added node by node, the usual order. If they were added direction by direction, fewer links would
// depend on the link before them: the position-based solver would take 0.7 times as long at 12^3 nodes, the
// explicit solver 1.8 times as long at 24^3.
void link_neighbours(btSoftBody& body, int count) {
  const auto index = [count](int i, int j, int k) { return (i * count + j) * count + k; };
  const auto inside = [count](int i) { return i >= 0 && i < count; };
  for (int node = 0; node < count * count * count; ++node) {
    const int i = node / (count * count), j = node / count % count, k = node % count;
    // Visits the second half of the 27 directions, so that each pair of nodes is linked once.
    for (int direction = 14; direction < 27; ++direction) {
      const int a = i + direction / 9 - 1, b = j + direction / 3 % 3 - 1, c = k + direction % 3 - 1;
      if (inside(a) && inside(b) && inside(c)) body.appendLink(node, index(a, b, c), body.m_materials[0]);
    }
  }
}

std::unique_ptr<btSoftBody> block_of(btSoftBodyWorldInfo& info, int count) {
  const btScalar spacing = side_m / static_cast<btScalar>(count - 1);
  std::vector<btVector3> nodes;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      for (int k = 0; k < count; ++k)
        nodes.emplace_back(spacing * btVector3(btScalar(i), btScalar(j), btScalar(k)));
    }
  }
  const std::vector<btScalar> masses(nodes.size(), mass_kg / static_cast<btScalar>(nodes.size()));
  auto body =
      std::make_unique<btSoftBody>(&info, static_cast<int>(nodes.size()), nodes.data(), masses.data());
  body->appendMaterial();
  link_neighbours(*body, count);
  for (int node = 0; node < count * count; ++node) body->setMass(node, 0);
  body->m_cfg.collisions = 0;
  body->m_cfg.piterations = 1;
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

bool within(const btSoftBody& body) {
  for (int node = 0; node < body.m_nodes.size(); ++node) {
    if (!(body.m_nodes[node].m_x.length() < 4 * side_m)) return false;
  }
  return true;
}

struct Broadphase {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase pairs;
};

class PositionBased : public BulletBlock {
 public:
  explicit PositionBased(int count) : body_(block_of(world_.getWorldInfo(), count)) {
    world_.addSoftBody(body_.get());
  }
  ~PositionBased() override { world_.removeSoftBody(body_.get()); }
  void step() override {
    world_.getWorldInfo().m_gravity = shaking(steps_++);
    world_.stepSimulation(step_s, 0);
  }
  int link_count() const override { return body_->m_links.size(); }
  bool sane() const override { return within(*body_); }

 private:
  Broadphase broadphase_;
  btSequentialImpulseConstraintSolver rigid_;
  btSoftRigidDynamicsWorld world_{&broadphase_.dispatcher, &broadphase_.pairs, &rigid_,
                                  &broadphase_.configuration};
  std::unique_ptr<btSoftBody> body_;
  int steps_ = 0;
};

// Returns a spring stiffness at which the fastest vibration is well within the stability limit of an explicit
// step.
btScalar stable_stiffness(int count) {
  const btScalar node_kg = mass_kg / std::pow(static_cast<btScalar>(count), 3.0f);
  return 0.01f * node_kg / (step_s * step_s);
}

class Explicit : public BulletBlock {
 public:
  explicit Explicit(int count)
      : spring_(stable_stiffness(count), 0.01f * step_s * stable_stiffness(count), true),
        body_(block_of(world_.getWorldInfo(), count)) {
    solver_.setDeformableSolver(&deformable_);
    world_.setImplicit(false);
    world_.addSoftBody(body_.get());
    world_.addForce(body_.get(), &spring_);
    world_.addForce(body_.get(), &weight_);
  }
  ~Explicit() override { world_.removeSoftBody(body_.get()); }
  void step() override {
    weight_.m_gravity = shaking(steps_++);
    world_.stepSimulation(step_s, 1, step_s);
  }
  int link_count() const override { return body_->m_links.size(); }
  bool sane() const override { return within(*body_); }

 private:
  Broadphase broadphase_;
  btDeformableBodySolver deformable_;
  btDeformableMultiBodyConstraintSolver solver_;
  btDeformableMultiBodyDynamicsWorld world_{&broadphase_.dispatcher, &broadphase_.pairs, &solver_,
                                            &broadphase_.configuration, &deformable_};
  btDeformableMassSpringForce spring_;
  btDeformableGravityForce weight_{shaking(0)};
  std::unique_ptr<btSoftBody> body_;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<BulletBlock> bullet_position_based_block(int count) {
  return std::make_unique<PositionBased>(count);
}

std::unique_ptr<BulletBlock> bullet_explicit_block(int count) {
  return std::make_unique<Explicit>(count);
}

}  // namespace spoonbill
