// Tests the mapping residual, the distance by which a control net fails to follow its lattice, and the
// insertion of knots where this residual is largest.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "engine/bspline/reparameterise.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/simulation.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

struct Mapped {
  SpringLattice lattice;
  BodyMapping mapping;
};

Mapped mapped_handle() {
  const Simulation simulation = simulate(small_handle());
  const SpringLattice& of = simulation.lattice();
  SpringLattice lattice = SpringLattice::make(of.mesh(), of.material(), InstructionSet::baseline).value();
  BodyMapping mapping =
      BodyMapping::make(simulation.surface(), simulation.surface(), lattice, {}, InstructionSet::baseline)
          .value();
  return {std::move(lattice), std::move(mapping)};
}

MappingResidual residual_of(Mapped& body) {
  body.mapping.update(body.lattice);
  body.mapping.measure_residual();
  return body.mapping.residual();
}

// A control net follows any affine motion exactly (Piegl and Tiller 1997, 3.3: affine invariance).
TEST(MappingResidual, IsNothingForAffineMotions) {
  Mapped body = mapped_handle();
  Eigen::Matrix3d linear;
  linear << 0.02, 0.1, -0.03, 0.05, -0.01, 0.04, 0.0, 0.02, 0.03;
  for (int n = 0; n < body.lattice.mesh().node_count(); ++n) {
    body.lattice.set_displacement(n, linear * body.lattice.mesh().nodes[n] + Vector3(0.01, 0, 0));
  }
  // The tolerance covers movements of up to 1 cm in single precision.
  EXPECT_LT(residual_of(body).largest_m, 1e-7);
}

// The net follows the motion of a single node in part; the residual is at the node.
TEST(MappingResidual, IsWhereOneNodeMoves) {
  Mapped body = mapped_handle();
  const LatticeMesh& mesh = body.lattice.mesh();
  const int node = mesh.index(mesh.count[0] / 2, mesh.count[1] - 1, mesh.count[2] / 2);
  body.lattice.set_displacement(node, Vector3(0, 1e-3, 0));
  const MappingResidual residual = residual_of(body);
  EXPECT_GT(residual.largest_m, 5e-5);
  EXPECT_LT(residual.largest_m, 1e-3);
  EXPECT_LT(residual.root_mean_square_m, 0.3 * residual.largest_m);
  const Vector3 place = evaluate(body.mapping.rest(), residual.u, residual.v).position_m;
  EXPECT_LT((place - mesh.nodes[static_cast<std::size_t>(node)]).norm(), 2.0 * mesh.mean_edge());
}

void press_slowly(Simulation& simulation, double to_y_m, int ticks) {
  for (int t = 0; t <= ticks; ++t) {
    simulation.advance(above(0.03, 0.004 + (to_y_m - 0.004) * static_cast<double>(t) / ticks));
  }
}

Scene pointed_scene() {
  Scene scene = small_handle();
  scene.tool.kind = ToolKind::point;
  scene.tool.substeps = 1;
  return scene;
}

double shown_residual_m(Simulation& simulation) {
  for (int t = 0; t < 200; ++t) simulation.advance(above(0.03, 0.0015));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  return snapshot.bodies.front().residual.largest_m;
}

double largest_difference_in_place(const Surface& one, const Surface& other) {
  double largest = 0.0;
  for (int a = 0; a < 48; ++a) {
    for (int b = 0; b <= 60; ++b) {
      const double u = a / 48.0, v = 1e-3 * b;
      largest = std::max(largest, (evaluate(one, u, v).position_m - evaluate(other, u, v).position_m).norm());
    }
  }
  return largest;
}

