#include "tests/bench/bullet_jelly.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>

#include "engine/trial/trial.h"
#include "tests/bench/jelly_block.h"

namespace spoonbill {
namespace {

// Corners of a cell: bit 0 of a number adds 1 to i, bit 1 to j, bit 2 to k.
using Tetrahedron = std::array<int, 4>;
constexpr std::array<Tetrahedron, 5> tetrahedra{
    {{0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}}};

double six_volumes(const btSoftBody& body, const Tetrahedron& nodes) {
  const auto at = [&](std::size_t corner) { return body.m_nodes[nodes[corner]].m_x; };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0));
}

// `mirrored` exchanges the ends of the cell along i, so that faces of neighbouring cells agree.
void add_tetrahedron(btSoftBody& body, const std::array<int, 3>& cell, const Tetrahedron& corners,
                     bool mirrored) {
  Tetrahedron nodes{};
  for (std::size_t c = 0; c < 4; ++c) {
    const int corner = mirrored ? corners[c] ^ 1 : corners[c];
    nodes[c] = jelly_node_index(cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
  }
  if (six_volumes(body, nodes) < 0.0) std::swap(nodes[0], nodes[1]);
  body.appendTetra(nodes[0], nodes[1], nodes[2], nodes[3]);
}

void add_cells(btSoftBody& body) {
  for (int i = 0; i + 1 < jelly_counts[0]; ++i) {
    for (int j = 0; j + 1 < jelly_counts[1]; ++j) {
      for (int k = 0; k + 1 < jelly_counts[2]; ++k) {
        for (const Tetrahedron& corners : tetrahedra) {
          add_tetrahedron(body, {i, j, k}, corners, (i + j + k) % 2 == 1);
        }
      }
    }
  }
}

btVector3 to_bullet(const Vector3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

std::unique_ptr<btSoftBody> make_body(btSoftBodyWorldInfo& info) {
  std::vector<btVector3> nodes;
  for (const Vector3& node : jelly_nodes_m()) nodes.push_back(to_bullet(node));
  std::vector<btScalar> masses;
  for (const double mass : jelly_node_masses_kg()) masses.push_back(static_cast<btScalar>(mass));
  auto body =
      std::make_unique<btSoftBody>(&info, static_cast<int>(nodes.size()), nodes.data(), masses.data());
  add_cells(*body);
  for (int node = jelly_free_node_count(); node < body->m_nodes.size(); ++node) body->setMass(node, 0);
  body->initializeDmInverse();
  body->m_tetraScratches.resize(body->m_tetras.size());
  body->m_tetraScratchesTn.resize(body->m_tetras.size());
  body->m_cfg.collisions = 0;
  body->m_sleepingThreshold = 0;
  body->setActivationState(DISABLE_DEACTIVATION);
  return body;
}

// The weight of the nodes. Bullet's implicit scheme adds a force of type BT_GRAVITY_FORCE to the velocity of
// fixed nodes too, which then fall. A force of another type acts on free nodes only.
class Weight : public btDeformableGravityForce {
 public:
  using btDeformableGravityForce::btDeformableGravityForce;
  btDeformableLagrangianForceType getForceType() override { return BT_MASSSPRING_FORCE; }
};

struct Broadphase {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase pairs;
};

// Returns the force with the parameters with which its energy is that of linear elasticity at small strain
// (Smith et al. 2018).
btDeformableNeoHookeanForce make_force(double poissons_ratio) {
  const double shear = jelly_material().youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio));
  const double lame = 2.0 * shear * poissons_ratio / (1.0 - 2.0 * poissons_ratio);
  return {static_cast<btScalar>(4.0 / 3.0 * shear), static_cast<btScalar>(lame + 5.0 / 6.0 * shear), 0};
}

class Jelly : public BulletJelly {
 public:
  explicit Jelly(const BulletJellySettings& settings)
      : step_s_(static_cast<btScalar>(settings.step_s)),
        force_(make_force(settings.poissons_ratio)),
        body_(make_body(world_.getWorldInfo())) {
    solver_.setDeformableSolver(&deformable_);
    world_.setImplicit(settings.is_implicit);
    // The implicit scheme works only with projection, as in Bullet's examples. The explicit scheme is faster
    // without it.
    world_.setUseProjection(settings.is_implicit);
    world_.setGravity(weight_.m_gravity);
    world_.getWorldInfo().m_gravity = weight_.m_gravity;
    body_->m_cfg.drag = static_cast<btScalar>(settings.drag_per_s * settings.step_s);
    world_.addSoftBody(body_.get());
    world_.addForce(body_.get(), &force_);
    world_.addForce(body_.get(), &weight_);
  }
  ~Jelly() override { world_.removeSoftBody(body_.get()); }

  void step() override { world_.stepSimulation(step_s_, 1, step_s_); }

  std::vector<Vector3> displacements_m() const override {
    std::vector<Vector3> moved = jelly_nodes_m();
    for (int node = 0; node < body_->m_nodes.size(); ++node) {
      const btVector3& at = body_->m_nodes[node].m_x;
      Vector3& displacement = moved[static_cast<std::size_t>(node)];
      displacement = Vector3(at.x(), at.y(), at.z()) - displacement;
    }
    return moved;
  }

  double largest_speed_m_per_s() const override {
    double largest = 0.0;
    for (int node = 0; node < body_->m_nodes.size(); ++node) {
      largest = std::max(largest, static_cast<double>(body_->m_nodes[node].m_v.length()));
    }
    return largest;
  }

 private:
  btScalar step_s_;
  Broadphase broadphase_;
  btDeformableBodySolver deformable_;
  btDeformableMultiBodyConstraintSolver solver_;
  btDeformableMultiBodyDynamicsWorld world_{&broadphase_.dispatcher, &broadphase_.pairs, &solver_,
                                            &broadphase_.configuration, &deformable_};
  btDeformableNeoHookeanForce force_;
  Weight weight_{btVector3(0, -static_cast<btScalar>(standard_gravity_m_per_s2), 0)};
  std::unique_ptr<btSoftBody> body_;
};

}  // namespace

std::unique_ptr<BulletJelly> make_bullet_jelly(const BulletJellySettings& settings) {
  return std::make_unique<Jelly>(settings);
}

}  // namespace spoonbill
