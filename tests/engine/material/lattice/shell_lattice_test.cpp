// Tests lattices of thin shells against closed forms: volumes, plates, and rings under pressure.
#include "engine/material/lattice/shell_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "engine/material/implicit/implicit_body.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/statics/static_solver.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/lattice/shells.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

LatticeMesh make_shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request) {
  Result<LatticeMesh> mesh = shell_lattice(surface, thickness_m, request);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return std::move(mesh).value();
}

double mass_of(const LatticeMesh& mesh, double density_kg_per_m3) {
  const Material material = elastic_material(1e5, 0.3, density_kg_per_m3);
  return SpringLattice::make(mesh, material, InstructionSet::baseline).value().mass_kg();
}

Refusal shell_refusal(const Surface& surface, double thickness_m) {
  return Refusal(shell_lattice(surface, thickness_m, {}));
}

ErrorCode refusal_code(const Surface& surface, double thickness_m, const LatticeRequest& request = {}) {
  const Result<LatticeMesh> mesh = shell_lattice(surface, thickness_m, request);
  EXPECT_FALSE(mesh.ok());
  return mesh.ok() ? ErrorCode::internal : mesh.error().code;
}

TEST(ShellLattice, BowlHasTheVolumeOfTheShell) {
  constexpr double radius = 0.03, thickness = 0.002, opening = pi / 3.0, density = 2400.0;
  // The volume is that between the outer and the inner sphere, within the cone from the centre.
  const double inner = radius - thickness;
  const double volume =
      2.0 * pi / 3.0 * (1.0 - std::cos(opening)) * (std::pow(radius, 3) - std::pow(inner, 3));
  for (const bool pole_at_end : {false, true}) {
    const Surface bowl = spherical_bowl(radius, opening, pole_at_end);
    for (const int budget : {500, 2000, 8000}) {
      const LatticeMesh mesh = make_shell_lattice(bowl, thickness, {budget, {}});
      EXPECT_FALSE(mesh.closed);
      EXPECT_LE(mesh.node_count(), budget);
      EXPECT_GT(mesh.node_count(), budget / 2);
      // The surface is a sphere to 1e-5 of its radius, so its area is exact to 2e-5 of the area.
      EXPECT_NEAR(mass_of(mesh, density) / (density * volume), 1.0, 1e-4) << budget;
      const CellQuality quality = measure_cell_quality(mesh);
      EXPECT_GT(quality.worst_jacobian, 0.0) << budget;
      EXPECT_LT(quality.volume_spread, 0.5) << budget;
      for (int n = 0; n < mesh.node_count(); ++n) {
        const double depth = thickness * mesh.grid_index(n)[1] / (mesh.count[1] - 1);
        EXPECT_NEAR(mesh.nodes[static_cast<std::size_t>(n)].norm(), radius - depth, 2e-5 * radius);
      }
    }
  }
  // To first order, the volume is the area times the thickness; the relative error is thickness / radius.
  const double area = 2.0 * pi * radius * radius * (1.0 - std::cos(opening));
  EXPECT_NEAR(mass_of(make_shell_lattice(spherical_bowl(radius, opening), thickness, {}), density) /
                  (density * area * thickness),
              1.0, thickness / radius);
}

TEST(ShellLattice, CellsOfABudgetAreNearlyCubes) {
  const LatticeMesh mesh = make_shell_lattice(spherical_bowl(0.03, pi / 3.0), 0.002, {2000, {}});
  EXPECT_EQ(mesh.count[1], 2) << "one layer";
  const double pitch = 2.0 * 0.03 * pi / 3.0 / (mesh.count[0] - 1);
  EXPECT_NEAR(pitch / 0.002, 1.0, 0.35);
  EXPECT_GT(make_shell_lattice(spherical_bowl(0.03, pi / 3.0), 0.004, {8000, {}}).count[1], 2)
      << "more by budget";
  const LatticeMesh given = make_shell_lattice(flat_sheet(0.06, 0.04), 0.002, {2000, {{13, 4, 9}}});
  EXPECT_EQ(given.count, (std::array{13, 4, 9}));
}

TEST(ShellLattice, SheetIsABlockBehindItsNormals) {
  for (const bool up : {true, false}) {
    const LatticeMesh mesh = make_shell_lattice(flat_sheet(0.06, 0.04, up), 0.003, {2000, {}});
    EXPECT_NEAR(mass_of(mesh, 1000.0), 1000.0 * 0.06 * 0.04 * 0.003, 1e-12);
    for (int n = 0; n < mesh.node_count(); ++n) {
      const double depth = 0.003 * mesh.grid_index(n)[1] / (mesh.count[1] - 1);
      EXPECT_NEAR(mesh.nodes[static_cast<std::size_t>(n)].y(), up ? -depth : depth, 1e-12);
    }
    for (const double share : mesh.cell_fractions) EXPECT_NEAR(share, 1.0, 1e-9);
  }
}