TEST(RefineKnots, KeepsTheShape) {
  Simulation simulation = simulate(pointed_scene());
  for (int k = 1; k <= 3; ++k) {
    press_slowly(simulation, 0.0024 - 1e-4 * k, 100);
    const Surface before = simulation.surface();
    ASSERT_TRUE(simulation.apply(RefineKnots{}).ok());
    EXPECT_EQ(simulation.surface().net.rows, before.net.rows + 1);
    EXPECT_EQ(simulation.surface().net.columns, before.net.columns + 1);
    EXPECT_EQ(simulation.scene().bodies[0].surface.net.rows, before.net.rows + 1);
    // Displacements are in single precision.
    EXPECT_LT(largest_difference_in_place(simulation.surface(), before), 2e-9);
  }
}

TEST(RefineKnots, IsRefusedWhereNothingMoved) {
  Simulation simulation = simulate(small_handle());
  const Status refused = simulation.apply(RefineKnots{});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::inconsistent) << refused.error().message;
  EXPECT_FALSE(simulation.apply(RefineKnots{1}).ok());
}

// Returns a scene with a body of revolution as CAD delivers it, with one span from pole to pole.
Scene single_span_scene() {
  constexpr int around = 12;
  ControlNet net(around, 4);
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j < 4; ++j) {
      const double radius = j == 0 || j == 3 ? 0.0 : 0.02;
      net.set_point(i, j, {0.02 * (j > 1), -radius * std::sin(angle), radius * std::cos(angle)});
    }
  }
  Scene scene = small_handle();
  scene.bodies[0].surface = make_surface(KnotVector::periodic_uniform(3, around).value(),
                                         KnotVector::clamped_uniform(3, 4).value(), net)
                                .value();
  return scene;
}

TEST(BodyMapping, FollowsOneSpanFromPoleToPole) {
  Simulation simulation = simulate(single_span_scene());
  for (int tick = 0; tick < 300; ++tick) simulation.advance(above(0.01, 0.024 - 3e-5 * tick));
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  EXPECT_GT(position(single_span_scene().bodies[0].surface, 0.75, 0.5).y() -
                position(simulation.surface(), 0.75, 0.5).y(),
            1e-4);
}

// With knots of full multiplicity, each span adds as many control points as the degree.
TEST(BodyMapping, FollowsKnotsOfEveryMultiplicity) {
  Scene scene = small_handle();
  Surface& surface = scene.bodies[0].surface;
  const std::vector<double> u = surface.u.breakpoints(), v = surface.v.breakpoints();
  for (std::size_t k = 1; k + 1 < v.size(); ++k) {
    surface = insert_knot(surface, Direction::v, v[k], 3).value();
  }
  for (std::size_t k = 1; k + 1 < u.size(); ++k) {
    surface = insert_knot(surface, Direction::u, u[k], 1 + static_cast<int>(k) % 3).value();
  }
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.03, 0.012 - 4e-5 * tick));
  EXPECT_GT(largest_difference_in_place(simulation.surface(), surface), 1e-4);
  EXPECT_LT(shown_residual_m(simulation), 1e-3);
}

// A fixing plane needs knots at its edge. A document can have at most 200 columns of control points. If new
// knots would make more columns, columns are fixed without knots.
TEST(BodyMapping, HoldsWithoutMoreColumnsThanADocumentTakes) {
  for (const int columns : {190, 198, 199, 200}) {
    SCOPED_TRACE(columns);
    Scene scene = small_handle();
    Surface& surface = scene.bodies[0].surface;
    for (int k = 1; surface.v.control_point_count() < columns; ++k) {
      surface = insert_knot(surface, Direction::v, 0.06 * (0.11 + 0.0041 * k), 1).value();
    }
    scene.planes.push_back({Vector3(0.0213, 0, 0), Vector3::UnitX()});
    Simulation simulation = simulate(scene);
    EXPECT_LE(simulation.surface().v.control_point_count(), sculpted_control_point_count_range.high);
    for (int tick = 0; tick < 200; ++tick) simulation.advance(above(0.05, 0.012 - 5e-5 * tick));
    const auto moved = [&](double v) {
      const double u = surface.u.domain_start();
      return (position(simulation.surface(), u, v) - position(surface, u, v)).norm();
    };
    EXPECT_GT(moved(0.05), 1e-4);
    for (const double v : {0.002, 0.01, 0.015}) EXPECT_LT(moved(v), 1e-7) << v;
  }
}

