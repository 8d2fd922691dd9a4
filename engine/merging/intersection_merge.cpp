#include "engine/merging/intersection_merge.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/result.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/bridge.h"
#include "engine/merging/line_crossing.h"
#include "engine/merging/tube_ends.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {
namespace {

// Lines on a body from a loop near one pole to the pole on the far side.
//
// The body's parameters are mapped to a plane by polar coordinates: v, from the near pole on, is the radius
// and u the angle. Each line leaves the loop away from the loop's centre and bends. At a circle around the
// loop it becomes a line of constant u of the body. Beyond the circle, the body's curvature is aligned with
// the lines. All lines leave the loop at the same speed, as lines leave the end of a fillet.
class LinesFromLoop {
 public:
  // `body` starts along v at the pole near the loop, is periodic in u, and must outlive this object. `loop`
  // contains pairs (u, v) in order; each u may be in any period.
  LinesFromLoop(const Surface& body, const std::vector<Eigen::Vector2d>& loop);

  // Returns the angle of a point about the loop's centre, as a fraction of a turn.
  double turn_at(const Eigen::Vector2d& start) const;
  // Returns (u, v) at a fraction of the length of the line that begins at `start`.
  Eigen::Vector2d at(const Eigen::Vector2d& start, double fraction) const;
  // Returns the fraction of its length from which on a line follows an isoline of constant u of the body.
  double bend_fraction() const { return bend_; }

 private:
  Eigen::Vector2d to_plane(const Eigen::Vector2d& uv) const;
  Eigen::Vector2d from_plane(const Eigen::Vector2d& point) const;
  // Returns the length in metres on the body per unit of length in the plane.
  double metres_per_step(const Eigen::Vector2d& point, const Eigen::Vector2d& direction) const;

  const Surface* body_;
  double u_start_, u_length_, v_start_, v_length_;
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();
  double circle_ = 0.0;
  double bend_ = 0.0;
  double speed_at_bend_ = 0.0, start_speed_m_ = 0.0;
};

// Two patches that intersect. Both run along v: the first towards the intersection, the second away from it.
struct CrossingPatches {
  Surface first, second;
  // True if the intersection is near the pole at the start of the second patch's v, and does not go around
  // the pole. The lines of the second patch then come from LinesFromLoop.
  bool beside_pole = false;
};

// Line that follows the first patch at one u up to the intersection and continues along the second patch. It
// is given by the point at which it leaves the first patch and the point at which it starts on the second.
// With a fillet, an arc connects these points.
struct CornerLine {
  double first_v = 0.0;
  double second_u = 0.0, second_v = 0.0;
  std::optional<Vector3> centre_m;  // centre of the rolling ball; empty for a sharp edge
};

// Cache of corner lines, because fits evaluate the same lines repeatedly. Not safe for concurrent use.
class CornerLines {
 public:
  // `patches` must outlive this object. A radius of 0 gives a sharp edge.
  CornerLines(const CrossingPatches& patches, double fillet_m);

  // Returns the corner line at u; nothing if the line does not cross the second patch or no ball fits.
  const std::optional<CornerLine>& at(double u);

  // Returns points (u, v) on the second patch along the loop in which the patches intersect, dense enough to
  // resolve the loop.
  std::vector<Eigen::Vector2d> loop_on_second();

 private:
  std::optional<CornerLine> find(double u) const;
  void choose_sides();

