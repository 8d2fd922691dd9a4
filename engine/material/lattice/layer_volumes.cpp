#include "engine/material/lattice/layer_volumes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/assert.h"
#include "engine/bspline/strip_volumes.h"

namespace spoonbill {
namespace {

constexpr double min_layer_factor = 0.5, max_layer_factor = 2.0;
// Number of straight steps that approximate the surface's curve along one outer edge of a slice.
constexpr int arc_steps = 16;

double tetrahedron_volume(const Vector3& a, const Vector3& b, const Vector3& c) {
  return a.dot(b.cross(c)) / 6.0;
}

// Returns the nodes around a slice, in the order of RingParameters::u.
std::vector<int> rim_nodes(const LatticeMesh& mesh, int k) {
  const int last_i = mesh.count[0] - 1, last_j = mesh.count[1] - 1;
  std::vector<int> nodes;
  for (int i = last_i; i > 0; --i) nodes.push_back(mesh.index(i, last_j, k));
  for (int j = last_j; j > 0; --j) nodes.push_back(mesh.index(0, j, k));
  for (int i = 0; i < last_i; ++i) nodes.push_back(mesh.index(i, 0, k));
  for (int j = 0; j < last_j; ++j) nodes.push_back(mesh.index(last_i, j, k));
  return nodes;
}

// Returns the volume between the apex and the cell faces of a slice. It is positive where the direction of
// increasing k points away from the apex.
double slice_volume(const LatticeMesh& mesh, int k, const Vector3& apex_m) {
  double volume = 0.0;
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      const auto corner = [&](int di, int dj) -> Vector3 {
        return mesh.nodes[static_cast<std::size_t>(mesh.index(i + di, j + dj, k))] - apex_m;
      };
      volume += quad_cone_volume(corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
    }
  }
  return volume;
}

// Returns the volume between the apex and the ribbon that joins the outer edges of slice k to the surface's
// curve at v.
double ribbon_volume(const Surface& surface, const RingParameters& ring, double v, const LatticeMesh& mesh,
                     int k, const Vector3& apex_m) {
  const std::vector<int> nodes = rim_nodes(mesh, k);
  SPOONBILL_ASSERT(nodes.size() == ring.u.size());
  double volume = 0.0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto node_m = [&](std::size_t at) -> Vector3 {
      return mesh.nodes[static_cast<std::size_t>(nodes[at % nodes.size()])] - apex_m;
    };
    const Vector3 from = node_m(n);
    Vector3 before = from;
    for (int step = 1; step <= arc_steps; ++step) {
      const double at = static_cast<double>(n) + static_cast<double>(step) / arc_steps;
      const Vector3 next = step == arc_steps
                               ? node_m(n + 1)
                               : position(surface, ring_parameter_at(surface, ring, at), v) - apex_m;
      volume += tetrahedron_volume(from, before, next);
      before = next;
    }
  }
  return volume;
}

void scale_layer(int k, double factor, LatticeMesh& mesh) {
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) mesh.cell_fractions[mesh.cell_index(i, j, k)] *= factor;
  }
}

}  // namespace

std::vector<double> layer_volumes_m3(const LatticeMesh& mesh) {
  std::vector<double> volumes;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    double volume = 0.0;
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        volume += mesh.cell_fraction(i, j, k) * cell_volume(mesh.cell(i, j, k));
      }
    }
    volumes.push_back(volume);
  }
  return volumes;
}

void scale_layers_to(std::span<const double> wanted_m3, LatticeMesh& mesh) {
  SPOONBILL_ASSERT(static_cast<int>(wanted_m3.size()) == mesh.count[2] - 1);
  const std::vector<double> now_m3 = layer_volumes_m3(mesh);
  const double wanted_sum = std::accumulate(wanted_m3.begin(), wanted_m3.end(), 0.0);
  const double now_sum = std::accumulate(now_m3.begin(), now_m3.end(), 0.0);
  SPOONBILL_ASSERT(now_sum > 0.0);
  // A surface that crosses itself may enclose no volume in total.
  if (!(wanted_sum > 0.0)) return;
  if (mesh.cell_fractions.empty()) mesh.cell_fractions.assign(mesh.cell_count(), 1.0);
  std::vector<double> factors;
  for (std::size_t k = 0; k < now_m3.size(); ++k) factors.push_back(wanted_m3[k] / now_m3[k]);
  const bool sensible = std::all_of(factors.begin(), factors.end(), [](double factor) {
    return factor >= min_layer_factor && factor <= max_layer_factor;
  });
  for (std::size_t k = 0; k < factors.size(); ++k) {
    scale_layer(static_cast<int>(k), sensible ? factors[k] : wanted_sum / now_sum, mesh);
  }
}

std::vector<double> redistribute_layers(std::span<const double> volumes_m3, int layers) {
  SPOONBILL_ASSERT(!volumes_m3.empty() && layers >= 1);
  const double thickness = static_cast<double>(volumes_m3.size()) / layers;
  std::vector<double> result(static_cast<std::size_t>(layers), 0.0);
  for (int layer = 0; layer < layers; ++layer) {
    const double low = layer * thickness, high = (layer + 1) * thickness;
    for (std::size_t k = 0; k < volumes_m3.size(); ++k) {
      const double at = static_cast<double>(k);
      const double overlap = std::min(at + 1.0, high) - std::max(at, low);
      if (overlap > 0.0) result[static_cast<std::size_t>(layer)] += overlap * volumes_m3[k];
    }
  }
  return result;
}

std::vector<double> tube_layer_volumes_m3(const Surface& surface, const TubeStations& stations,
                                          const LatticeMesh& mesh) {
  SPOONBILL_ASSERT(static_cast<int>(stations.v.size()) == mesh.count[2]);
  const Vector3 apex_m = surface.net.point(0, 0);
  std::vector<double> volumes = compute_strip_volumes_m3(surface, stations.v, apex_m);
  for (int k = 1; k + 1 < mesh.count[2]; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double below = slice_volume(mesh, k, apex_m) +
                         ribbon_volume(surface, stations.ring, stations.v[at], mesh, k, apex_m);
    volumes[at - 1] += below;
    volumes[at] -= below;
  }
  return volumes;
}

}  // namespace spoonbill