// The displacements from before the knots were inserted show afterwards, without a further stroke, and
// not at once.
TEST(RefineKnots, ShowsWhatTheSurfaceHadNotFollowed) {
  Simulation simulation = simulate(pointed_scene());
  press_slowly(simulation, 0.0012, 300);
  for (int t = 0; t < 2000; ++t) simulation.advance(far_away);
  double behind_m = 0.0, first_behind_m = 0.0;
  for (int k = 0; k < 4; ++k) {
    Snapshot before, after;
    simulation.write_snapshot(before);
    const Surface shape = simulation.surface();
    ASSERT_TRUE(simulation.apply(RefineKnots{0, Range<double>{0.6, 0.9}, Range<double>{0.02, 0.04}}).ok());
    Surface last = simulation.surface();
    EXPECT_LT(largest_difference_in_place(last, shape), 2e-9);
    for (int t = 0; t < catch_up_ticks; ++t) {
      simulation.advance(far_away);
      // The surface moves by about the same amount in each tick.
      EXPECT_LT(largest_difference_in_place(simulation.surface(), last),
                2.0 * before.bodies[0].residual.largest_m / catch_up_ticks + 2e-9);
      last = simulation.surface();
    }
    for (int t = 0; t < 128; ++t) simulation.advance(far_away);
    simulation.write_snapshot(after);
    behind_m = after.bodies[0].residual.largest_m;
    if (k == 0) first_behind_m = before.bodies[0].residual.largest_m;
  }
  EXPECT_LT(behind_m, 0.4 * first_behind_m);
}

// The simulation asks for knots until the surface is within the tolerance, which depends on the cells here.
TEST(RefineKnots, IsWantedUntilTheSurfaceFollows) {
  Simulation simulation = simulate(pointed_scene());
  press_slowly(simulation, 0.0005, 400);
  int refinements = 0;
  for (int t = 0; t < 4000; ++t) {
    simulation.advance(far_away);
    if (!simulation.wanted_refinement()) continue;
    ASSERT_TRUE(simulation.apply(*simulation.wanted_refinement()).ok());
    ++refinements;
  }
  EXPECT_GT(refinements, 0);
  EXPECT_FALSE(simulation.wanted_refinement());
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  const double cell_m = static_cast<double>(simulation.lattice().cell_size_m());
  EXPECT_LT(snapshot.bodies[0].residual.largest_m, std::max(5e-5, 0.1 * cell_m));
}

// A hand that holds still feels no refinement: the force changes by no more than without one.
TEST(RefineKnots, IsNotFelt) {
  const auto largest_change_n = [](bool refines, int first_tick) {
    Scene scene = small_handle();
    scene.planes = {{Vector3(0.012, 0, 0), Vector3::UnitX()}};
    Simulation simulation = simulate(scene);
    double last_n = 0.0, largest_n = 0.0;
    for (int t = 0; t < 900; ++t) {
      const double height_m = 0.0095 - 0.003 * std::min(1.0, t / 500.0);
      const double force_n = simulation.advance(above(0.03, height_m)).force_n.norm();
      if (t >= first_tick) largest_n = std::max(largest_n, std::abs(force_n - last_n));
      last_n = force_n;
      if (!refines || t != 700) continue;
      EXPECT_TRUE(simulation.apply(RefineKnots{0, Range<double>{0.6, 0.9}, Range<double>{0.02, 0.04}}).ok());
    }
    EXPECT_GT(last_n, 1e-3);
    return largest_n;
  };
  EXPECT_LT(largest_change_n(true, 695), std::max(1.1 * largest_change_n(false, 100), 1e-4));
}

}  // namespace
}  // namespace spoonbill