  const CrossingPatches* patches_;
  CrossingFinder second_;
  double fillet_m_;
  BallSides sides_;
  std::map<double, std::optional<CornerLine>> lines_;
};

using std::numbers::pi;

// The lines become lines of constant u at a circle about the near pole. Let d be the distance of the loop's
// farthest point from this pole. The radius of the circle is d times circle_ratio, but at most d plus the
// fraction most_rest_fraction of the remaining distance to the far pole.
constexpr double circle_ratio = 1.3, most_rest_fraction = 0.5;

Eigen::Vector2d polar(double radius, double angle) {
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

LinesFromLoop::LinesFromLoop(const Surface& body, const std::vector<Eigen::Vector2d>& loop)
    : body_(&body),
      u_start_(body.u.domain_start()),
      u_length_(body.u.domain_length()),
      v_start_(body.v.domain_start()),
      v_length_(body.v.domain_length()) {
  SPOONBILL_ASSERT(body.u.is_periodic() && loop.size() >= 3);
  double farthest = 0.0;
  for (const Eigen::Vector2d& uv : loop) {
    centre_ += to_plane(uv) / static_cast<double>(loop.size());
    farthest = std::max(farthest, to_plane(uv).norm());
  }
  circle_ = std::min(circle_ratio * farthest, farthest + most_rest_fraction * (1.0 - farthest));
  double to_circle = 0.0, shortest = 1.0, shortest_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& uv : loop) {
    const Eigen::Vector2d start = to_plane(uv);
    const double length = (polar(circle_, 2.0 * pi * turn_at(uv)) - start).norm();
    shortest_m = std::min(shortest_m, length * metres_per_step(start, (start - centre_).normalized()));
    to_circle += length / static_cast<double>(loop.size());
    shortest = std::min(shortest, length);
  }
  bend_ = to_circle / (to_circle + 1.0 - circle_);
  // Largest speed of the lines, as a multiple of the shortest line's length. At a higher speed, the shortest
  // line would turn back.
  constexpr double most_shortest_ratio = 1.5;
  speed_at_bend_ = std::min(to_circle, most_shortest_ratio * shortest) / bend_;
  start_speed_m_ = most_shortest_ratio * shortest_m;
}

Eigen::Vector2d LinesFromLoop::to_plane(const Eigen::Vector2d& uv) const {
  return polar((uv.y() - v_start_) / v_length_, 2.0 * pi * (uv.x() - u_start_) / u_length_);
}

double LinesFromLoop::turn_at(const Eigen::Vector2d& start) const {
  const Eigen::Vector2d from_centre = to_plane(start) - centre_;
  return std::atan2(from_centre.y(), from_centre.x()) / (2.0 * pi);
}

Eigen::Vector2d LinesFromLoop::at(const Eigen::Vector2d& start, double fraction) const {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  const double angle = 2.0 * pi * turn_at(start);
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  if (fraction >= bend_) {
    const double s = (fraction - bend_) / (1.0 - bend_), start_slope = speed_at_bend_ * (1.0 - bend_);
    point = polar(circle_ + s * start_slope + s * s * (1.0 - circle_ - start_slope), angle);
  } else {
    // Hermite cubic. At the bend it continues into the rest of the line smoothly and at the same speed.
    const Eigen::Vector2d from = to_plane(start), to = polar(circle_, angle);
    const Eigen::Vector2d away = (from - centre_).normalized();
    const Eigen::Vector2d out = start_speed_m_ / metres_per_step(from, away) * away;
    const Eigen::Vector2d in = polar(speed_at_bend_ * bend_, angle);
    const double s = fraction / bend_, t = 1.0 - s;
    point = t * t * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * t) * to + t * t * s * out - s * s * t * in;
  }
  return from_plane(point);
}

Eigen::Vector2d LinesFromLoop::from_plane(const Eigen::Vector2d& point) const {
  const double turns = std::atan2(point.y(), point.x()) / (2.0 * pi);
  return {u_start_ + u_length_ * turns, v_start_ + v_length_ * std::min(1.0, point.norm())};
}

double LinesFromLoop::metres_per_step(const Eigen::Vector2d& point, const Eigen::Vector2d& direction) const {
  constexpr double step = 1e-5;
  const Eigen::Vector2d from = from_plane(point - step * direction);
  const Eigen::Vector2d to = from_plane(point + step * direction);
  const double moved_m = (position(*body_, to.x(), to.y()) - position(*body_, from.x(), from.y())).norm();
  return moved_m / (2.0 * step);
}

constexpr int lines_checked = 24;
// Number of lines in the finer search for positions where the first body leaves the other one again.
constexpr int lines_searched = 8 * lines_checked;

Surface run_along_v(const Surface& patch) {
  if (!is_tube(patch) || patch.u.is_periodic()) return patch;
  // Exchanging u and v flips the normals; reversing u restores them.
  return reversed(exchanged(patch), Direction::u);
}

// Returns the patch reversed along v, with the same normals.
Surface reverse_along_v(const Surface& patch) {
  return reversed(reversed(patch, Direction::v), Direction::u);
}

