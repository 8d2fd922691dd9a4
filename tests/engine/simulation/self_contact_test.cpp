// Tests that soft bodies bent onto themselves do not pass through themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/processor.h"
#include "engine/collision/surfaces/surface_self_collider.h"
#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_contact.h"
#include "tests/engine/allocations.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

constexpr double arm_m = 0.04, bend_radius_m = 0.005, arm_thick_m = 0.006;
// Gap between the surfaces of the hairpin's two arms.
constexpr double bend_gap_m = 2.0 * bend_radius_m - arm_thick_m;

struct Station {
  Vector3 centre, along;
};

// Returns a point of the centre line of a hairpin in the x-y plane: an arm at y = -bend_radius_m towards
// x = 0, half a circle about the origin, and an arm back at y = bend_radius_m.
Station hairpin_station(double way) {
  const double turn = std::clamp((way - arm_m) / bend_radius_m, 0.0, std::numbers::pi);
  const double beyond = std::max(arm_m - way, way - arm_m - std::numbers::pi * bend_radius_m);
  const double angle = -0.5 * std::numbers::pi - turn;
  return {{bend_radius_m * std::cos(angle) + std::max(beyond, 0.0), bend_radius_m * std::sin(angle), 0.0},
          {std::sin(angle), -std::cos(angle), 0.0}};
}

// Returns a round bar along the centre line, with poles at its ends.
Body hairpin() {
  constexpr int around = 12, along = 33;
  constexpr double length = 2.0 * arm_m + std::numbers::pi * bend_radius_m;
  ControlNet net(around, along);
  for (int j = 0; j < along; ++j) {
    const Station at = hairpin_station(length * std::clamp((j - 1.0) / (along - 3.0), 0.0, 1.0));
    const double radius = j == 0 || j == along - 1 ? 0.0 : 0.5 * arm_thick_m;
    const Vector3 side = at.along.cross(Vector3::UnitZ());
    for (int i = 0; i < around; ++i) {
      const double angle = -2.0 * std::numbers::pi * i / around;
      net.set_point(i, j, at.centre + radius * (std::cos(angle) * side + std::sin(angle) * Vector3::UnitZ()));
    }
  }
  return {"hairpin",
          make_surface(KnotVector::periodic_uniform(3, around).value(),
                       KnotVector::clamped_uniform(3, along).value(), net)
              .value(),
          silicone(),
          {400, {}}};
}

double depth_in_itself(const Surface& surface, bool* touching = nullptr) {
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
  SurfaceSelfCollider collider(nested);
  const SelfResult result = collider.collide(surface, {true});
  EXPECT_FALSE(result.overflow);
  if (touching) *touching = result.touching;
  double deepest = 0.0;
  for (const PairContact& contact : collider.contacts()) deepest = std::max(deepest, contact.depth_m);
  return deepest;
}

// A free body, with or without self-contact, whose ends are pulled or thrown.
class Folding {
 public:
  Folding(const Body& body, bool is_self_intersecting)
      : body_(make_body_state(body, {}, InstructionSet::baseline).value()),
        self_(body_),
        meets_itself_(is_self_intersecting) {
    const double step_s = RelaxSettings().time_s;
    body_.set_inertia(body_.lattice.find_inertia_scale(step_s), step_s);
  }

  // Pulls both ends together by opposite forces along y, slowly because of strong drag. The forces grow with
  // the inertia, so that the ends always meet after the same time.
  void pull_ends_together(double force_per_inertia_n) {
    drag_per_s_ = 300.0;
    const double force_n = force_per_inertia_n * body_.lattice.inertia_scale();
    visit_ends([&](int node, double side, int nodes) {
      body_.lattice.set_node_force(node, Vector3(0, side * force_n / nodes, 0));
    });
  }

  void throw_ends(const Vector3& velocity) {
    visit_ends([&](int node, double side, int) { body_.lattice.set_velocity(node, side * velocity); });
  }

  bool tick() {
    const DenormalsFlushed flushed;
    contacts_.clear(std::array<const SpringLattice*, 1>{&body_.lattice});
    EXPECT_TRUE(!meets_itself_ || self_.add_contacts({0, &body_}, contacts_));
    contacts_.begin(tick_s);
    relax(std::array{RelaxedLattice{&body_.lattice}}, {tick_++, 1, 1e-3, drag_per_s_}, {}, &contacts_);
    body_.mapping().update(body_.lattice);
    return contacts_.acted(0);
  }

