#include "engine/simulation/body_self_contact.h"

#include "engine/base/assert.h"

namespace spoonbill {

BodySelfContact::BodySelfContact(const BodyState& body) {
  SPOONBILL_ASSERT_DEBUG(body.held.size() == static_cast<std::size_t>(body.lattice.mesh().node_count()));
  if (body.mesh() != nullptr || body.lattice.mesh().slender) return;
  proximity_ = std::make_unique<SelfProximity>(body.mapping().nested(), body.mapping().rest(),
                                               static_cast<double>(body.lattice.cell_size_m()));
}

bool BodySelfContact::add_contacts(const NumberedBody& body, BodyContacts& contacts) const {
  if (!proximity_) return true;
  const double margin = contact_margin_cells * static_cast<double>(body.state->lattice.cell_size_m());
  proximity_->find(body.state->mapping().current(), margin);
  if (const TrimmedArea* const trim = body.state->trim.get()) {
    proximity_->keep_if([&](const NearPoint& near) {
      return trim->contains(near.u, near.v) && trim->contains(near.other_u, near.other_v);
    });
  }
  const bool complete = add_near_points(body, body, proximity_->points(), contacts);
  return complete && !proximity_->overflow();
}

}  // namespace spoonbill