TEST(ShellLattice, RingIsClosed) {
  constexpr double radius = 0.02, height = 0.015, thickness = 0.002;
  const double inner = radius - thickness, volume = pi * height * (radius * radius - inner * inner);
  for (const Surface& ring : {open_ring(radius, height), open_ring_around_v(radius, height)}) {
    const LatticeMesh mesh = make_shell_lattice(ring, thickness, {2000, {}});
    EXPECT_TRUE(mesh.closed);
    EXPECT_GT(mesh.count[0], 2 * mesh.count[2]) << "i runs around";
    EXPECT_NEAR(mass_of(mesh, 1000.0) / (1000.0 * volume), 1.0, 1e-4);
    int pairs = 0;
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.twin(n) == n) continue;
      ++pairs;
      EXPECT_EQ(mesh.twin(mesh.twin(n)), n);
      EXPECT_EQ(mesh.joined(n), mesh.joined(mesh.twin(n)));
      EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(n)], mesh.nodes[static_cast<std::size_t>(mesh.twin(n))]);
    }
    EXPECT_EQ(pairs, 2 * mesh.count[1] * mesh.count[2]);
  }
}

TEST(ShellLattice, RefusesWhatIsNoShell) {
  const Surface sheet = flat_sheet(0.06, 0.04), bowl = spherical_bowl(0.03, pi / 3.0);
  EXPECT_EQ(shell_refusal(sheet, -0.002).message, "shell_thickness_mm is -2, must be from 0.01 to 100");
  EXPECT_EQ(shell_refusal(sheet, 0.0), Refusal(ErrorCode::out_of_range, "shell_thickness_mm"));
  EXPECT_EQ(shell_refusal(sheet, std::nan("")), Refusal(ErrorCode::out_of_range, "shell_thickness_mm"));
  EXPECT_EQ(shell_refusal(sheet, std::numeric_limits<double>::infinity()),
            Refusal(ErrorCode::out_of_range, "shell_thickness_mm"));
  const Refusal thick = shell_refusal(bowl, 0.031);
  EXPECT_EQ(thick, Refusal(ErrorCode::self_intersecting, "shell_thickness_mm"));
  EXPECT_NE(thick.message.find("use less than 2"), std::string::npos) << thick;
  EXPECT_EQ(refusal_code(bowl, 0.09), ErrorCode::self_intersecting) << "beyond the centre too";
  EXPECT_EQ(shell_refusal(bowl, 0.02), Refusal());
  EXPECT_EQ(refusal_code(ellipsoid_tube(12, 12, {0, 0, 0}), 0.002), ErrorCode::unsupported);
  EXPECT_EQ(refusal_code(open_ring(0.02, 0.01), 0.002, {2000, {{3, 2, 4}}}), ErrorCode::out_of_range);
  EXPECT_EQ(refusal_code(sheet, 0.002, {2000, {{1, 2, 4}}}), ErrorCode::out_of_range);
  EXPECT_EQ(refusal_code(sheet, 0.002, {2000, {}, FeatureMapSettings{}}), ErrorCode::inconsistent);
  Surface fan = sheet;
  for (int j = 0; j < fan.net.columns; ++j) fan.net.set_point(0, j, fan.net.point(0, 0));
  EXPECT_EQ(refusal_code(fan, 0.002), ErrorCode::degenerate);
}

// Tests a plate that is fixed along one edge and bent to a cylinder. Under the force P, the free edge sinks
// by P L^3 (1 - nu^2) / 3 E I, where I is the second moment of area of the whole width. Shear adds
// (6/5) P L / G A.
TEST(ShellLattice, SheetBendsAsAPlate) {
  constexpr double length = 0.06, width = 0.03, thickness = 0.002, youngs = 2e9, poisson = 0.35, force = 0.5;
  const LatticeMesh mesh = make_shell_lattice(flat_sheet(length, width), thickness, {2000, {}});
  const StaticBody body =
      StaticBody::make(mesh, elastic_material(youngs, poisson, 1000.0), CellKind::hexahedra).value();
  std::vector<FixedAxis> held;
  StaticLoads loads;
  int loaded = 0;
  const auto is_at = [&](int n, double x) {
    return std::abs(mesh.nodes[static_cast<std::size_t>(n)].x() - x) < 1e-9;
  };
  for (int n = 0; n < mesh.node_count(); ++n) loaded += is_at(n, length) ? 1 : 0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (is_at(n, 0.0)) {
      fix_node(n, Vector3::Zero(), held);
      continue;
    }
    held.push_back({n, 2, 0.0});
    if (is_at(n, length)) loads.forces.push_back({n, Vector3(0.0, -force / loaded, 0.0)});
  }
  const StaticResult result = rest_under_load(body, loads, held).value();
  double sunk = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (is_at(n, length)) sunk -= result.displacement_m[static_cast<std::size_t>(n)].y() / loaded;
  }
  const double second_moment = width * std::pow(thickness, 3) / 12.0,
               shear = youngs / (2.0 * (1.0 + poisson));
  const double expected =
      force * std::pow(length, 3) * (1.0 - poisson * poisson) / (3.0 * youngs * second_moment) +
      1.2 * force * length / (shear * width * thickness);
  EXPECT_NEAR(sunk / expected, 1.0, 0.02);
}