std::vector<double> sample_lines(const Surface& patch, int count = lines_checked) {
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

// Crossings of a patch's lines with the other patch: the number of lines that cross, votes for the part to be
// kept, and the crossings.
struct Crossed {
  int lines = 0;
  double before_votes = 0.0;  // if positive, the part before the crossing is kept
  std::vector<LineCrossing> crossings;
};

Crossed cross_lines(const Surface& patch, const Surface& other, const CrossingFinder& finder) {
  Crossed crossed;
  const bool other_closed = is_closed_body(other);
  for (const double u : sample_lines(patch)) {
    const auto found = finder.intersect_line(patch, u);
    if (found.empty()) continue;
    ++crossed.lines;
    const LineCrossing& crossing = found.front();
    crossed.crossings.push_back(crossing);
    const SurfacePoint here = evaluate(patch, u, crossing.along);
    if (other_closed) {
      const double outwards = here.dv.dot(unit_normal(other, crossing.other_u, crossing.other_v));
      crossed.before_votes += outwards < 0.0 ? 1.0 : -1.0;
    } else {
      crossed.before_votes += line_length_m(patch, u, patch.v.domain_start(), crossing.along) -
                              line_length_m(patch, u, crossing.along, patch.v.domain_end());
    }
  }
  return crossed;
}

// Returns true if the crossings go around a pole of the other body. Their other_u then covers one period.
bool goes_around_pole(const Surface& other, const std::vector<LineCrossing>& crossings) {
  const double period = other.u.domain_length();
  double total = 0.0;
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    const double step = crossings[(k + 1) % crossings.size()].other_u - crossings[k].other_u;
    total += step - period * std::round(step / period);
  }
  return std::abs(std::abs(total) - period) < 0.5 * period;
}

Error not_crossed() {
  return Error(
      ErrorCode::mismatch,
      "not every line of constant u of the first patch crosses the second; exchange u and v of the first, "
      "give the patches in the other order, or move the first farther through the second");
}

Error periodic_in_both() {
  return Error(ErrorCode::unsupported,
               "a patch is closed in both u and v; open it in one direction first with `spoonbill change`");
}

Error goes_through(const Vector3& exit_m) {
  return Error(ErrorCode::unsupported,
               "the first patch goes through the other and would lose its part on the far side, from " +
                   position_text(exit_m) +
                   " on; cut it where it is inside, and merge the two parts one after the other");
}

Error pokes_out(const Vector3& exit_m) {
  return Error(ErrorCode::mismatch,
               "the first patch enters the other, comes out of it again at " + position_text(exit_m) +
                   " and would lose the part outside; move it so that its end is all inside, make the end "
                   "narrower, or give the patches in the other order");
}

// Checks that no line of the first patch leaves the other body after entering it.
Status check_stays_inside(const Surface& first, const CrossingFinder& other) {
  int repeatedly = 0;
  std::optional<Vector3> exit_m;
  for (const double u : sample_lines(first, lines_searched)) {
    const auto found = other.intersect_line(first, u);
    if (found.size() < 2) continue;
    ++repeatedly;
    if (!exit_m) exit_m = found[1].point_m;
  }
  if (!exit_m) return {};
  return 2 * repeatedly > lines_searched ? goes_through(*exit_m) : pokes_out(*exit_m);
}

Error not_side_by_side() {
  return Error(
      ErrorCode::mismatch,
      "lines of constant u of the two patches are not in the same order along the crossing, for example "
      "because a closed body meets a sheet; exchange u and v of one patch, or merge closed bodies");
}

Error not_around_centre() {
  return Error(ErrorCode::mismatch,
               "the curve along which the bodies intersect does not run once around its own centre, for "
               "example because the first body enters the side of a body that is no wider than itself; make "
               "one body wider, or give the bodies in the other order");
}

std::vector<Eigen::Vector2d> crossing_loop(const std::vector<LineCrossing>& crossings) {
  std::vector<Eigen::Vector2d> loop;
  loop.reserve(crossings.size());
  for (const LineCrossing& crossing : crossings) loop.emplace_back(crossing.other_u, crossing.other_v);
  return loop;
}

