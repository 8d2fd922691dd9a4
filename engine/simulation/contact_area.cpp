#include "engine/simulation/contact_area.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/evaluate.h"
#include "engine/simulation/body_contact.h"

namespace spoonbill {
namespace {

constexpr double reach_cells = 0.02;

// Samples of a surface that contacts push. Samples at the same point, at a seam or a pole, count as one. A
// sample that bears no contacts is pushed as far as those around it are.
class PushedSamples {
 public:
  explicit PushedSamples(const BodyMapping& mapping)
      : mapping_(mapping),
        grid_(mapping.nested().grid),
        pushed_(static_cast<std::size_t>(grid_.rows()) * static_cast<std::size_t>(grid_.columns())) {}

  // Ignores points between samples, which have larger numbers.
  void add(int sample) {
    if (static_cast<std::size_t>(sample) < pushed_.size()) pushed_[twin(sample)] = 1;
  }

  void add_near_ground(const Ground& ground, double reach_m) {
    for (int i = 0; i < grid_.rows(); ++i) {
      for (int j = 0; j < grid_.columns(); ++j) {
        if (ground.normal.dot(point_m(i, j) - ground.point_m) < reach_m) add(i * grid_.columns() + j);
      }
    }
  }

  double area_m2() const {
    double sum = 0.0;
    for (int i = 0; i + 1 < grid_.rows(); ++i) {
      for (int j = 0; j + 1 < grid_.columns(); ++j) {
        const double corners = share(i, j) + share(i, j + 1) + share(i + 1, j) + share(i + 1, j + 1);
        if (corners > 0.0) sum += 0.25 * corners * patch_m2(i, j);
      }
    }
    return sum;
  }

 private:
  std::size_t twin(int sample) const {
    return static_cast<std::size_t>(mapping_.find_twin(sample / grid_.columns(), sample % grid_.columns()));
  }
  // Beside each skipped sample there are some that are not.
  double share(int row, int column) const {
    const SkippedSamples& skipped = mapping_.skipped();
    const int sample = row * grid_.columns() + column;
    const std::uint8_t is_pushed = pushed_[twin(sample)];
    if (is_pushed != 0 || !is_skipped(skipped, sample)) return is_pushed;
    int count = 0, pushed = 0;
    for (int i = std::max(0, row - 1); i <= std::min(grid_.rows() - 1, row + 1); ++i) {
      for (int j = std::max(0, column - 1); j <= std::min(grid_.columns() - 1, column + 1); ++j) {
        const int around = i * grid_.columns() + j;
        if (is_skipped(skipped, around)) continue;
        ++count;
        pushed += pushed_[twin(around)];
      }
    }
    return static_cast<double>(pushed) / count;
  }
  Vector3 point_m(int row, int column) const {
    return position(mapping_.current(), grid_.u.parameters[static_cast<std::size_t>(row)],
                    grid_.v.parameters[static_cast<std::size_t>(column)]);
  }
  double patch_m2(int row, int column) const {
    const Vector3 diagonal = point_m(row + 1, column + 1) - point_m(row, column);
    const Vector3 other = point_m(row + 1, column) - point_m(row, column + 1);
    return 0.5 * diagonal.cross(other).norm();
  }

  const BodyMapping& mapping_;
  const Grid& grid_;
  std::vector<std::uint8_t> pushed_;
};

// Vertices of a mesh that contacts push. Each counts a third of the area of its triangles.
class PushedVertices {
 public:
  explicit PushedVertices(const DeformingMesh& mesh) : mesh_(mesh), pushed_(mesh.vertices_m().size()) {}

  void add(int vertex) {
    if (static_cast<std::size_t>(vertex) < pushed_.size()) pushed_[static_cast<std::size_t>(vertex)] = 1;
  }

  void add_near_ground(const Ground& ground, double reach_m) {
    for (std::size_t v = 0; v < pushed_.size(); ++v) {
      if (ground.normal.dot(mesh_.vertices_m()[v] - ground.point_m) < reach_m) pushed_[v] = 1;
    }
  }

