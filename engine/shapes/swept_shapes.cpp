#include "engine/shapes/swept_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

namespace {

constexpr int frames = 2048;
// Largest extent of a tube's section toward the centre of a bend, as a fraction of the bend's radius. If it
// were closer to 1, the inner side of the bend would almost fold.
constexpr double max_bend_fraction = 0.98;

struct SweepFrame {
  Vector3 position, along, across;  // `along` and `across` are unit vectors

  Vector3 up() const { return along.cross(across); }
};

Vector3 reflect(const Vector3& vector, const Vector3& by) {
  const double squared = by.squaredNorm();
  return squared > 0.0 ? Vector3(vector - 2.0 / squared * by.dot(vector) * by) : vector;
}

// Returns the frame at a nearby position of the curve, rotated as little as possible about the tangent.
SweepFrame transport(const SweepFrame& from, const Vector3& position, const Vector3& along) {
  const Vector3 step = position - from.position;
  const Vector3 across = reflect(from.across, step), tangent = reflect(from.along, step);
  SweepFrame to{position, along, reflect(across, along - tangent)};
  to.across = (to.across - to.across.dot(along) * along).normalized();
  return to;
}

class SweptTube {
 public:
  SweptTube(const TubeSize& size) : size_(size), end_m_(std::min(size.half_width_m, size.half_height_m)) {
    const Vector3 along = tangent(0.0);
    const Vector3 level = along.cross(Vector3::UnitY());
    SweepFrame frame{size.centre_line.at(0.0), along,
                     level.norm() > 1e-6 ? Vector3(level.normalized()) : Vector3(Vector3::UnitX())};
    frame.across = (frame.across - frame.across.dot(along) * along).normalized();
    frames_.push_back(frame);
    for (int k = 1; k <= frames; ++k) {
      const double t = size.centre_line.end() * k / frames;
      frames_.push_back(transport(frames_.back(), size.centre_line.at(t), tangent(t)));
    }
  }

  double cap_m() const { return 0.5 * std::numbers::pi * end_m_; }
  double length_m() const { return size_.centre_line.end() + 2.0 * cap_m(); }

  SweepFrame frame_at(double t) const {
    const double step = size_.centre_line.end() / frames;
    const auto k = static_cast<std::size_t>(std::clamp(std::floor(t / step), 0.0, frames - 1.0));
    return transport(frames_[k], size_.centre_line.at(t), tangent(t));
  }

  Vector3 at(double u, double v) const {
    const double distance = v * length_m() - cap_m(), end = size_.centre_line.end();
    const SweepFrame frame = frame_at(std::clamp(distance, 0.0, end));
    const double beyond = distance < 0.0 ? distance : distance > end ? distance - end : 0.0;
    const double angle = beyond / end_m_;
    const double wide = v <= 0.0 || v >= 1.0 ? 0.0 : std::cos(angle), around = 2.0 * std::numbers::pi * u;
    return frame.position +
           wide * (size_.half_width_m * std::cos(around) * frame.across +
                   size_.half_height_m * std::sin(around) * frame.up()) +
           end_m_ * std::sin(angle) * frame.along;
  }

  // Returns the section's extent toward the centre of the bend, divided by the radius of the bend.
  double bend_fraction(double t) const {
    const Vector3 first = size_.centre_line.first_derivative(t),
                  second = size_.centre_line.second_derivative(t);
    const double speed = first.squaredNorm();
    const Vector3 bend = (second - second.dot(first) / speed * first) / speed;
    const SweepFrame frame = frame_at(t);
    return std::hypot(size_.half_width_m * bend.dot(frame.across),
                      size_.half_height_m * bend.dot(frame.up()));
  }

 private:
  Vector3 tangent(double t) const { return size_.centre_line.first_derivative(t).normalized(); }

  TubeSize size_;
  double end_m_;
  std::vector<SweepFrame> frames_;
};

}  // namespace