// Returns a ring of 64 cells, whose seam is between two of them.
LatticeMesh round_ring(double radius_m, double height_m, double thickness_m) {
  return make_shell_lattice(open_ring(radius_m, height_m), thickness_m, {2000, {{65, 3, 4}}});
}

// Returns the radial displacements of the nodes on the outer face at half the height, positive outwards.
std::vector<double> gone_out(const LatticeMesh& mesh, const std::function<Vector3(int)>& moved) {
  std::vector<double> out;
  for (int i = 0; i < mesh.count[0]; ++i) {
    const int n = mesh.index(i, 0, 1);
    Vector3 radial = mesh.nodes[static_cast<std::size_t>(n)];
    radial.y() = 0.0;
    out.push_back(moved(n).dot(radial.normalized()));
  }
  return out;
}

// A pressure p inside a tube that is free to shorten displaces its outer side by
// u(b) = 2 p a^2 b / E (b^2 - a^2), where a and b are the inner and outer radius (Lame 1852). The supports
// bear no part of the pressure.
TEST(ShellLattice, RingUnderPressureHasNoSeam) {
  constexpr double outer = 0.02, thickness = 0.002, inner = outer - thickness, youngs = 1e9, pressure = 1e5;
  const LatticeMesh mesh = round_ring(outer, 0.006, thickness);
  const StaticBody body =
      StaticBody::make(mesh, elastic_material(youngs, 0.3, 1000.0), CellKind::hexahedra).value();
  StaticLoads loads;
  const int far = mesh.count[1] - 1;
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int k = 0; k + 1 < mesh.count[2]; ++k) {
      // The corners must run counter-clockwise as seen from the centre of the ring.
      PressedFace face{{mesh.index(i, far, k), mesh.index(i + 1, far, k), mesh.index(i + 1, far, k + 1),
                        mesh.index(i, far, k + 1)},
                       pressure};
      const Vector3 a = mesh.nodes[static_cast<std::size_t>(face.nodes[0])];
      const Vector3 along_i = mesh.nodes[static_cast<std::size_t>(face.nodes[1])] - a,
                    along_k = mesh.nodes[static_cast<std::size_t>(face.nodes[3])] - a;
      if (along_i.cross(along_k).dot(Vector3(a.x(), 0.0, a.z())) > 0.0) {
        std::swap(face.nodes[1], face.nodes[3]);
      }
      loads.pressures.push_back(face);
    }
  }
  std::vector<FixedAxis> held;
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) held.push_back({mesh.index(i, j, 0), 1, 0.0});
  }
  for (const int i : {16, 48}) held.push_back({mesh.index(i, 0, 0), 0, 0.0});
  held.push_back({mesh.index(0, 0, 0), 2, 0.0});
  const StaticResult result = rest_under_load(body, loads, held).value();
  const std::vector<double> out =
      gone_out(mesh, [&](int n) { return result.displacement_m[static_cast<std::size_t>(n)]; });
  const double expected = 2.0 * pressure * inner * inner * outer / (youngs * (outer * outer - inner * inner));
  for (const double here : out) {
    EXPECT_NEAR(here / out[5], 1.0, 1e-3) << "as round as the control net is";
    EXPECT_NEAR(here / expected, 1.0, 0.01);
  }
  EXPECT_EQ(out.front(), out.back());
}