  double area_m2() const {
    double sum = 0.0;
    for (const TriangleCorners& corners : mesh_.triangles()) {
      const int count = pushed_[corners[0]] + pushed_[corners[1]] + pushed_[corners[2]];
      if (count == 0) continue;
      const Vector3& a = mesh_.vertices_m()[corners[0]];
      const Vector3 b = mesh_.vertices_m()[corners[1]] - a, c = mesh_.vertices_m()[corners[2]] - a;
      sum += count / 3.0 * 0.5 * b.cross(c).norm();
    }
    return sum;
  }

 private:
  const DeformingMesh& mesh_;
  std::vector<std::uint8_t> pushed_;
};

// Adds what the ground and tools push.
template <class Pushed>
void add_ground_and_tools(const Simulation::State& state, int body, double reach_m, Pushed& pushed) {
  const auto add = [&](int sample) { pushed.add(sample); };
  state.tool.contact.constraints().visit_pushed_samples(body, add);
  if (state.scene.symmetry.on) state.mirrored.contact.constraints().visit_pushed_samples(body, add);
  if (!state.pushes[static_cast<std::size_t>(body)].ground_impulse_ns.isZero(0.0)) {
    pushed.add_near_ground(*state.scene.ground, reach_m);
  }
}

// Returns the area of a body's own samples or vertices that are pushed, but not by bodies for which
// `is_passed_over` returns true.
template <class Pushed, class IsPassedOver>
double find_own_area_m2(const Simulation::State& state, int body, double reach_m, Pushed pushed,
                        const IsPassedOver& is_passed_over) {
  state.between.visit_pushed_samples(body, reach_m, [&](int sample, int other) {
    if (!is_passed_over(other)) pushed.add(sample);
  });
  add_ground_and_tools(state, body, reach_m, pushed);
  return pushed.area_m2();
}

// Returns the area of a rigid body with a soft one: that of the soft one's samples, which bear the blunt
// parts of the rigid one alone, or that of its own samples if it is larger.
double find_area_with_soft_m2(const Simulation::State& state, int rigid, int soft, double reach_m) {
  PushedSamples own(state.bodies[static_cast<std::size_t>(rigid)].mapping());
  PushedSamples bearing(state.bodies[static_cast<std::size_t>(soft)].mapping());
  state.between.visit_pushed_samples(rigid, reach_m, [&](int sample, int other) {
    if (other == soft) own.add(sample);
  });
  state.between.visit_pushed_samples(soft, reach_m, [&](int sample, int other) {
    if (other == rigid) bearing.add(sample);
  });
  return std::max(own.area_m2(), bearing.area_m2());
}

}  // namespace

double find_contact_area_m2(const Simulation::State& state, int body) {
  SPOONBILL_ASSERT(body >= 0 && body < static_cast<int>(state.scene.bodies.size()));
  const BodyState& own = state.bodies[static_cast<std::size_t>(body)];
  double cell_m = 0.0;
  for (const BodyState& each : state.stepped_bodies()) {
    if (!each.rigid) cell_m = std::max(cell_m, static_cast<double>(each.lattice.cell_size_m()));
  }
  if (cell_m == 0.0) cell_m = static_cast<double>(own.lattice.cell_size_m());
  const double reach_m = reach_cells * cell_m;
  if (const MeshMapping* const mesh = own.mesh()) {
    return find_own_area_m2(state, body, reach_m, PushedVertices(mesh->current()), [](int) { return false; });
  }
  const auto is_borne_by = [&](int other) {
    return own.rigid.has_value() && bears_blunt_bodies(state.bodies[static_cast<std::size_t>(other)]);
  };
  double sum_m2 = find_own_area_m2(state, body, reach_m, PushedSamples(own.mapping()), is_borne_by);
  for (int other = 0; other < static_cast<int>(state.bodies.size()); ++other) {
    if (is_borne_by(other)) sum_m2 += find_area_with_soft_m2(state, body, other, reach_m);
  }
  return sum_m2;
}

}  // namespace spoonbill