Result<ExactShape> tube_shape(const TubeSize& size) {
  if (Status status = check_size("half the tube's width", size.half_width_m); !status) return status.error();
  if (Status status = check_size("half the tube's height", size.half_height_m); !status) {
    return status.error();
  }
  if (Status status = check_size("the tube's length", size.centre_line.end()); !status) return status.error();
  const auto tube = std::make_shared<const SweptTube>(size);
  double worst = 0.0, sharpest = 0.0;
  for (int k = 0; k <= frames; ++k) {
    const double t = size.centre_line.end() * k / frames, fraction = tube->bend_fraction(t);
    if (fraction > worst) sharpest = t;
    worst = std::max(worst, fraction);
  }
  if (worst > max_bend_fraction) {
    return Error{ErrorCode::self_intersecting,
                 "the tube folds where its centre line bends most sharply, at " +
                     position_text(size.centre_line.at(sharpest)) + ": make its section at most " +
                     number_text(std::max(1.0, std::floor(100.0 * max_bend_fraction / worst))) +
                     " % as wide, or the bend wider"};
  }
  ExactShape shape;
  shape.u.periodic = true;
  const double cap = tube->cap_m() / tube->length_m();
  shape.v.breaks = {0.0, cap, 1.0 - cap, 1.0};
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [tube](double u, double v) { return tube->at(u, v); };
  return shape;
}

namespace {

// Number of evenly spaced points at which each section is sampled.
constexpr int around = 256;
constexpr int length_steps = 4096;
// A Bezier cubic approximates a quarter circle if each inner control point has this distance from the nearest
// end point, as a fraction of the radius (Goldapp 1991).
constexpr double arc_handle = 0.5522847498;
constexpr double default_bulge = 0.5;

using Section = std::vector<Vector3>;

Section sample_evenly(const SmoothCurve& curve, int count) {
  std::vector<double> lengths = {0.0};
  Vector3 before = curve.at(0.0);
  for (int k = 1; k <= length_steps; ++k) {
    const Vector3 point = curve.at(curve.end() * k / length_steps);
    lengths.push_back(lengths.back() + (point - before).norm());
    before = point;
  }
  Section points;
  const int last = curve.closed() ? count : count - 1;
  std::size_t step = 1;
  for (int k = 0; k < count; ++k) {
    const double wanted = lengths.back() * k / last;
    while (step + 1 < lengths.size() && lengths[step] < wanted) ++step;
    const double fraction = (wanted - lengths[step - 1]) / (lengths[step] - lengths[step - 1]);
    const double at = static_cast<double>(step - 1) + std::clamp(fraction, 0.0, 1.0);
    points.push_back(curve.at(curve.end() * std::min(at / length_steps, 1.0)));
  }
  return points;
}

Vector3 compute_centroid(const Section& section) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& point : section) sum += point;
  return sum / static_cast<double>(section.size());
}

double mean_radius(const Section& section) {
  const Vector3 centroid = compute_centroid(section);
  double sum = 0.0;
  for (const Vector3& point : section) sum += (point - centroid).norm();
  return sum / static_cast<double>(section.size());
}

bool is_point(const Section& section) {
  return std::all_of(section.begin(), section.end(),
                     [&](const Vector3& point) { return point == section.front(); });
}

double squared_distance(const Section& a, const Section& b, std::size_t start, bool backwards) {
  double sum = 0.0;
  const Vector3 shift = compute_centroid(a) - compute_centroid(b);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::size_t other = backwards ? start + a.size() - k : start + k;
    sum += (b[other % b.size()] + shift - a[k]).squaredNorm();
  }
  return sum;
}

// Reorders the points of a section to match the section `before`. May reverse the order and, if the section
// is closed, start at another point. The new order minimises the sum of squared distances between points with
// the same index, with the centroids of both sections moved to the origin.
void align_to(const Section& before, Section& section, bool closed) {
  std::size_t best_start = 0;
  bool best_backwards = false;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t start = 0; start < (closed ? section.size() : 1); ++start) {
    for (const bool backwards : {false, true}) {
      const std::size_t from = !closed && backwards ? section.size() - 1 : start;
      const double distance = squared_distance(before, section, from, backwards);
      if (distance < least * (1.0 - 1e-9)) {
        least = distance;
        best_start = from;
        best_backwards = backwards;
      }
    }
  }
  Section aligned;
  for (std::size_t k = 0; k < section.size(); ++k) {
    aligned.push_back(
        section[(best_backwards ? best_start + section.size() - k : best_start + k) % section.size()]);
  }
  section = std::move(aligned);
}

Result<std::vector<Section>> even_sections(const LoftSections& loft) {
  std::vector<Section> sections;
  for (std::size_t s = 0; s < loft.sections_m.size(); ++s) {
    const Section& points = loft.sections_m[s];
    const bool at_end = s == 0 || s + 1 == loft.sections_m.size();
    if (points.size() == 1 && at_end && loft.closed) {
      sections.emplace_back(static_cast<std::size_t>(around), points[0]);
      continue;
    }
    const auto curve = SmoothCurve::through(points, loft.closed);
    if (!curve) return curve.error().in("section " + std::to_string(s + 1));
    if (Status status = check_size("the length of section " + std::to_string(s + 1), curve->end()); !status) {
      return status.error();
    }
    sections.push_back(sample_evenly(curve.value(), around));
  }
  const Section* before = nullptr;
  for (Section& section : sections) {
    if (is_point(section)) continue;
    if (before != nullptr) align_to(*before, section, loft.closed);
    before = &section;
  }
  return sections;
}

