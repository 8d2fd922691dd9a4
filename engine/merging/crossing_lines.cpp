#include "engine/merging/crossing_lines.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/lines_from_loop.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {

namespace {

constexpr int lines_looked_at = 24;
// Where a body pokes out of the other it may do so between two of those lines.
constexpr int lines_searched = 8 * lines_looked_at;

Surface along_v(const Surface& patch) {
  if (!is_tube(patch) || patch.u.is_periodic()) return patch;
  // Exchanging turns the normals, reversing turns them back.
  return reversed(exchanged(patch), Direction::u);
}

// Run through the other way with the same normals.
Surface turned_around(const Surface& patch) {
  return reversed(reversed(patch, Direction::v), Direction::u);
}

std::vector<double> lines_of(const Surface& patch, int count = lines_looked_at) {
  return patch.u.is_periodic() ? uniform_parameters_without_seam(patch.u, count)
                               : uniform_parameters(patch.u, count);
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

Error closed_both_ways() {
  return Error{
      "a patch is closed around both u and v, and what another one adds to a ring is no tube; split the ring "
      "open with change"};
}

Error goes_through(const Vector3& place_m) {
  return Error{"the first patch goes through the other and would lose what is on the far side, from " +
               position_text(place_m) +
               " on; cut it where it is inside, and merge the two parts one after the other"};
}

Error pokes_out(const Vector3& place_m) {
  return Error{"the first patch leaves the other again at " + position_text(place_m) +
               " and would lose what lies outside there; move it so that its end is all inside, make the end "
               "narrower, or give the patches in the other order"};
}

// Of the first each line keeps what lies before where it enters the other: none may come out once more.
Status check_stays_inside(const Surface& first, const CrossingFinder& other) {
  int repeatedly = 0;
  std::optional<Vector3> place_m;
  for (const double u : lines_of(first, lines_searched)) {
    const auto found = other.of_line(first, u);
    if (found.size() < 2) continue;
    ++repeatedly;
    if (!place_m) place_m = found[1].point_m;
  }
  if (!place_m) return {};
  return 2 * repeatedly > lines_searched ? goes_through(*place_m) : pokes_out(*place_m);
}

Error not_side_by_side() {
  return Error{
      "lines of constant u of the two patches do not follow each other along the crossing, as a closed one "
      "does "
      "not on a sheet; exchange u and v of one, or name closed bodies"};
}

Error not_around_its_middle() {
  return Error{
      "the crossing on the second body does not run once around its own middle, as where one body stands in "
      "the side of another that is as wide; make one wider, or give them in the other order"};
}

std::vector<Eigen::Vector2d> loop_of(const std::vector<LineCrossing>& crossings) {
  std::vector<Eigen::Vector2d> loop;
  loop.reserve(crossings.size());
  for (const LineCrossing& crossing : crossings) loop.emplace_back(crossing.other_u, crossing.other_v);
  return loop;
}

// From its pole that is nearer to the crossing.
Surface from_nearer_pole(const Surface& body, const std::vector<LineCrossing>& crossings) {
  double sum = 0.0;
  for (const LineCrossing& crossing : crossings) sum += crossing.other_v;
  const double middle = 0.5 * (body.v.domain_start() + body.v.domain_end());
  return sum > middle * static_cast<double>(crossings.size()) ? turned_around(body) : body;
}

// Where each of the first's lines that cross it starts the second's: its u, or beside a pole the angle about
// the crossing, in shares of a turn.
std::vector<double> starts_along(const CrossingPatches& patches, const std::vector<LineCrossing>& crossings) {
  std::vector<double> starts;
  if (patches.beside_pole) {
    const std::vector<Eigen::Vector2d> loop = loop_of(crossings);
    const LinesFromLoop lines(patches.second, loop);
    for (const Eigen::Vector2d& start : loop) starts.push_back(lines.angle_of(start));
  } else {
    for (const LineCrossing& crossing : crossings) starts.push_back(crossing.other_u);
  }
  return starts;
}

// How far the second's lines move from each of the first's lines to the next, the short way around.
std::vector<double> steps_between(std::vector<double> starts, bool closed, double period) {
  if (closed && !starts.empty()) starts.push_back(starts.front());
  std::vector<double> steps;
  for (std::size_t k = 1; k < starts.size(); ++k) {
    const double step = starts[k] - starts[k - 1];
    steps.push_back(period > 0.0 ? step - period * std::round(step / period) : step);
  }
  return steps;
}

// So that the second's lines follow each other as the first's, once around where they are closed.
Result<Surface> running_along(const CrossingPatches& patches, const std::vector<LineCrossing>& crossings) {
  const Surface &first = patches.first, &second = patches.second;
  const double length = patches.beside_pole ? 1.0 : second.u.domain_end() - second.u.domain_start();
  const std::vector<double> steps = steps_between(starts_along(patches, crossings), first.u.is_periodic(),
                                                  second.u.is_periodic() ? length : 0.0);
  const double forwards = std::accumulate(steps.begin(), steps.end(), 0.0);
  const double sign = forwards < 0.0 ? -1.0 : 1.0;
  constexpr double rounding_share = 1e-6;
  const bool returns =
      std::any_of(steps.begin(), steps.end(), [&](double s) { return sign * s < -rounding_share * length; });
  const bool once_around = !first.u.is_periodic() ||
                           (second.u.is_periodic() && std::abs(std::abs(forwards) - length) < 0.5 * length);
  if ((returns || !once_around) && patches.beside_pole) return not_around_its_middle();
  if (returns || !once_around) return not_side_by_side();
  return forwards < 0.0 ? reversed(second, Direction::u) : second;
}

}  // namespace

Result<CrossingPatches> facing_each_other(const Surface& first, const Surface& second) {
  for (const Surface* patch : {&first, &second}) {
    if (patch->u.is_periodic() && patch->v.is_periodic()) return closed_both_ways();
  }
  CrossingPatches patches{along_v(first), along_v(second), false};
  const CrossingFinder finder(patches.second);
  const Crossed of_first = look(patches.first, patches.second, finder);
  if (of_first.lines < lines_looked_at) return not_crossed();
  if (of_first.kept_before < 0.0) patches.first = turned_around(patches.first);
  const bool closed = is_closed_body(patches.second);
  if (closed) {
    if (Status inside = check_stays_inside(patches.first, finder); !inside) return inside.error();
  }
  patches.beside_pole = closed && !goes_around_pole(patches.second, of_first.crossings);
  if (patches.beside_pole) {
    patches.second = from_nearer_pole(patches.second, of_first.crossings);
  } else {
    const Crossed of_second = look(patches.second, patches.first, CrossingFinder(patches.first));
    if (of_second.lines == 0) return not_crossed();
    if (of_second.kept_before > 0.0) patches.second = turned_around(patches.second);
  }
  const Crossed turned = look(patches.first, patches.second, CrossingFinder(patches.second));
  auto along = running_along(patches, turned.crossings);
  if (!along) return along.error();
  patches.second = std::move(along).value();
  return patches;
}

CornerLines::CornerLines(const CrossingPatches& patches, double fillet_m)
    : patches_(&patches), second_(patches.second), fillet_m_(fillet_m) {
  SPOONBILL_ASSERT(fillet_m >= 0.0);
  choose_sides();
}

// The ball lies where both kept parts are: on each surface on the side to which the other's kept part leads.
void CornerLines::choose_sides() {
  const Surface &first = patches_->first, &second = patches_->second;
  const std::vector<LineCrossing> crossings = look(first, second, second_).crossings;
  std::optional<LinesFromLoop> from_loop;
  if (patches_->beside_pole) from_loop.emplace(second, loop_of(crossings));
  const std::vector<double> lines = lines_of(first);
  double on_first = 0.0, on_second = 0.0;
  for (std::size_t k = 0; k < std::min(lines.size(), crossings.size()); ++k) {
    const LineCrossing& at = crossings[k];
    const Vector3 kept_of_first = -evaluate(first, lines[k], at.along).dv.normalized();
    Vector3 kept_of_second = evaluate(second, at.other_u, at.other_v).dv.normalized();
    if (from_loop) {
      constexpr double little = 1e-3;
      const Eigen::Vector2d next = from_loop->at({at.other_u, at.other_v}, little);
      kept_of_second = (position(second, next.x(), next.y()) - at.point_m).normalized();
    }
    on_first += unit_normal(first, lines[k], at.along).dot(kept_of_second);
    on_second += unit_normal(second, at.other_u, at.other_v).dot(kept_of_first);
  }
  sides_ = {on_first < 0.0 ? -1 : 1, on_second < 0.0 ? -1 : 1};
}

const std::optional<CornerLine>& CornerLines::at(double u) {
  const auto known = lines_.find(u);
  return known != lines_.end() ? known->second : lines_.emplace(u, found(u)).first->second;
}

std::vector<Eigen::Vector2d> CornerLines::loop_on_second() {
  std::vector<Eigen::Vector2d> loop;
  for (const double u : lines_of(patches_->first)) {
    if (const auto& line = at(u)) loop.emplace_back(line->second_u, line->second_v);
  }
  return loop;
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
