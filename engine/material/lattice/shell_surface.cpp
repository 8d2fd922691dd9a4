#include "engine/material/lattice/shell_surface.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr int edge_samples = 32;
// Of the control net's extent: shorter edges are points.
constexpr double point_share = 1e-6;

std::vector<double> shares_of(const KnotVector& knots, int least) {
  const std::vector<double> breaks = knots.breakpoints();
  const int pieces = static_cast<int>(breaks.size()) - 1, parts = (least + pieces - 1) / pieces;
  const double start = breaks.front(), length = breaks.back() - start;
  std::vector<double> shares;
  for (int piece = 0; piece < pieces; ++piece) {
    const auto at = static_cast<std::size_t>(piece);
    for (int part = 0; part < parts; ++part) {
      shares.push_back((breaks[at] + (breaks[at + 1] - breaks[at]) * part / parts - start) / length);
    }
  }
  shares.push_back(1.0);
  return shares;
}

double extent_of(const ControlNet& net) {
  double extent = 0.0;
  for (const std::vector<double>* axis : {&net.x, &net.y, &net.z}) {
    const auto [low, high] = std::minmax_element(axis->begin(), axis->end());
    extent = std::max(extent, *high - *low);
  }
  return extent;
}

}  // namespace

Result<ShellSurface> ShellSurface::make(const Surface& surface) {
  const bool around_u = surface.u.is_periodic(), around_v = surface.v.is_periodic();
  if (around_u && around_v) {
    return Error{"surface: periodic in u and v; a shell can close in one direction only, open the other"};
  }
  ShellSurface face(surface);
  face.swapped_ = around_v;
  face.form_ = around_u || around_v ? Form::ring : Form::sheet;
  int points = 0;
  for (const double end : {0.0, 1.0}) {
    std::vector<Place> rim, side;
    for (int s = 0; s <= edge_samples; ++s) {
      const double share = static_cast<double>(s) / edge_samples;
      rim.push_back({share, end});
      side.push_back({end, share});
    }
    if (face.is_point(rim)) {
      ++points;
      face.pole_at_end_ = end == 1.0;
    }
    if (face.form_ == Form::sheet && face.is_point(side)) ++points;
  }
  if (points > 0 && face.form_ == Form::sheet) {
    return Error{
        "surface: an edge of a shell that is open in u and v shrinks to a point; give it some length, or "
        "close "
        "the surface around that point"};
  }
  if (points > 1) {
    return Error{
        "surface: a shell can have a pole at one end only; open the other, or leave shell_thickness_mm out "
        "for "
        "a solid body"};
  }
  if (points == 1 && face.swapped_) {
    return Error{"surface: a shell's pole must be at an end of v; swap u and v"};
  }
  if (points == 1) face.form_ = Form::bowl;
  return face;
}

bool ShellSurface::is_point(const std::vector<Place>& line) const {
  const Vector3 first = position_m(line.front());
  double farthest = 0.0;
  for (const Place& place : line) farthest = std::max(farthest, (position_m(place) - first).norm());
  return farthest <= point_share * extent_of(surface_->net);
}

ShellSurface::Parameters ShellSurface::parameters(const Place& place) const {
  const auto at = [](const KnotVector& knots, double share) {
    if (share == 1.0 && !knots.is_periodic()) return knots.domain_end();
    return knots.domain_start() + share * (knots.domain_end() - knots.domain_start());
  };
  const double along = form_ == Form::bowl && pole_at_end_ ? 1.0 - place.along : place.along;
  const double first = at(across_knots(), place.across), second = at(along_knots(), along);
  return swapped_ ? Parameters{second, first} : Parameters{first, second};
}

Vector3 ShellSurface::position_m(const Place& place) const {
  const auto [u, v] = parameters(place);
  return position(*surface_, u, v);
}

Vector3 ShellSurface::normal(const Place& place) const {
  const auto [u, v] = parameters(place);
  return unit_normal(*surface_, u, v);
}

std::vector<double> ShellSurface::across_shares(int least) const {
  SPOONBILL_ASSERT(least >= 1);
  return shares_of(across_knots(), least);
}

std::vector<double> ShellSurface::along_shares(int least) const {
  SPOONBILL_ASSERT(least >= 1);
  std::vector<double> shares = shares_of(along_knots(), least);
  if (form_ != Form::bowl || !pole_at_end_) return shares;
  for (double& share : shares) share = 1.0 - share;
  std::reverse(shares.begin(), shares.end());
  return shares;
}

}  // namespace spoonbill