// Reverses the body if needed, so that v starts at the pole nearer to the intersection.
Surface start_at_nearer_pole(const Surface& body, const std::vector<LineCrossing>& crossings) {
  double sum = 0.0;
  for (const LineCrossing& crossing : crossings) sum += crossing.other_v;
  const double centre = 0.5 * (body.v.domain_start() + body.v.domain_end());
  return sum > centre * static_cast<double>(crossings.size()) ? reverse_along_v(body) : body;
}

// Returns the position of each crossing along the intersection. The position is u on the second patch or,
// beside a pole, the angle about the centre of the loop that the crossings form, in turns.
std::vector<double> find_starts_along(const CrossingPatches& patches,
                                      const std::vector<LineCrossing>& crossings) {
  std::vector<double> starts;
  if (patches.beside_pole) {
    const std::vector<Eigen::Vector2d> loop = crossing_loop(crossings);
    const LinesFromLoop lines(patches.second, loop);
    for (const Eigen::Vector2d& start : loop) starts.push_back(lines.turn_at(start));
  } else {
    for (const LineCrossing& crossing : crossings) starts.push_back(crossing.other_u);
  }
  return starts;
}

// Returns the differences between consecutive starts. If there is a period, the differences are wrapped to at
// most half of it.
std::vector<double> steps_between(std::vector<double> starts, bool closed, double period) {
  if (closed && !starts.empty()) starts.push_back(starts.front());
  std::vector<double> steps;
  for (std::size_t k = 1; k < starts.size(); ++k) {
    const double step = starts[k] - starts[k - 1];
    steps.push_back(period > 0.0 ? step - period * std::round(step / period) : step);
  }
  return steps;
}

// Reverses u of the second patch if needed, so that its lines of constant u are in the same order along the
// intersection as the lines of the first patch. Fails if successive crossings change direction along the
// intersection. Also fails if the first patch is closed and its crossings do not go around the intersection
// exactly once.
Result<Surface> align_along(const CrossingPatches& patches, const std::vector<LineCrossing>& crossings) {
  const Surface &first = patches.first, &second = patches.second;
  const double length = patches.beside_pole ? 1.0 : second.u.domain_length();
  const std::vector<double> steps = steps_between(
      find_starts_along(patches, crossings), first.u.is_periodic(), second.u.is_periodic() ? length : 0.0);
  const double forwards = std::accumulate(steps.begin(), steps.end(), 0.0);
  const double sign = forwards < 0.0 ? -1.0 : 1.0;
  constexpr double rounding_fraction = 1e-6;
  const bool turns_back = std::any_of(steps.begin(), steps.end(),
                                      [&](double s) { return sign * s < -rounding_fraction * length; });
  const bool is_once_around =
      !first.u.is_periodic() ||
      (second.u.is_periodic() && std::abs(std::abs(forwards) - length) < 0.5 * length);
  if ((turns_back || !is_once_around) && patches.beside_pole) return not_around_centre();
  if (turns_back || !is_once_around) return not_side_by_side();
  return forwards < 0.0 ? reversed(second, Direction::u) : second;
}

Result<CrossingPatches> orient_for_crossing(const Surface& first, const Surface& second) {
  for (const Surface* patch : {&first, &second}) {
    if (patch->u.is_periodic() && patch->v.is_periodic()) return periodic_in_both();
  }
  CrossingPatches patches{run_along_v(first), run_along_v(second), false};
  const CrossingFinder finder(patches.second);
  const Crossed first_crossed = cross_lines(patches.first, patches.second, finder);
  if (first_crossed.lines < lines_checked) return not_crossed();
  if (first_crossed.before_votes < 0.0) patches.first = reverse_along_v(patches.first);
  const bool closed = is_closed_body(patches.second);
  if (closed) {
    if (Status inside = check_stays_inside(patches.first, finder); !inside) return inside.error();
  }
  patches.beside_pole = closed && !goes_around_pole(patches.second, first_crossed.crossings);
  if (patches.beside_pole) {
    patches.second = start_at_nearer_pole(patches.second, first_crossed.crossings);
  } else {
    const Crossed second_crossed = cross_lines(patches.second, patches.first, CrossingFinder(patches.first));
    if (second_crossed.lines == 0) return not_crossed();
    if (second_crossed.before_votes > 0.0) patches.second = reverse_along_v(patches.second);
  }
  const Crossed crossed = cross_lines(patches.first, patches.second, CrossingFinder(patches.second));
  auto along = align_along(patches, crossed.crossings);
  if (!along) return along.error();
  patches.second = std::move(along).value();
  return patches;
}

