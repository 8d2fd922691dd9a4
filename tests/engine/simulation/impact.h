// Provides two colliding bodies for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/processor.h"
#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_contact.h"

namespace spoonbill {

// Collision of two bodies without any other influence.
class Impact {
 public:
  // `slowed`: both bodies have one inertia scale, with which a substep of a millisecond is stable. Their
  // masses therefore keep their ratio. `real_time`: the inertia is not scaled, and a tick takes as many
  // substeps as both bodies need.
  enum class Clock { slowed, real_time };

  Impact(BodyState first, BodyState second, Clock clock = Clock::slowed)
      : bodies_{std::move(first), std::move(second)}, pair_(bodies_[0], bodies_[1]) {
    double step_s = settings_.time_s, scale = 1.0;
    for (BodyState& body : bodies_) {
      if (clock == Clock::real_time) {
        step_s = body.lattice.find_real_time_step_s(step_s);
      } else {
        scale = std::max(scale, body.lattice.find_inertia_scale(step_s));
      }
    }
    settings_.substeps = static_cast<int>(std::lround(settings_.time_s / step_s));
    for (BodyState& body : bodies_) body.set_inertia(scale, step_s);
    settings_.is_real_time = clock == Clock::real_time;
    contacts_.set_real_time(settings_.is_real_time);
  }

  void throw_at(int body, const Vector3& velocity) {
    SpringLattice& lattice = bodies_[body].lattice;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) lattice.set_velocity(n, velocity);
  }

  bool tick() {
    const DenormalsFlushed flushed;
    contacts_.clear(std::array<const SpringLattice*, 2>{&bodies_[0].lattice, &bodies_[1].lattice});
    EXPECT_TRUE(pair_.find({0, &bodies_[0]}, {1, &bodies_[1]}, settings_.time_s));
    EXPECT_TRUE(pair_.add_contacts({0, &bodies_[0]}, {1, &bodies_[1]}, contacts_));
    contacts_.begin(settings_.time_s);
    relax(std::array{RelaxedLattice{&bodies_[0].lattice}, RelaxedLattice{&bodies_[1].lattice}}, settings_, {},
          &contacts_);
    ++settings_.tick;
    for (BodyState& body : bodies_) body.update_skin();
    return contacts_.acted(0);
  }

  Vector3 momentum_of(int body, double* sum_of_sizes = nullptr) const {
    const SpringLattice& lattice = bodies_[body].lattice;
    Vector3 sum = Vector3::Zero();
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      const Vector3 each = static_cast<double>(lattice.mass(n)) * lattice.velocity(n);
      sum += each;
      if (sum_of_sizes) *sum_of_sizes += each.norm();
    }
    return sum;
  }

  const BodyState& body(int number) const { return bodies_[number]; }

 private:
  std::array<BodyState, 2> bodies_;
  BodyPairContact pair_;
  BodyContacts contacts_{8192};
  RelaxSettings settings_;
};

}  // namespace spoonbill
