#include "render/tessellation/sampling_level.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr std::array<int, 10> piece_steps = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};

// Too coarse by less, or too fine by no more than this is kept; see choose_sampling_level().
constexpr double tolerated_excess = 1.15;
constexpr double tolerated_waste = 0.4;

// The control points along one line of the net, in the order of the basis functions, a periodic line
// unrolled.
class NetLine {
 public:
  NetLine(const SurfaceSnapshot& surface, bool along_u, int across)
      : surface_(surface),
        count_((along_u ? surface.u : surface.v).control_point_count()),
        start_(along_u ? across : across * surface.v.control_point_count()),
        stride_(along_u ? surface.v.control_point_count() : 1) {}

  Vector3 operator[](int i) const {
    const auto at = static_cast<std::size_t>(start_ + (i % count_) * stride_);
    return {surface_.x[at], surface_.y[at], surface_.z[at]};
  }

 private:
  const SurfaceSnapshot& surface_;
  int count_;
  int start_;
  int stride_;
};

// For each control point of the derivatives, the greatest size over all lines of the net: of S' in metres by
// parameter, and of the part of S'' across S', which bends a line rather than hastens it.
struct DerivativeBounds {
  std::vector<double> speed;  // control point i acts on spans i + 1 to i + degree
  std::vector<double> bend;   // control point i acts on spans i + 2 to i + degree
};

void include_line(const NetLine& line, const KnotVector& knots, DerivativeBounds& bounds) {
  const auto& t = knots.extended_knots();
  const int p = knots.degree();
  Vector3 before = Vector3::Zero();
  for (int i = 0; i < static_cast<int>(bounds.speed.size()); ++i) {
    const double width = t[i + p + 1] - t[i + 1];
    const Vector3 slope = width > 0.0 ? Vector3((line[i + 1] - line[i]) * (p / width)) : before;
    bounds.speed[i] = std::max(bounds.speed[i], slope.norm());
    const double inner_width = t[i + p] - t[i + 1];
    if (i > 0 && p > 1 && inner_width > 0.0) {
      const Vector3 second = (slope - before) * ((p - 1) / inner_width);
      const Vector3 way = (slope + before).normalized();
      bounds.bend[i - 1] = std::max(bounds.bend[i - 1], (second - way * way.dot(second)).norm());
    }
    before = slope;
  }
}

DerivativeBounds derivative_bounds(const SurfaceSnapshot& surface, bool along_u) {
  const KnotVector& knots = along_u ? surface.u : surface.v;
  const int lines = (along_u ? surface.v : surface.u).control_point_count();
  const std::size_t slopes = knots.extended_knots().size() - static_cast<std::size_t>(knots.degree()) - 2;
  DerivativeBounds bounds{std::vector<double>(slopes), std::vector<double>(slopes)};
  for (int across = 0; across < lines; ++across) {
    include_line(NetLine(surface, along_u, across), knots, bounds);
  }
  return bounds;
}

// The greatest of the control points that act on a span.
double greatest(const std::vector<double>& values, int first, int last) {
  double greatest = 0.0;
  for (int i = std::max(first, 0); i <= last && i < static_cast<int>(values.size()); ++i) {
    greatest = std::max(greatest, values[static_cast<std::size_t>(i)]);
  }
  return greatest;
}

int choose_pieces(double needed, int previous) {
  if (previous > 0 && needed <= previous * tolerated_excess && needed > previous * tolerated_waste) {
    return previous;
  }
  const auto step = std::lower_bound(piece_steps.begin(), piece_steps.end(), needed);
  return step == piece_steps.end() ? piece_steps.back() : *step;
}

std::vector<int> pieces_along(const SurfaceSnapshot& surface, bool along_u, double pixels_per_metre,
                              const std::vector<int>& previous, const SamplingTarget& target) {
  const KnotVector& knots = along_u ? surface.u : surface.v;
  const DerivativeBounds bounds = derivative_bounds(surface, along_u);
  const std::vector<double> breakpoints = knots.breakpoints();
  const std::size_t spans = breakpoints.size() - 1;
  std::vector<int> pieces(spans);
  for (std::size_t s = 0; s < spans; ++s) {
    const double width = breakpoints[s + 1] - breakpoints[s];
    const int k = knots.find_span(0.5 * (breakpoints[s] + breakpoints[s + 1]));
    const double speed = greatest(bounds.speed, k - knots.degree(), k - 1);
    const double bend = greatest(bounds.bend, k - knots.degree(), k - 2);
    const double edge_px = speed * width * pixels_per_metre;
    // A chord over a parameter width h lies within h^2 |S''| / 8 of its arc.
    const double sagitta_px = bend * width * width / 8.0 * pixels_per_metre;
    const double needed =
        std::max(edge_px / target.longest_edge_px, std::sqrt(sagitta_px / target.largest_sagitta_px));
    pieces[s] = choose_pieces(needed, previous.size() == spans ? previous[s] : 0);
  }
  return pieces;
}

std::int64_t pieces_below(const std::vector<int>& pieces, int most) {
  std::int64_t sum = 0;
  for (const int count : pieces) sum += std::min(count, most);
  return sum;
}

// Takes pieces from the spans that have most, until there are no more cells than can be drawn.
void thin(SamplingLevel& level) {
  auto most = piece_steps.rbegin();
  while (std::next(most) != piece_steps.rend() &&
         pieces_below(level.u_pieces, *most) * pieces_below(level.v_pieces, *most) > sampling_cell_limit) {
    ++most;
  }
  for (std::vector<int>* pieces : {&level.u_pieces, &level.v_pieces}) {
    for (int& count : *pieces) count = std::min(count, *most);
  }
}

}  // namespace

SamplingLevel uniform_sampling_level(const SurfaceSnapshot& surface, int pieces) {
  SPOONBILL_ASSERT(pieces >= 1);
  return {std::vector<int>(surface.u.breakpoints().size() - 1, pieces),
          std::vector<int>(surface.v.breakpoints().size() - 1, pieces)};
}

SamplingLevel choose_sampling_level(const SurfaceSnapshot& surface, double pixels_per_metre,
                                    const SamplingLevel& previous, const SamplingTarget& target) {
  SPOONBILL_ASSERT(surface.x.size() == static_cast<std::size_t>(surface.u.control_point_count()) *
                                           surface.v.control_point_count());
  SamplingLevel level{pieces_along(surface, true, pixels_per_metre, previous.u_pieces, target),
                      pieces_along(surface, false, pixels_per_metre, previous.v_pieces, target)};
  thin(level);
  return level;
}

std::vector<double> drawing_parameters(const KnotVector& knots, const std::vector<int>& pieces) {
  SPOONBILL_ASSERT(pieces.size() + 1 == knots.breakpoints().size());
  const std::vector<double> breakpoints = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t s = 0; s + 1 < breakpoints.size(); ++s) {
    const double width = breakpoints[s + 1] - breakpoints[s];
    for (int i = 0; i < pieces[s]; ++i) parameters.push_back(breakpoints[s] + width * i / pieces[s]);
  }
  if (!knots.is_periodic()) parameters.push_back(breakpoints.back());
  return parameters;
}

}  // namespace spoonbill