CornerLines::CornerLines(const CrossingPatches& patches, double fillet_m)
    : patches_(&patches), second_(patches.second), fillet_m_(fillet_m) {
  SPOONBILL_ASSERT(fillet_m >= 0.0);
  choose_sides();
}

// Chooses the side of each surface on which the ball rolls: the side on which the kept part of the other
// surface is.
void CornerLines::choose_sides() {
  const Surface &first = patches_->first, &second = patches_->second;
  const std::vector<LineCrossing> crossings = cross_lines(first, second, second_).crossings;
  std::optional<LinesFromLoop> from_loop;
  if (patches_->beside_pole) from_loop.emplace(second, crossing_loop(crossings));
  const std::vector<double> lines = sample_lines(first);
  double on_first = 0.0, on_second = 0.0;
  for (std::size_t k = 0; k < std::min(lines.size(), crossings.size()); ++k) {
    const LineCrossing& at = crossings[k];
    const Vector3 direction_first = -evaluate(first, lines[k], at.along).dv.normalized();
    Vector3 direction_second = evaluate(second, at.other_u, at.other_v).dv.normalized();
    if (from_loop) {
      constexpr double little = 1e-3;
      const Eigen::Vector2d next = from_loop->at({at.other_u, at.other_v}, little);
      direction_second = (position(second, next.x(), next.y()) - at.point_m).normalized();
    }
    on_first += unit_normal(first, lines[k], at.along).dot(direction_second);
    on_second += unit_normal(second, at.other_u, at.other_v).dot(direction_first);
  }
  sides_ = {on_first < 0.0 ? -1 : 1, on_second < 0.0 ? -1 : 1};
}

const std::optional<CornerLine>& CornerLines::at(double u) {
  const auto known = lines_.find(u);
  return known != lines_.end() ? known->second : lines_.emplace(u, find(u)).first->second;
}

std::vector<Eigen::Vector2d> CornerLines::loop_on_second() {
  std::vector<Eigen::Vector2d> loop;
  for (const double u : sample_lines(patches_->first)) {
    if (const auto& line = at(u)) loop.emplace_back(line->second_u, line->second_v);
  }
  return loop;
}

std::optional<CornerLine> CornerLines::find(double u) const {
  const auto crossings = second_.intersect_line(patches_->first, u);
  if (crossings.empty()) return std::nullopt;
  const LineCrossing& crossing = crossings.front();
  if (fillet_m_ == 0.0) return CornerLine{crossing.along, crossing.other_u, crossing.other_v, {}};
  const auto contact = ball_contact(patches_->first, u, patches_->second, crossing, sides_, fillet_m_);
  if (!contact) return std::nullopt;
  return CornerLine{contact->v, contact->other_u, contact->other_v, contact->centre_m};
}

// Fraction of the tolerance for fitting each part: the kept part of a patch, or the fillet. The edges of two
// parts are then within twice this distance of each other; joining uses the rest of the tolerance. Parts that
// start beside a pole have a larger fraction, because their curvature is not aligned with their lines.
constexpr double part_fraction = 0.2, askew_fraction = 0.5;
// Fraction of the work that the fit of one part takes, for the progress. There are at most three parts.
constexpr double fitted_fraction = 0.25;

double interpolate(double from, double to, double fraction) {
  return from + (to - from) * fraction;
}

using LineShape = std::function<Vector3(double u, const CornerLine& line, double s)>;

// Shape of the kept part of a patch, or of the fillet. A point of it is given by u of the first patch, which
// selects a line of the part, and by the fraction of the length of this line.
struct PartShape {
  LineShape at;
  bool pole_at_start = false, pole_at_end = false;
  // For a line that starts beside a pole: the fraction of its length beyond which it follows a curve of
  // constant u of the patch.
  std::optional<double> bend = {};
};

// Smallest numbers of spans with which a fit starts: in the first attempt, and in a second one that resolves
// local detail.
constexpr int few_spans = 4, local_spans = 48;

