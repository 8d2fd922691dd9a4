#include "engine/material/implicit/block_on_ground.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/contact/contact_push.h"

namespace spoonbill {
namespace {

// Each takes a solution with the factor, as an iteration of the conjugate gradients does.
constexpr int step_limit = 4;
// Of what a tick may leave, as a speed: a nanometre in a second.
constexpr double enough_m_per_s = 1e-9;
constexpr double least_share = 0.1;
// The spectral mass, beside the body's.
constexpr double lightest = 1e-5, heaviest = 10.0;

// A point that hangs on held nodes would answer nothing, or throw what else it hangs on.
constexpr double least_free_share = 0.5;

double free_share(const GridPoint& point, const ImplicitBody& body) {
  double share = 0.0;
  for (std::size_t c = 0; c < 8; ++c) share += body.is_held(point.node[c]) ? 0.0 : point.weight[c];
  return share;
}

Vector3 on_cone(const Vector3& impulse, const Vector3& normal, double friction) {
  const double push = std::max(0.0, impulse.dot(normal));
  const Vector3 along = impulse - impulse.dot(normal) * normal;
  const double drag = along.norm();
  return push * normal + (drag > friction * push ? friction * push / drag : 1.0) * along;
}

}  // namespace

BlockOnGround::BlockOnGround(int points, double mass_kg)
    : mass_(0.1 * mass_kg), least_mass_(lightest * mass_kg), largest_mass_(heaviest * mass_kg) {
  SPOONBILL_ASSERT(mass_kg > 0.0);
  wanted_.assign(static_cast<std::size_t>(points), 0.0);
  misses_.assign(static_cast<std::size_t>(points), Vector3::Zero());
  changes_.assign(static_cast<std::size_t>(points), Vector3::Zero());
}

void BlockOnGround::take_last(std::span<GroundContact> contacts, std::span<const GridPoint> points,
                              double time_s, std::vector<double>& impulses_ns) {
  SPOONBILL_ASSERT(time_s > 0.0);
  std::fill(impulses_ns.begin(), impulses_ns.end(), 0.0);
  for (GroundContact& contact : contacts) {
    contact.impulse_ns = time_s * contact.force_n;
    points[static_cast<std::size_t>(contact.node)].share_out(contact.impulse_ns, impulses_ns);
  }
}

void BlockOnGround::take_misses(std::span<const GroundContact> contacts, std::span<const GridPoint> points,
                                const ImplicitBody& body) {
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const GridPoint& point = points[static_cast<std::size_t>(contacts[c].node)];
    misses_[c].setZero();
    if (free_share(point, body) < least_free_share) continue;
    misses_[c] = point.sum_over([&](int node) { return body.velocity(node); }) - wanted_[c] * normal_;
  }
}

double BlockOnGround::take_changes(std::span<const GroundContact> contacts) {
  double square = 0.0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Vector3& now = contacts[c].impulse_ns;
    changes_[c] = on_cone(now - mass_ * misses_[c], normal_, contacts[c].friction) - now;
    square += changes_[c].squaredNorm();
  }
  return square;
}

void BlockOnGround::solve(const GroundContacts& ground, std::span<GroundContact> contacts,
                          std::span<const GridPoint> points, double time_s, double cap_m_per_s,
                          ImplicitBody& body, std::vector<double>& impulses_ns) {
  SPOONBILL_ASSERT(time_s > 0.0);
  normal_ = ground.normal();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactPush push{contacts[c].gap_m, normal_, Vector3::Zero(), 0.0};
    wanted_[c] = push.wanted_m_per_s(time_s, ground_pace, cap_m_per_s);
  }
  for (int step = 0; step < step_limit; ++step) {
    take_misses(contacts, points, body);
    const double square = take_changes(contacts), still = mass_ * enough_m_per_s;
    if (!(square > still * still)) return;
    std::fill(impulses_ns.begin(), impulses_ns.end(), 0.0);
    double slope = 0.0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      points[static_cast<std::size_t>(contacts[c].node)].share_out(changes_[c], impulses_ns);
      slope -= changes_[c].dot(misses_[c]);
    }
    const double work = body.answer(impulses_ns);
    const double share = work > 0.0 && slope > 0.0 ? std::clamp(slope / work, least_share, 1.0) : 1.0;
    body.take_answer(share);
    for (std::size_t c = 0; c < contacts.size(); ++c) contacts[c].impulse_ns += share * changes_[c];
    if (work > 0.0) mass_ = std::clamp(square / work, least_mass_, largest_mass_);
  }
}

}  // namespace spoonbill
