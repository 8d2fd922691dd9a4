#include "engine/simulation/body_self_contact.h"

namespace spoonbill {
namespace {

double margin_m(const BodyState& body) {
  return contact_margin_cells * static_cast<double>(body.lattice.cell_size_m());
}

}  // namespace

BodySelfContact::BodySelfContact(const BodyState& body) {
  if (body.mesh() != nullptr) return;
  proximity_ = std::make_unique<SelfProximity>(body.mapping().nested(), body.mapping().rest(),
                                               static_cast<double>(body.lattice.cell_size_m()));
  if (body.lattice.mesh().along.empty()) return;
  proximity_->find(body.mapping().rest(), margin_m(body));
  if (!proximity_->points().empty()) proximity_.reset();
}

bool BodySelfContact::add_contacts(const NumberedBody& body, BodyContacts& contacts) const {
  if (!proximity_) return true;
  proximity_->find(body.state->mapping().current(), margin_m(*body.state));
  if (const TrimmedArea* const trim = body.state->trim.get()) {
    proximity_->keep_if([&](const NearPoint& near) {
      return trim->contains(near.u, near.v) && trim->contains(near.other_u, near.other_v);
    });
  }
  const bool complete = add_near_points(body, body, proximity_->points(), contacts);
  return complete && !proximity_->overflow();
}

}  // namespace spoonbill