Error not_fitted(const Error& error, double fraction, double tolerance_m) {
  return error.in("the kept part of a patch, whose fit may use " + short_length_text(fraction * tolerance_m) +
                  " of the tolerance of " + short_length_text(tolerance_m));
}

Error not_reached(bool with_fillet) {
  return Error(with_fillet ? ErrorCode::out_of_range : ErrorCode::mismatch,
               with_fillet
                   ? "a line of constant u does not reach the other patch, or the fillet's ball does not fit "
                     "there; choose a smaller fillet"
                   : "a line of constant u does not cross the other patch, or only touches it, for example "
                     "because one body enters the side of a body that is no wider than itself; make one "
                     "body wider, or move it",
               with_fillet ? "fillet" : "");
}

Result<FittedShape> fit_part(const Surface& first, CornerLines& lines, const PartShape& part,
                             bool with_fillet, double tolerance_m, const Progress& progress) {
  bool missed = false;
  ExactShape exact;
  exact.u = {first.u.is_periodic(), {first.u.domain_start(), first.u.domain_end()}};
  if (part.bend) exact.v.breaks = {0.0, *part.bend, 1.0};
  exact.pole_at_start = part.pole_at_start;
  exact.pole_at_end = part.pole_at_end;
  exact.at = [&](double u, double s) -> Vector3 {
    const auto& line = lines.at(u);
    if (!line) {
      missed = true;
      return position(first, u, first.v.domain_start());
    }
    return part.at(u, *line, s);
  };
  const double fraction = part.bend ? askew_fraction : part_fraction;
  ShapeFit fit;
  fit.tolerance_m = fraction * tolerance_m;
  fit.keeps_parameters = true;
  fit.min_spans = few_spans;
  constexpr double first_try = 0.5;
  fit.progress = progress.part(0.0, first_try);
  auto fitted = fit_shape(exact, fit);
  if (!progress.report(first_try)) return Progress::stopped();
  if (!fitted && !missed) {
    fit.progress = progress.part(first_try, 1.0);
    fit.min_spans = local_spans;
    fitted = fit_shape(exact, fit);
    if (!progress.report(1.0)) return Progress::stopped();
  }
  if (missed) return not_reached(with_fillet);
  if (!fitted) return not_fitted(fitted.error(), fraction, tolerance_m);
  return fitted;
}

// Returns a point on the arc about the ball's centre, at a fraction of the angle from one contact to the
// other.
Vector3 point_on_arc(const Vector3& from, const Vector3& to, const Vector3& centre, double fraction) {
  const Vector3 a = from - centre, b = to - centre;
  const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
  if (!(std::sin(angle) > 1e-12)) return (1.0 - fraction) * from + fraction * to;
  return centre + (std::sin((1.0 - fraction) * angle) * a + std::sin(fraction * angle) * b) / std::sin(angle);
}

struct Parts {
  std::vector<Surface> surfaces;
  double deviation_m = 0.0;
};

Result<Parts> fit_parts(const CrossingPatches& patches, const IntersectionRequest& request) {
  const Surface &first = patches.first, &second = patches.second;
  CornerLines lines(patches, request.fillet_m);
  const double first_start = first.v.domain_start(), second_end = second.v.domain_end();
  PartShape first_part, fillet_part, second_part;
  first_part.at = [&](double u, const CornerLine& line, double s) {
    return position(first, u, interpolate(first_start, line.first_v, s));
  };
  fillet_part.at = [&](double u, const CornerLine& line, double s) {
    return point_on_arc(position(first, u, line.first_v), position(second, line.second_u, line.second_v),
                        *line.centre_m, s);
  };
  second_part.at = [&](double, const CornerLine& line, double s) {
    return position(second, line.second_u, interpolate(line.second_v, second_end, s));
  };
  first_part.pole_at_start = is_tube(first) && is_pole(first, Side::v_start);
  second_part.pole_at_end = is_tube(second) && is_pole(second, Side::v_end);
  std::optional<LinesFromLoop> from_loop;
  if (patches.beside_pole) {
    from_loop.emplace(second, lines.loop_on_second());
    second_part.bend = from_loop->bend_fraction();
    second_part.at = [&](double, const CornerLine& line, double s) {
      const Eigen::Vector2d uv = from_loop->at({line.second_u, line.second_v}, s);
      return position(second, uv.x(), uv.y());
    };
  }
  Parts parts;
  for (const PartShape* part : {&first_part, &fillet_part, &second_part}) {
    if (part == &fillet_part && request.fillet_m == 0.0) continue;
    const double done = static_cast<double>(parts.surfaces.size());
    const Progress progress =
        request.join.progress.part(done * fitted_fraction, (done + 1.0) * fitted_fraction);
    auto fitted = fit_part(first, lines, *part, request.fillet_m > 0.0, request.join.tolerance_m, progress);
    if (!fitted) return fitted.error();
    parts.deviation_m = std::max(parts.deviation_m, fitted->deviation_m);
    parts.surfaces.push_back(std::move(fitted->surface));
  }
  return parts;
}

