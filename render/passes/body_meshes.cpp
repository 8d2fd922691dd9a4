#include "render/passes/body_meshes.h"

#include "engine/base/geometry.h"

namespace spoonbill {

Status BodyMeshes::update(const Snapshot& snapshot, double pixels_per_metre, bool keep_level) {
  surfaces_.resize(snapshot.bodies.size());
  while (buffers_.size() > surfaces_.size()) buffers_.pop_back();
  while (buffers_.size() < surfaces_.size()) buffers_.emplace_back(*gl_);
  bounds_ = {};
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const BodySnapshot& body = snapshot.bodies[i];
    if (body.is_mesh()) {
      surfaces_[i].update(body.mesh);
    } else {
      if (Status net = check_net(body.surface); !net) return net;
      const SamplingLevel last = keep_level ? surfaces_[i].level() : SamplingLevel();
      const SamplingLevel level = choose_sampling_level(body.surface, pixels_per_metre, last);
      if (Status updated = surfaces_[i].update(body.surface, level); !updated) return updated;
    }
    buffers_[i].upload(surfaces_[i]);
    const Box one = surfaces_[i].bounds();
    if (one.is_empty()) continue;
    bounds_.join(one);
  }
  return {};
}

}  // namespace spoonbill
