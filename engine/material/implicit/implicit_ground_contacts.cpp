#include "engine/material/implicit/implicit_ground_contacts.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/material/contact/contact_push.h"

namespace spoonbill {
namespace {

// Largest number of iterations for the ground contacts in a tick. Each iteration costs one solve with the
// Cholesky factor, as much as an iteration of the conjugate gradients in ImplicitBody.
constexpr int step_limit = 4;
// Velocity error below which the ground contacts of a tick count as solved: a nanometre per second.
constexpr double accepted_error_m_per_s = 1e-9;
constexpr double min_diagonal_fraction = 0.1;
// Bounds of the spectral mass (see ImplicitGroundContacts), relative to the body's mass.
constexpr double min_mass_ratio = 1e-5, max_mass_ratio = 10.0;

// A contact point responds only if the weights of its free nodes have at least this sum. A point attached
// mostly to fixed nodes would hardly move, or would move its few free nodes far too much.
constexpr double min_free_fraction = 0.5;

double free_fraction(const GridPoint& point, const ImplicitBody& body) {
  double fraction = 0.0;
  for (std::size_t c = 0; c < 8; ++c) fraction += body.is_fixed(point.node[c]) ? 0.0 : point.weight[c];
  return fraction;
}

// Limits an impulse to the friction cone: its normal part to 0 or more, then its tangential part to
// `friction` times the normal part.
Vector3 project_onto_cone(const Vector3& impulse, const Vector3& normal, double friction) {
  const double push = std::max(0.0, impulse.dot(normal));
  const Vector3 along = impulse - impulse.dot(normal) * normal;
  const double drag = along.norm();
  return push * normal + (drag > friction * push ? friction * push / drag : 1.0) * along;
}

}  // namespace

ImplicitGroundContacts::ImplicitGroundContacts(int points, double mass_kg)
    : mass_(0.1 * mass_kg), min_mass_(min_mass_ratio * mass_kg), max_mass_(max_mass_ratio * mass_kg) {
  SPOONBILL_ASSERT(mass_kg > 0.0);
  target_.assign(static_cast<std::size_t>(points), 0.0);
  velocity_errors_.assign(static_cast<std::size_t>(points), Vector3::Zero());
  impulse_changes_.assign(static_cast<std::size_t>(points), Vector3::Zero());
}

void ImplicitGroundContacts::scale_inertia(double factor) {
  for (double* mass : {&mass_, &min_mass_, &max_mass_}) *mass *= factor;
}

void ImplicitGroundContacts::restore_last_impulses(std::span<GroundContact> contacts,
                                                   std::span<const GridPoint> points, double time_s,
                                                   std::vector<double>& impulses_ns) {
  SPOONBILL_ASSERT(time_s > 0.0);
  for (GroundContact& contact : contacts) {
    contact.impulse_ns = time_s * contact.force_n;
    points[static_cast<std::size_t>(contact.node)].spread(contact.impulse_ns, impulses_ns);
  }
}

void ImplicitGroundContacts::compute_velocity_errors(std::span<const GroundContact> contacts,
                                                     std::span<const GridPoint> points,
                                                     const ImplicitBody& body) {
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const GridPoint& point = points[static_cast<std::size_t>(contacts[c].node)];
    velocity_errors_[c].setZero();
    if (free_fraction(point, body) < min_free_fraction) continue;
    velocity_errors_[c] =
        point.sum_over([&](int node) { return body.velocity(node); }) - target_[c] * normal_;
  }
}

double ImplicitGroundContacts::compute_impulse_changes(std::span<const GroundContact> contacts) {
  double square = 0.0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Vector3& now = contacts[c].impulse_ns;
    impulse_changes_[c] =
        project_onto_cone(now - mass_ * velocity_errors_[c], normal_, contacts[c].friction) - now;
    square += impulse_changes_[c].squaredNorm();
  }
  return square;
}

void ImplicitGroundContacts::solve(const GroundContacts& ground, std::span<GroundContact> contacts,
                                   std::span<const GridPoint> points, double time_s, double cap_m_per_s,
                                   ImplicitBody& body, std::vector<double>& impulses_ns) {
  SPOONBILL_ASSERT(time_s > 0.0);
  normal_ = ground.normal();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactPush push{contacts[c].gap_m, normal_, Vector3::Zero(), 0.0};
    target_[c] = push.target_m_per_s(time_s, ground_pace, cap_m_per_s);
  }
  for (int step = 0; step < step_limit; ++step) {
    compute_velocity_errors(contacts, points, body);
    const double square = compute_impulse_changes(contacts), still = mass_ * accepted_error_m_per_s;
    if (!(square > still * still)) return;
    std::fill(impulses_ns.begin(), impulses_ns.end(), 0.0);
    double slope = 0.0;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      points[static_cast<std::size_t>(contacts[c].node)].spread(impulse_changes_[c], impulses_ns);
      slope -= impulse_changes_[c].dot(velocity_errors_[c]);
    }
    const double work = body.respond_to(impulses_ns);
    const double fraction =
        work > 0.0 && slope > 0.0 ? std::clamp(slope / work, min_diagonal_fraction, 1.0) : 1.0;
    body.apply_response(fraction);
    for (std::size_t c = 0; c < contacts.size(); ++c)
      contacts[c].impulse_ns += fraction * impulse_changes_[c];
    if (work > 0.0) mass_ = std::clamp(square / work, min_mass_, max_mass_);
  }
}

}  // namespace spoonbill