Error edges_apart(double apart_m, double tolerance_m) {
  return Error(ErrorCode::not_converged,
               "the kept parts of the patches should meet but are up to " + short_length_text(apart_m) +
                   " apart, too far for the tolerance of " + short_length_text(tolerance_m) +
                   "; choose a larger tolerance",
               "tolerance");
}

Status check_folds(const Surface& merged, const Surface& first, const Surface& second) {
  const auto fold = find_fold(merged);
  if (!fold || find_fold(first) || find_fold(second)) return {};
  return Error(
      ErrorCode::self_intersecting,
      "the merged surface folds over at " + position_text(*fold) +
          ": lines that lead away from the crossing run into each other there; let the other body enter "
          "nearer to a pole, or give the patches in the other order");
}

// Describes the joint from the end of the first part to the start of the last part.
Joint describe_corner(const Joined& joined) {
  Joint corner;
  for (const Joint& joint : joined.joints) corner.gap_m = std::max(corner.gap_m, joint.gap_m);
  corner.apart_m = corner.gap_m;
  corner.blend_start = joined.joints.front().blend_start;
  corner.blend_end = joined.joints.back().blend_end;
  corner.bridged = corner.blend_end > corner.blend_start;
  if (corner.bridged) {
    corner.blend_length_m = mean_length_m(joined.surface, corner.blend_start, corner.blend_end);
  }
  return corner;
}

// Returns true if the patch is a closed body whose normals point inwards.
bool is_inward(const Surface& patch) {
  if (!is_tube(patch)) return false;
  const auto [start, end] = tube_sides(patch);
  return is_pole(patch, start) && is_pole(patch, end) && compute_enclosed_mass(patch).volume_m3 < 0.0;
}

Result<IntersectionMerge> merge_outward(const Surface& first, const Surface& second,
                                        const IntersectionRequest& request) {
  const auto patches = orient_for_crossing(first, second);
  if (!patches) return patches.error();
  auto parts = fit_parts(patches.value(), request);
  if (!parts) return parts.error();
  const double before_m = parts->deviation_m;
  JoinRequest join = request.join;
  join.tolerance_m -= before_m;
  join.blend_m = 0.0;
  join.progress = request.join.progress.part(3.0 * fitted_fraction, 1.0);
  join.shared_parameters = true;
  if (request.fillet_m == 0.0) join.continuity = 0;
  auto joined = join_row(std::move(parts->surfaces), join);
  if (!joined) return joined.error();
  for (const Joint& joint : joined->joints) {
    if (joint.bridged) return edges_apart(joint.apart_m, request.join.tolerance_m);
  }
  if (Status sound = check_folds(joined->surface, first, second); !sound) return sound.error();
  const Joint corner = describe_corner(joined.value());
  return IntersectionMerge{std::move(joined->surface), before_m + joined->deviation_m, corner};
}

}  // namespace

Result<IntersectionMerge> merge_crossing(const Surface& first, const Surface& second,
                                         const IntersectionRequest& request) {
  SPOONBILL_ASSERT(request.fillet_m >= 0.0);
  SPOONBILL_ASSERT_DEBUG(is_valid(first) && is_valid(second));
  const bool first_inward = is_inward(first), second_inward = is_inward(second);
  auto merged = merge_outward(first_inward ? reversed(first, Direction::u) : first,
                              second_inward ? reversed(second, Direction::u) : second, request);
  if (!merged) return merged;
  merged->first_was_inward = first_inward;
  merged->second_was_inward = second_inward;
  return merged;
}

}  // namespace spoonbill
