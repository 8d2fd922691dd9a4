#include "engine/shapes/loft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "engine/shapes/shape_sizes.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

namespace {

// Each section is taken at so many places, evenly along it.
constexpr int around = 256;
constexpr int length_steps = 4096;
// Of a quarter circle by a cubic (Goldapp 1991).
constexpr double arc_handle = 0.5522847498;
constexpr double usual_bulge = 0.5;

using Section = std::vector<Vector3>;

Section evenly(const SmoothCurve& curve, int count) {
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
    const double share = (wanted - lengths[step - 1]) / (lengths[step] - lengths[step - 1]);
    const double at = static_cast<double>(step - 1) + std::clamp(share, 0.0, 1.0);
    points.push_back(curve.at(curve.end() * std::min(at / length_steps, 1.0)));
  }
  return points;
}

Vector3 middle_of(const Section& section) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& point : section) sum += point;
  return sum / static_cast<double>(section.size());
}

double mean_radius(const Section& section) {
  const Vector3 middle = middle_of(section);
  double sum = 0.0;
  for (const Vector3& point : section) sum += (point - middle).norm();
  return sum / static_cast<double>(section.size());
}

bool is_point(const Section& section) {
  return std::all_of(section.begin(), section.end(),
                     [&](const Vector3& point) { return point == section.front(); });
}

double apart(const Section& a, const Section& b, std::size_t start, bool backwards) {
  double sum = 0.0;
  const Vector3 shift = middle_of(a) - middle_of(b);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::size_t other = backwards ? start + a.size() - k : start + k;
    sum += (b[other % b.size()] + shift - a[k]).squaredNorm();
  }
  return sum;
}

// So that each point of `section` is near the one of `before` with its number, their middles laid together.
void lay_to(const Section& before, Section& section, bool closed) {
  std::size_t best_start = 0;
  bool best_backwards = false;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t start = 0; start < (closed ? section.size() : 1); ++start) {
    for (const bool backwards : {false, true}) {
      const std::size_t from = !closed && backwards ? section.size() - 1 : start;
      const double distance = apart(before, section, from, backwards);
      if (distance < least * (1.0 - 1e-9)) {
        least = distance;
        best_start = from;
        best_backwards = backwards;
      }
    }
  }
  Section laid;
  for (std::size_t k = 0; k < section.size(); ++k) {
    laid.push_back(
        section[(best_backwards ? best_start + section.size() - k : best_start + k) % section.size()]);
  }
  section = std::move(laid);
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
    if (!curve) return Error{"section " + std::to_string(s + 1) + ": " + curve.error().message};
    if (Status status = check_size("the length of section " + std::to_string(s + 1), curve->end()); !status) {
      return status.error();
    }
    sections.push_back(evenly(curve.value(), around));
  }
  const Section* before = nullptr;
  for (Section& section : sections) {
    if (is_point(section)) continue;
    if (before != nullptr) lay_to(*before, section, loft.closed);
    before = &section;
  }
  return sections;
}

// The sides: splines across the sections through each of their places, and along the sections between these.
class LoftSides {
 public:
  LoftSides(const std::vector<Section>& sections, bool closed) {
    parameters_ = {0.0};
    for (std::size_t s = 1; s < sections.size(); ++s) {
      double sum = 0.0;
      for (int k = 0; k < around; ++k) {
        const auto place = static_cast<std::size_t>(k);
        sum += (sections[s][place] - sections[s - 1][place]).norm();
      }
      parameters_.push_back(parameters_.back() + sum / around);
    }
    std::vector<double> shares;
    shares.reserve(static_cast<std::size_t>(around) + 1);
    for (int k = 0; k < around + (closed ? 1 : 0); ++k) {
      shares.push_back(static_cast<double>(k) / (closed ? around : around - 1));
    }
    std::vector<Section> bends(sections.size(), Section(around));
    for (std::size_t place = 0; place < static_cast<std::size_t>(around); ++place) {
      Section line;
      line.reserve(sections.size());
      for (const Section& section : sections) line.push_back(section[place]);
      const SmoothCurve across = SmoothCurve::at_parameters(line, parameters_, false);
      for (std::size_t s = 0; s < sections.size(); ++s) bends[s][place] = across.bends()[s];
    }
    for (std::size_t s = 0; s < sections.size(); ++s) {
      points_.push_back(SmoothCurve::at_parameters(sections[s], shares, closed));
      bends_.push_back(SmoothCurve::at_parameters(bends[s], shares, closed));
    }
  }

  double length_m() const { return parameters_.back(); }

  Vector3 at(double u, double t) const {
    const auto [s, length, b] = place_of(t);
    const double a = 1.0 - b, scale = length * length / 6.0;
    return a * points_[s].at(u) + b * points_[s + 1].at(u) +
           scale * ((a * a * a - a) * bends_[s].at(u) + (b * b * b - b) * bends_[s + 1].at(u));
  }

  // By the way across.
  Vector3 across(double u, double t) const {
    const auto [s, length, b] = place_of(t);
    const double a = 1.0 - b;
    return (points_[s + 1].at(u) - points_[s].at(u)) / length +
           length / 6.0 * ((1.0 - 3.0 * a * a) * bends_[s].at(u) + (3.0 * b * b - 1.0) * bends_[s + 1].at(u));
  }

 private:
  struct Place {
    std::size_t section;
    double length, share;
  };
  Place place_of(double t) const {
    const auto after = std::upper_bound(parameters_.begin() + 1, parameters_.end() - 1, t);
    const std::size_t s = static_cast<std::size_t>(after - parameters_.begin()) - 1;
    const double length = parameters_[s + 1] - parameters_[s];
    return {s, length, std::clamp((t - parameters_[s]) / length, 0.0, 1.0)};
  }

  std::vector<double> parameters_;
  std::vector<SmoothCurve> points_, bends_;
};

// A bulge over an end of the sides, from the ring to a pole: along each line a cubic that leaves the sides by
// their tangent and comes to the pole across its normal.
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
    height_m_ = height_m.value_or(usual_bulge * radius);
    pole_ = middle_of(ring) + height_m_ * outward_;
    // A quarter of an ellipse, to a few percent.
    length_m_ = 0.25 * std::numbers::pi * (radius + height_m_);
  }

  double length_m() const { return length_m_; }

  // From the ring, 0, to the pole, 1.
  Vector3 at(double u, double share) const {
    const Vector3 start = sides_->at(u, rim()), tangent = leaving(u);
    const double slope = std::max(tangent.dot(outward_), 0.2);
    const Vector3 radial = (start - pole_) - outward_.dot(start - pole_) * outward_;
    const Vector3 b = start + arc_handle * height_m_ / slope * tangent, c = pole_ + arc_handle * radial;
    const double s = share, r = 1.0 - share;
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
  bool backwards = false;  // in u

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
  if (sections.sections_m.size() < 2) return Error{"a loft needs at least 2 sections"};
  if (sections.cap_m) {
    if (Status status = check_size("the caps' height", *sections.cap_m); !status) return status.error();
  }
  const auto evened = even_sections(sections);
  if (!evened) return evened.error();
  const std::vector<Section>& even = evened.value();
  const bool first_point = is_point(even.front()), last_point = is_point(even.back());
  if (first_point && last_point && even.size() == 2) return Error{"a loft between two points is none"};
  for (std::size_t s = 1; s < even.size(); ++s) {
    if ((middle_of(even[s]) - middle_of(even[s - 1])).norm() > 0.0) continue;
    return Error{"sections " + std::to_string(s) + " and " + std::to_string(s + 1) +
                 " have their middles in one place; leave one out"};
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
