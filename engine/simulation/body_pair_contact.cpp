#include "engine/simulation/body_pair_contact.h"

#include <algorithm>

namespace spoonbill {
EmbeddedPoint embedding_of(const BodyMapping& mapping, const NearPoint& near) {
  return near.sample >= 0 ? mapping.sample(near.sample) : mapping.at(near.u, near.v);
}

bool add_near_points(const NumberedBody& from, const NumberedBody& to, const std::vector<NearPoint>& points,
                     BodyContacts& contacts) {
  bool complete = true;
  for (const NearPoint& near : points) {
    complete &=
        contacts.add({from.number, &from.state->lattice, embedding_of(from.state->mapping, near)},
                     {to.number, &to.state->lattice, to.state->mapping.at(near.other_u, near.other_v)},
                     near.normal, near.gap_m);
  }
  return complete;
}

BodyPairContact::BodyPairContact(const BodyMapping& first, const BodyMapping& second)
    : proximity_(std::make_unique<SurfaceProximity>(first.nested(), second.nested())) {}

bool BodyPairContact::find(const NumberedBody& first, const NumberedBody& second) {
  const double cell =
      static_cast<double>(std::max(first.state->lattice.cell_size_m(), second.state->lattice.cell_size_m()));
  proximity_->find(first.state->mapping.current(), second.state->mapping.current(),
                   contact_margin_cells * cell);
  return !proximity_->overflow();
}

bool BodyPairContact::add_contacts(const NumberedBody& first, const NumberedBody& second,
                                   BodyContacts& contacts) const {
  const bool all_of_first = add_near_points(first, second, proximity_->of_first(), contacts);
  const bool all_of_second = add_near_points(second, first, proximity_->of_second(), contacts);
  return all_of_first && all_of_second;
}

}  // namespace spoonbill