// A force pulls the ring outwards at its seam, or a quarter of a turn from the seam; the opposite side is
// fixed. The ring must give way equally in both cases.
TEST(ShellLattice, RingDrawnAcrossItsSeamGivesWayAsElsewhere) {
  const LatticeMesh mesh = round_ring(0.02, 0.006, 0.002);
  const StaticBody body =
      StaticBody::make(mesh, elastic_material(1e9, 0.3, 1000.0), CellKind::hexahedra).value();
  const auto opened = [&](int at) {
    const int across = at + 32;
    std::vector<FixedAxis> held;
    for (int j = 0; j < mesh.count[1]; ++j) {
      for (int k = 0; k < mesh.count[2]; ++k) fix_node(mesh.index(across, j, k), Vector3::Zero(), held);
    }
    StaticLoads loads;
    Vector3 outward = mesh.nodes[static_cast<std::size_t>(mesh.index(at, 0, 0))];
    outward.y() = 0.0;
    loads.forces.push_back({mesh.index(at, 0, 2), 0.5 * outward.normalized()});
    const StaticResult result = rest_under_load(body, loads, held).value();
    return result.displacement_m[static_cast<std::size_t>(mesh.index(at, 0, 2))].dot(outward.normalized());
  };
  EXPECT_NEAR(opened(0) / opened(16), 1.0, 1e-3) << "as round as the control net is";
}

// A ring of springs that starts moving outward evenly stays round and keeps its total momentum of 0.
TEST(ShellLattice, SpringsOfARingKnowNoSeam) {
  const LatticeMesh mesh = round_ring(0.02, 0.006, 0.002);
  SpringLattice lattice =
      SpringLattice::make(mesh, elastic_material(1e5, 0.4, 1100.0), InstructionSet::baseline).value();
  double mass = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) mass += static_cast<double>(lattice.mass(n));
  EXPECT_NEAR(mass / lattice.mass_kg(), 1.0, 1e-5) << "nodes of the seam weigh once";
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Vector3& at = mesh.nodes[static_cast<std::size_t>(n)];
    lattice.set_velocity(n, 10.0 * Vector3(at.x(), 0.0, at.z()));
  }
  const auto h = static_cast<float>(0.5 / lattice.fastest_frequency());
  double farthest = 0.0;
  for (int step = 0; step < 400; ++step) {
    plain_substep(lattice, h);
    const std::vector<double> out = gone_out(mesh, [&](int n) { return lattice.displacement(n); });
    farthest = std::max(farthest, out.front());
    // Nodes at knots and nodes between knots oscillate slightly differently, so each node is compared only
    // with nodes of its own kind.
    for (std::size_t i = 2; i < out.size(); ++i) EXPECT_NEAR(out[i], out[i % 2], 1e-3 * 0.02 * 0.05) << step;
    EXPECT_EQ(out.front(), out.back());
  }
  EXPECT_GT(farthest, 1e-4);
  Vector3 momentum = Vector3::Zero();
  double sizes = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    momentum += static_cast<double>(lattice.mass(n)) * lattice.velocity(n);
    sizes += static_cast<double>(lattice.mass(n)) * lattice.velocity(n).norm();
  }
  EXPECT_LT(momentum.norm(), 1e-4 * sizes + 1e-9 * mass);
}

// The implicit method settles to the same displacement whether the ring is pushed at its seam or elsewhere.
TEST(ShellLattice, ImplicitRingKnowsNoSeam) {
  const LatticeMesh mesh = make_shell_lattice(open_ring(0.02, 0.006), 0.002, {2000, {{25, 2, 3}}});
  Material material = elastic_material(1e7, 0.3, 1000.0);
  material.damping_time_s = 1e-5;
  const auto pushed_in = [&](int at, bool at_twin) {
    ImplicitBody body = ImplicitBody::make(mesh, material, InstructionSet::baseline).value();
    std::vector<std::uint8_t> held(static_cast<std::size_t>(mesh.node_count()), 0);
    for (int n = 0; n < mesh.node_count(); ++n) {
      held[static_cast<std::size_t>(n)] = mesh.grid_index(n)[0] == at + 12 ? 1 : 0;
    }
    body.fix_nodes(held);
    const int node = mesh.index(at, 0, 1), pushed = at_twin ? mesh.twin(node) : node;
    Vector3 inward = -mesh.nodes[static_cast<std::size_t>(node)];
    inward.y() = 0.0;
    body.set_node_force(pushed, 0.05 * inward.normalized());
    ImplicitStep step;
    step.drag_per_s = 40.0;
    for (int tick = 0; tick < 600; ++tick) body.step(step);
    EXPECT_EQ(body.displacement(node), body.displacement(mesh.twin(node)));
    return body.displacement(node).dot(inward.normalized());
  };
  const double at_seam = pushed_in(0, false);
  EXPECT_GT(at_seam, 1e-5);
  EXPECT_EQ(pushed_in(0, true), at_seam);
  EXPECT_NEAR(pushed_in(6, false) / at_seam, 1.0, 1e-3) << "as round as the control net is";
}

}  // namespace
}  // namespace spoonbill