// The sides of a loft. Splines across the sections run through the points with the same index. Further
// splines, along the sections, interpolate between the splines across the sections.
class LoftSides {
 public:
  LoftSides(const std::vector<Section>& sections, bool closed) {
    parameters_ = {0.0};
    for (std::size_t s = 1; s < sections.size(); ++s) {
      double sum = 0.0;
      for (int k = 0; k < around; ++k) {
        const auto index = static_cast<std::size_t>(k);
        sum += (sections[s][index] - sections[s - 1][index]).norm();
      }
      parameters_.push_back(parameters_.back() + sum / around);
    }
    std::vector<double> fractions;
    fractions.reserve(static_cast<std::size_t>(around) + 1);
    for (int k = 0; k < around + (closed ? 1 : 0); ++k) {
      fractions.push_back(static_cast<double>(k) / (closed ? around : around - 1));
    }
    std::vector<Section> second(sections.size(), Section(around));
    for (std::size_t index = 0; index < static_cast<std::size_t>(around); ++index) {
      Section line;
      line.reserve(sections.size());
      for (const Section& section : sections) line.push_back(section[index]);
      const SmoothCurve across = SmoothCurve::at_parameters(line, parameters_, false);
      for (std::size_t s = 0; s < sections.size(); ++s) second[s][index] = across.second_derivatives()[s];
    }
    for (std::size_t s = 0; s < sections.size(); ++s) {
      points_.push_back(SmoothCurve::at_parameters(sections[s], fractions, closed));
      second_.push_back(SmoothCurve::at_parameters(second[s], fractions, closed));
    }
  }

  double length_m() const { return parameters_.back(); }

  Vector3 at(double u, double t) const {
    const auto [s, length, b] = find_piece(t);
    const double a = 1.0 - b, scale = length * length / 6.0;
    return a * points_[s].at(u) + b * points_[s + 1].at(u) +
           scale * ((a * a * a - a) * second_[s].at(u) + (b * b * b - b) * second_[s + 1].at(u));
  }

  // Returns the derivative with respect to t. The parameter t is 0 at the first section and grows from one
  // section to the next by their mean distance.
  Vector3 across(double u, double t) const {
    const auto [s, length, b] = find_piece(t);
    const double a = 1.0 - b;
    return (points_[s + 1].at(u) - points_[s].at(u)) / length +
           length / 6.0 *
               ((1.0 - 3.0 * a * a) * second_[s].at(u) + (3.0 * b * b - 1.0) * second_[s + 1].at(u));
  }

 private:
  struct Location {
    std::size_t section;
    double length, fraction;
  };
  Location find_piece(double t) const {
    const auto after = std::upper_bound(parameters_.begin() + 1, parameters_.end() - 1, t);
    const std::size_t s = static_cast<std::size_t>(after - parameters_.begin()) - 1;
    const double length = parameters_[s + 1] - parameters_[s];
    return {s, length, std::clamp((t - parameters_[s]) / length, 0.0, 1.0)};
  }

  std::vector<double> parameters_;
  std::vector<SmoothCurve> points_, second_;
};

// A cap over an end of the sides of a loft, from the end ring to a pole. Each line of constant u is a cubic
// that continues the tangent of the sides and meets the pole perpendicular to the pole's normal.
class LoftCap {
 public:
  LoftCap(std::shared_ptr<const LoftSides> sides, bool at_end, std::optional<double> height_m)
      : sides_(std::move(sides)), at_end_(at_end) {
    Section ring;
    outward_.setZero();
    for (int k = 0; k < around; ++k) {
      const double u = static_cast<double>(k) / around;
      ring.push_back(sides_->at(u, rim()));
      outward_ += leaving(u);
    }
    outward_.normalize();
    const double radius = mean_radius(ring);
    height_m_ = height_m.value_or(default_bulge * radius);
    pole_ = compute_centroid(ring) + height_m_ * outward_;
    // This approximates the length of a quarter of an ellipse. The error is 3 % at the default height and at
    // most 22 %.
    length_m_ = 0.25 * std::numbers::pi * (radius + height_m_);
  }

