#include "engine/simulation/sampled_ground_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "engine/base/assert.h"
#include "engine/simulation/ground_contact.h"

namespace spoonbill {
namespace {

bool is_in_box(const BodyState& body) {
  return !body.rigid && !body.mesh() && is_boxed(body.lattice.mesh());
}

// Returns the samples of a body's mapping, but only one in each eighth of a cell: the one farthest from the
// centre of the box, so that tips are kept. A finer sampling would only cost time.
std::vector<int> choose_samples(const BodyState& body) {
  const LatticeMesh& mesh = body.lattice.mesh();
  const Vector3 low = mesh.nodes.front(), size = mesh.nodes.back() - low, centre = low + 0.5 * size;
  struct Chosen {
    int sample;
    double distance_m;
  };
  std::map<std::array<int, 3>, Chosen> chosen;
  const Grid& grid = body.mapping().nested().grid;
  for (int s = 0; s < grid.rows() * grid.columns(); ++s) {
    const Vector3 at_m = body.mapping().sample(s).rest_m(body.lattice);
    std::array<int, 3> key{};
    for (int axis = 0; axis < 3; ++axis) {
      const int halves = 2 * (mesh.count[static_cast<std::size_t>(axis)] - 1);
      key[static_cast<std::size_t>(axis)] =
          static_cast<int>(std::floor((at_m[axis] - low[axis]) / size[axis] * halves));
    }
    const double distance_m = (at_m - centre).norm();
    const auto [found, is_new] = chosen.try_emplace(key, Chosen{s, distance_m});
    if (!is_new && distance_m > found->second.distance_m) found->second = {s, distance_m};
  }
  std::vector<int> samples;
  for (const auto& [key, each] : chosen) samples.push_back(each.sample);
  std::sort(samples.begin(), samples.end());
  return samples;
}

}  // namespace

bool has_sampled_ground_contact(const BodyState& body, bool is_real_time) {
  return is_real_time && !body.implicit_solver && is_in_box(body);
}

SampledGroundContact::SampledGroundContact(const BodyState& body) {
  if (!is_in_box(body)) return;
  samples_ = choose_samples(body);
  heights_m_.assign(static_cast<std::size_t>(body.lattice.mesh().node_count()), 0.0f);
}

bool SampledGroundContact::add_contacts(const IndexedBody& body, const Ground& ground,
                                        const Vector3& gravity_m_per_s2, double time_s,
                                        BodyContacts& contacts) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  const BodyState& state = *body.state;
  SPOONBILL_ASSERT_DEBUG(heights_m_.size() == static_cast<std::size_t>(state.lattice.mesh().node_count()));
  const double margin_m = find_ground_margin_m(state, gravity_m_per_s2, time_s);
  float lowest_m = static_cast<float>(infinity);
  for (std::size_t n = 0; n < heights_m_.size(); ++n) {
    const Vector3 position_m = state.lattice.position(static_cast<int>(n));
    heights_m_[n] = static_cast<float>(ground.normal.dot(position_m - ground.point_m));
    lowest_m = std::min(lowest_m, heights_m_[n]);
  }
  if (!(static_cast<double>(lowest_m) <= margin_m)) return true;
  bool complete = true;
  for (const int s : samples_) {
    const EmbeddedPoint& sample = state.mapping().sample(s);
    double height_m = 0.0;
    for (int i = 0; i < sample.count; ++i) {
      height_m +=
          static_cast<double>(sample.weight[i] * heights_m_[static_cast<std::size_t>(sample.node[i])]);
    }
    if (!(height_m <= margin_m)) continue;
    const double gap_m = ground.normal.dot(sample.position_m(state.lattice) - ground.point_m);
    complete &= contacts.add_on_ground({body.index, &state.lattice, sample}, ground.normal, gap_m,
                                       ground.friction, s);
  }
  return complete;
}

}  // namespace spoonbill
