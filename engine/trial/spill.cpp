#include "engine/trial/spill.h"

#include <algorithm>
#include <string>

namespace spoonbill {
namespace {

constexpr std::uint64_t calls_between_measures = 5;
// Cosine of the angle between a rim's normal and the vertical above which the rim's plane tells what is
// below: 78 degrees.
constexpr double least_upright = 0.2;

int find_bearer(const Scene& scene) {
  const TrialPlan plan = scene.trial.value_or(TrialPlan());
  const std::vector<Body>& bodies = scene.bodies;
  auto bearer = std::find_if(bodies.begin(), bodies.end(), [&](const Body& body) {
    return body.name == plan.turned_body && !body.rim.empty();
  });
  if (bearer == bodies.end()) {
    bearer = std::find_if(bodies.begin(), bodies.end(), [&](const Body& body) {
      return body.name != plan.lowered_body && !body.rim.empty();
    });
  }
  return bearer == bodies.end() ? -1 : static_cast<int>(bearer - bodies.begin());
}

// Returns the least height of a surface's control points along the unit vector `up`, m.
double find_lowest_m(const Surface& surface, const Vector3& up) {
  double lowest = infinity;
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) lowest = std::min(lowest, up.dot(surface.net.point(i, j)));
  }
  return lowest;
}

// Tells where points are relative to a rim and the body that has it.
struct Border {
  const Rim& rim;
  Vector3 up;
  bool is_upright;
  double lowest_m;  // of the body, along `up`

  bool is_fallen(const Vector3& point_m) const { return !is_upright && up.dot(point_m) < lowest_m; }
  bool is_outside(const Vector3& point_m) const { return is_fallen(point_m) || rim.is_outside(point_m); }
  bool is_below(const Vector3& point_m) const { return is_fallen(point_m) || rim.height_m(point_m) < 0.0; }
};

// Sets the fractions of a deformable body.
void measure_fractions(const Border& border, const MassPoints& points, const SpringLattice& lattice,
                       Spill& spill) {
  double all = 0.0, outside = 0.0, spilled = 0.0;
  Vector2 sum_m = Vector2::Zero();
  const auto visit = [&](const Vector3& point, double fraction) {
    all += fraction;
    if (!border.is_outside(point)) return;
    outside += fraction;
    sum_m += fraction * border.rim.from_centre_m(point);
    if (border.is_below(point)) spilled += fraction;
  };
  points.for_each(lattice, visit, [&](const CellCorners& corners, double fraction) {
    const bool is_inside =
        border.is_upright && std::all_of(corners.begin(), corners.end(), [&](const Vector3& corner) {
          return border.rim.is_well_inside(corner);
        });
    if (is_inside) all += fraction;
    return is_inside;
  });
  spill.outside_m = outside > 0.0 ? Vector2(sum_m / outside) : Vector2(Vector2::Zero());
  spill.outside_fraction = outside / all;
  spill.spilled_fraction = spilled / all;
}

}  // namespace

SpillWatch::SpillWatch(const Scene& scene)
    : bearer_(find_bearer(scene)),
      is_watched_(scene.bodies.size()),
      spills_(scene.bodies.size()),
      points_(scene.bodies.size()) {
  if (bearer_ < 0) return;
  const Vector3& gravity = scene.sculpting.gravity_m_per_s2;
  if (!gravity.isZero(0.0)) up_ = -gravity.normalized();
  normal_ = up_;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    is_watched_[b] = static_cast<int>(b) != bearer_ && body.kind != BodyKind::fixed && !body.hand;
  }
}

const Spill* SpillWatch::find(std::size_t body) const {
  return spills_[body] ? &*spills_[body] : nullptr;
}

void SpillWatch::follow(const Simulation& simulation, double time_s, bool now) {
  const bool is_due = calls_++ % calls_between_measures == 0;
  if (bearer_ >= 0 && (is_due || now)) measure(simulation, time_s);
}

void SpillWatch::measure(const Simulation& simulation, double time_s) {
  const Surface& surface = simulation.surface(bearer_);
  const std::vector<Vector2>& corners = simulation.scene().bodies[static_cast<std::size_t>(bearer_)].rim;
  if (!rim_) {
    rim_ = Rim::on_surface(surface, corners, normal_);
  } else if (!rim_->follow(surface, corners, normal_)) {
    rim_.reset();
  }
  if (!rim_) return;
  // The normal keeps its side while the body turns, even beyond a right angle.
  normal_ = rim_->normal();
  const Border border{*rim_, up_, normal_.dot(up_) > least_upright, find_lowest_m(surface, up_)};
  for (std::size_t b = 0; b < spills_.size(); ++b) {
    if (!is_watched_[b]) continue;
    const int body = static_cast<int>(b);
    const RigidDynamics* const rigid = simulation.rigid_dynamics(body);
    if (!rigid && !points_[b]) {
      points_[b].emplace(simulation.lattice(body), simulation.scene().bodies[b].surface);
    }
    const Vector3 centre = rigid ? rigid->centre_m() : points_[b]->find_centre_m(simulation.lattice(body));
    const bool is_out = border.is_outside(centre);
    const bool is_borne = !is_out && up_.dot(centre) > border.lowest_m;
    if (!spills_[b] && !is_borne) continue;
    if (!spills_[b]) spills_[b] = Spill();
    Spill& spill = *spills_[b];
    spill.margin_m = rim_->margin_m(centre);
    if (rigid) {
      spill.outside_m = is_out ? rim_->from_centre_m(centre) : Vector2::Zero();
      spill.outside_fraction = is_out ? 1.0 : 0.0;
      spill.spilled_fraction = is_out && border.is_below(centre) ? 1.0 : 0.0;
    } else {
      measure_fractions(border, *points_[b], simulation.lattice(body), spill);
    }
    if (!spill.first_spill_s && spill.spilled_fraction > spill_limit_fraction) spill.first_spill_s = time_s;
    if (!spill.left_s && is_out) spill.left_s = time_s;
  }
}

}  // namespace spoonbill