  double length_m() const { return length_m_; }

  // Returns the point on the line of constant u at a fraction of the cap: 0 at the end ring, 1 at the pole.
  Vector3 at(double u, double fraction) const {
    const Vector3 start = sides_->at(u, rim()), tangent = leaving(u);
    const double slope = std::max(tangent.dot(outward_), 0.2);
    const Vector3 radial = (start - pole_) - outward_.dot(start - pole_) * outward_;
    const Vector3 b = start + arc_handle * height_m_ / slope * tangent, c = pole_ + arc_handle * radial;
    const double s = fraction, r = 1.0 - fraction;
    return r * r * r * start + 3.0 * r * r * s * b + 3.0 * r * s * s * c + s * s * s * pole_;
  }

 private:
  double rim() const { return at_end_ ? sides_->length_m() : 0.0; }
  Vector3 leaving(double u) const { return (at_end_ ? 1.0 : -1.0) * sides_->across(u, rim()).normalized(); }

  std::shared_ptr<const LoftSides> sides_;
  bool at_end_;
  double height_m_ = 0.0, length_m_ = 0.0;
  Vector3 outward_ = Vector3::Zero(), pole_ = Vector3::Zero();
};

struct Loft {
  std::shared_ptr<const LoftSides> sides;
  std::optional<LoftCap> first, last;
  bool backwards = false;  // true if u is reversed

  double first_m() const { return first ? first->length_m() : 0.0; }
  double last_m() const { return last ? last->length_m() : 0.0; }
  double length_m() const { return first_m() + sides->length_m() + last_m(); }

  Vector3 at(double u, double v) const {
    if (backwards) u = 1.0 - u;
    const double distance = v * length_m(), beyond = distance - first_m() - sides->length_m();
    if (first && distance < first_m()) return first->at(u, 1.0 - distance / first_m());
    if (last && beyond > 0.0) return last->at(u, std::min(beyond / last_m(), 1.0));
    return sides->at(u, distance - first_m());
  }
};

double enclosed_sign(const Loft& loft) {
  constexpr int steps = 64;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const auto at = [&](int a, int b) {
        return loft.at(static_cast<double>(a) / steps, static_cast<double>(b) / steps);
      };
      const Vector3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      sum += a.dot(b.cross(c)) + a.dot(c.cross(d));
    }
  }
  return sum;
}

}  // namespace

Result<ExactShape> loft_shape(LoftSections sections) {
  if (sections.sections_m.size() < 2) return Error{ErrorCode::too_few, "a loft needs at least 2 sections"};
  if (sections.cap_m) {
    if (Status status = check_size("the caps' height", *sections.cap_m); !status) return status.error();
  }
  const auto evened = even_sections(sections);
  if (!evened) return evened.error();
  const std::vector<Section>& even = evened.value();
  const bool first_point = is_point(even.front()), last_point = is_point(even.back());
  if (first_point && last_point && even.size() == 2)
    return Error{ErrorCode::degenerate, "a loft between two points has no area; add a section between them"};
  for (std::size_t s = 1; s < even.size(); ++s) {
    if ((compute_centroid(even[s]) - compute_centroid(even[s - 1])).norm() > 0.0) continue;
    return Error{ErrorCode::degenerate, "sections " + std::to_string(s) + " and " + std::to_string(s + 1) +
                                            " have the same centre; remove one of them"};
  }
  const auto loft = std::make_shared<Loft>();
  loft->sides = std::make_shared<const LoftSides>(even, sections.closed);
  const bool capped = sections.closed && sections.caps;
  if (capped && !first_point) loft->first.emplace(loft->sides, false, sections.cap_m);
  if (capped && !last_point) loft->last.emplace(loft->sides, true, sections.cap_m);
  ExactShape shape;
  shape.u.periodic = sections.closed;
  shape.pole_at_start = first_point || loft->first.has_value();
  shape.pole_at_end = last_point || loft->last.has_value();
  loft->backwards = shape.pole_at_start && shape.pole_at_end && enclosed_sign(*loft) < 0.0;
  shape.v.breaks = {0.0};
  if (loft->first) shape.v.breaks.push_back(loft->first_m() / loft->length_m());
  if (loft->last) shape.v.breaks.push_back(1.0 - loft->last_m() / loft->length_m());
  shape.v.breaks.push_back(1.0);
  shape.at = [loft](double u, double v) { return loft->at(u, v); };
  return shape;
}

}  // namespace spoonbill
