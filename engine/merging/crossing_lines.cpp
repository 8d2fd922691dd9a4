#include "engine/merging/crossing_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/new_poles.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {

namespace {

constexpr int lines_looked_at = 24;

Surface along_v(const Surface& patch) {
  if (!is_tube(patch) || patch.u.is_periodic()) return patch;
  // Exchanging turns the normals, reversing turns them back.
  return reversed(exchanged(patch), Direction::u);
}

// Run through the other way with the same normals.
Surface turned_around(const Surface& patch) {
  return reversed(reversed(patch, Direction::v), Direction::u);
}

std::vector<double> lines_of(const Surface& patch) {
  return patch.u.is_periodic() ? uniform_parameters_without_seam(patch.u, lines_looked_at)
                               : uniform_parameters(patch.u, lines_looked_at);
}

bool is_closed_body(const Surface& patch) {
  return is_tube(patch) && is_pole(patch, Side::v_start) && is_pole(patch, Side::v_end);
}

double line_length_m(const Surface& patch, double u, double from, double to) {
  constexpr int chords = 32;
  double length = 0.0;
  Vector3 last = position(patch, u, from);
  for (int k = 1; k <= chords; ++k) {
    const Vector3 next = position(patch, u, from + (to - from) * k / chords);
    length += (next - last).norm();
    last = next;
  }
  return length;
}

// What a patch's lines say of the other: how many cross it, whether what is kept lies before the crossing,
// and where they cross.
struct Crossed {
  int lines = 0;
  double kept_before = 0.0;  // votes
  std::vector<LineCrossing> crossings;
};

Crossed look(const Surface& patch, const Surface& other, const CrossingFinder& finder) {
  Crossed crossed;
  const bool other_closed = is_closed_body(other);
  for (const double u : lines_of(patch)) {
    const auto found = finder.of_line(patch, u);
    if (found.empty()) continue;
    ++crossed.lines;
    const LineCrossing& crossing = found.front();
    crossed.crossings.push_back(crossing);
    const SurfacePoint here = evaluate(patch, u, crossing.along);
    if (other_closed) {
      const double outwards = here.dv.dot(unit_normal(other, crossing.other_u, crossing.other_v));
      crossed.kept_before += outwards < 0.0 ? 1.0 : -1.0;
    } else {
      crossed.kept_before += line_length_m(patch, u, patch.v.domain_start(), crossing.along) -
                             line_length_m(patch, u, crossing.along, patch.v.domain_end());
    }
  }
  return crossed;
}

// Around a pole the crossings' other_u run once around; beside it they return.
bool goes_around_pole(const Surface& other, const std::vector<LineCrossing>& crossings) {
  const double period = other.u.domain_end() - other.u.domain_start();
  double turned = 0.0;
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    const double step = crossings[(k + 1) % crossings.size()].other_u - crossings[k].other_u;
    turned += step - period * std::round(step / period);
  }
  return std::abs(std::abs(turned) - period) < 0.5 * period;
}

Error not_crossed() {
  return Error{
      "not every line of constant u of the first patch crosses the other; turn it (exchange u and v), "
      "give the patches in the other order, or move it through"};
}

Result<Surface> with_pole_at_crossing(const Surface& body, const std::vector<LineCrossing>& crossings,
                                      double tolerance_m) {
  Vector3 place = Vector3::Zero();
  for (const LineCrossing& crossing : crossings) {
    place += crossing.point_m / static_cast<double>(crossings.size());
  }
  auto placed = with_pole_towards(body, (place - middle_of(body)).normalized(), tolerance_m);
  if (!placed) return placed.error();
  return std::move(placed->surface);
}

// So that the second's u increases with the first's.
Surface running_along(const Surface& first, const Surface& second) {
  const CrossingFinder finder(second);
  const double period = second.u.is_periodic() ? second.u.domain_end() - second.u.domain_start() : 0.0;
  double forwards = 0.0, last = 0.0;
  bool any = false;
  for (const double u : lines_of(first)) {
    const auto found = finder.of_line(first, u);
    if (found.empty()) continue;
    double step = found.front().other_u - last;
    if (period > 0.0) step -= period * std::round(step / period);
    if (any) forwards += step;
    last = found.front().other_u;
    any = true;
  }
  return forwards < 0.0 ? reversed(second, Direction::u) : second;
}

}  // namespace

Result<CrossingPatches> facing_each_other(const Surface& first, const Surface& second, double tolerance_m) {
  CrossingPatches patches{along_v(first), along_v(second)};
  Crossed of_first = look(patches.first, patches.second, CrossingFinder(patches.second));
  if (of_first.lines < lines_looked_at) return not_crossed();
  if (is_closed_body(patches.second) && !goes_around_pole(patches.second, of_first.crossings)) {
    auto placed = with_pole_at_crossing(patches.second, of_first.crossings, tolerance_m);
    if (!placed) return placed.error();
    patches.second = std::move(placed).value();
  }
  if (of_first.kept_before < 0.0) patches.first = turned_around(patches.first);
  const Crossed of_second = look(patches.second, patches.first, CrossingFinder(patches.first));
  if (of_second.lines == 0) return not_crossed();
  if (of_second.kept_before > 0.0) patches.second = turned_around(patches.second);
  patches.second = running_along(patches.first, patches.second);
  return patches;
}

CornerLines::CornerLines(const CrossingPatches& patches, double fillet_m)
    : patches_(&patches), second_(patches.second), fillet_m_(fillet_m) {
  choose_sides();
}

// The ball lies where both kept parts are: on each surface on the side to which the other's kept part leads.
void CornerLines::choose_sides() {
  const auto& [first, second] = *patches_;
  double on_first = 0.0, on_second = 0.0;
  for (const double u : lines_of(first)) {
    const auto found = second_.of_line(first, u);
    if (found.empty()) continue;
    const LineCrossing& at = found.front();
    const Vector3 kept_of_first = -evaluate(first, u, at.along).dv.normalized();
    const Vector3 kept_of_second = evaluate(second, at.other_u, at.other_v).dv.normalized();
    on_first += unit_normal(first, u, at.along).dot(kept_of_second);
    on_second += unit_normal(second, at.other_u, at.other_v).dot(kept_of_first);
  }
  sides_ = {on_first < 0.0 ? -1 : 1, on_second < 0.0 ? -1 : 1};
}

const std::optional<CornerLine>& CornerLines::at(double u) {
  const auto known = lines_.find(u);
  return known != lines_.end() ? known->second : lines_.emplace(u, found(u)).first->second;
}

std::optional<CornerLine> CornerLines::found(double u) const {
  const auto crossings = second_.of_line(patches_->first, u);
  if (crossings.empty()) return std::nullopt;
  const LineCrossing& crossing = crossings.front();
  if (fillet_m_ == 0.0) return CornerLine{crossing.along, crossing.other_u, crossing.other_v, {}};
  const auto contact = ball_contact(patches_->first, u, patches_->second, crossing, sides_, fillet_m_);
  if (!contact) return std::nullopt;
  return CornerLine{contact->v, contact->other_u, contact->other_v, contact->centre_m};
}

}  // namespace spoonbill
