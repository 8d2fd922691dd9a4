#include "engine/material/lattice/body_skin.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/box_lattice.h"

namespace spoonbill {
namespace {

constexpr double edge_cells = 2.0 / 3.0;
constexpr std::size_t least_pieces = 8;

double shortest_edge_m(const LatticeMesh& box) {
  const CellCorners cell = box.cell(0, 0, 0);
  return std::min({(cell[4] - cell[0]).norm(), (cell[2] - cell[0]).norm(), (cell[1] - cell[0]).norm()});
}

// `step_m` tells how far the surface comes from one of them to another.
template <class StepOf>
std::vector<double> thinned(const std::vector<double>& parameters, double longest_m, const StepOf& step_m) {
  const std::size_t last = parameters.size() - 1, most = std::max<std::size_t>(last / least_pieces, 1);
  std::vector<double> kept = {parameters[0]};
  for (std::size_t from = 0, to = 1; to <= last; ++to) {
    const bool goes_on = to < last && to + 1 - from <= most && step_m(from, to + 1) <= longest_m;
    if (goes_on) continue;
    kept.push_back(parameters[to]);
    from = to;
  }
  return kept;
}

ClosedSkin coarse_skin(const Surface& surface, double longest_m) {
  const std::vector<double> u = skin_parameters(surface.u), v = skin_parameters(surface.v);
  std::vector<Vector3> samples;
  samples.reserve(u.size() * v.size());
  for (const double at_u : u) {
    for (const double at_v : v) samples.push_back(position(surface, at_u, at_v));
  }
  const auto displacement_m = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    return (samples[i * v.size() + j] - samples[k * v.size() + l]).norm();
  };
  const auto over_u = [&](std::size_t from, std::size_t to) {
    double longest = 0.0;
    for (std::size_t j = 0; j < v.size(); ++j) longest = std::max(longest, displacement_m(from, j, to, j));
    return longest;
  };
  const auto over_v = [&](std::size_t from, std::size_t to) {
    double longest = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) longest = std::max(longest, displacement_m(i, from, i, to));
    return longest;
  };
  return sample_skin(surface, thinned(u, longest_m, over_u), thinned(v, longest_m, over_v));
}

}  // namespace

BodySkin body_skin(const Surface& surface, const LatticeMesh& box,
                   const std::function<BodyCoordinates(double u, double v)>& place_at) {
  SPOONBILL_ASSERT(static_cast<bool>(place_at));
  const ClosedSkin coarse = coarse_skin(surface, edge_cells * shortest_edge_m(box));
  BodySkin skin;
  skin.triangles = coarse.mesh.triangles;
  skin.points.reserve(coarse.mesh.vertices_m.size());
  for (const Vector3& point : coarse.mesh.vertices_m) skin.points.push_back(point_in_box(box, point));
  skin.middles.reserve(coarse.triangle_centres.size());
  for (const auto& [u, v] : coarse.triangle_centres) skin.middles.push_back(place_at(u, v));
  return skin;
}

}  // namespace spoonbill