  struct Momentum {
    Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
    double linear_sizes = 0.0, angular_sizes = 0.0;
  };
  Momentum momentum() const {
    Momentum sum;
    const SpringLattice& lattice = body_.lattice;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      const Vector3 each = static_cast<double>(lattice.mass(n)) * lattice.velocity(n);
      const Vector3 turning = lattice.position(n).cross(each);
      sum.linear += each;
      sum.angular += turning;
      sum.linear_sizes += each.norm();
      sum.angular_sizes += turning.norm();
    }
    return sum;
  }

  double cell_m() const { return static_cast<double>(body_.lattice.cell_size_m()); }
  double depth_m(bool* touching = nullptr) const {
    return depth_in_itself(body_.mapping().current(), touching);
  }

 private:
  // The first fifth of the body is pulled along +y, the last fifth along -y.
  template <class Visit>
  void visit_ends(const Visit& visit) {
    const LatticeMesh& mesh = body_.lattice.mesh();
    const int count = mesh.node_count(), nodes = mesh.count[0] * mesh.count[1] * (mesh.count[2] / 5);
    for (int n = 0; n < nodes; ++n) {
      visit(n, 1.0, nodes);
      visit(count - 1 - n, -1.0, nodes);
    }
  }

  BodyState body_;
  BodySelfContact self_;
  BodyContacts contacts_{8192};
  bool meets_itself_;
  double drag_per_s_ = 0.0;
  std::uint64_t tick_ = 0;
};

constexpr double pull_n = 0.002;
constexpr int ticks_to_meet = 500;

TEST(SelfContact, WithoutItTheArmsOfAHairpinPassThroughEachOther) {
  Folding bar(hairpin(), false);
  EXPECT_EQ(bar.depth_m(), 0.0);
  bar.pull_ends_together(pull_n);
  double deepest = 0.0;
  for (int tick = 0; tick < ticks_to_meet; ++tick) {
    bar.tick();
    if (tick % 10 == 0) deepest = std::max(deepest, bar.depth_m());
  }
  EXPECT_GT(deepest, bar.cell_m());
}

TEST(SelfContact, HoldsTheArmsOfAHairpinApart) {
  Folding bar(hairpin(), true);
  bar.pull_ends_together(pull_n);
  double deepest = 0.0;
  int touching = 0;
  for (int tick = 0; tick < ticks_to_meet; ++tick) {
    touching += bar.tick() ? 1 : 0;
    if (tick % 10 == 0) deepest = std::max(deepest, bar.depth_m());
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(deepest, body_depth_limit_cells * bar.cell_m());
}

// Only the contact acts on the body. Its ends collide and separate again.
TEST(SelfContact, KeepsTheMomentum) {
  Folding bar(hairpin(), true);
  bar.throw_ends({0.0, 0.05, 0.01});
  const Folding::Momentum before = bar.momentum();
  int touching = 0;
  for (int tick = 0; tick < 200; ++tick) touching += bar.tick() ? 1 : 0;
  EXPECT_GT(touching, 10);
  const Folding::Momentum after = bar.momentum();
  // The tolerance of the linear momentum covers velocities in single precision.
  EXPECT_LT((after.linear - before.linear).norm(), 1e-5 * before.linear_sizes);
  EXPECT_LT((after.angular - before.angular).norm(), 1e-2 * before.angular_sizes);
}

// Returns a simulation of a hairpin. The lower half of its lower arm is fixed; a sphere tool can push the
// upper arm onto the lower one.
Simulation pushed_hairpin() {
  Scene scene = small_handle();
  scene.bodies[0] = hairpin();
  scene.planes.push_back({Vector3(0, -bend_radius_m, 0), Vector3::UnitY()});
  return simulate(scene);
}

TEST(SelfContact, PassesAPushOnWithinOneBody) {
  Simulation simulation = pushed_hairpin();
  const double cell = static_cast<double>(simulation.lattice().cell_size_m());
  double deepest = 0.0, before = 0.0, after = 0.0;
  std::size_t allocations = 0;
  for (int tick = 0; tick < 600; ++tick) {
    const std::size_t allocated = allocation_count();
    const Reaction reaction = simulation.advance(above(0.03, 0.0145 - 1e-5 * tick));
    allocations += allocation_count() - allocated;
    ASSERT_TRUE(reaction.force_n.allFinite());
    EXPECT_EQ(reaction.flags & tick_flag_contact_overflow, 0u);
    double& strongest = 1e-5 * tick < bend_gap_m ? before : after;
    strongest = std::max(strongest, reaction.force_n.norm());
    if (tick % 20 == 0) deepest = std::max(deepest, depth_in_itself(simulation.surface()));
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(before, 0.0);
  EXPECT_GT(after, 10.0 * before) << "the held lower arm stops it, not the bend alone";
  EXPECT_LT(deepest, body_depth_limit_cells * cell);
}

}  // namespace
}  // namespace spoonbill
