#include "engine/bspline/trimmed_cells.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

constexpr double snap_share = 1e-9;  // of the domain

using Edge = TrimmedArea::Edge;

// The parts of an edge between grid lines, in its order.
std::vector<Edge> parts_of(const Edge& edge, const GridLines& u, const GridLines& v) {
  const auto snapped = [&](const Eigen::Vector2d& point) {
    return Eigen::Vector2d(u.snapped(point.x()), v.snapped(point.y()));
  };
  std::vector<std::pair<double, Eigen::Vector2d>> points{{0.0, snapped(edge.from)}, {1.0, snapped(edge.to)}};
  for (const int axis : {0, 1}) {
    const std::vector<double>& lines = (axis == 0 ? u : v).all();
    const auto [low, high] = std::minmax(edge.from[axis], edge.to[axis]);
    for (auto line = std::upper_bound(lines.begin(), lines.end(), low); line != lines.end() && *line < high;
         ++line) {
      const double share = (*line - edge.from[axis]) / (edge.to[axis] - edge.from[axis]);
      Eigen::Vector2d point = edge.from + share * (edge.to - edge.from);
      point[axis] = *line;
      points.emplace_back(share, snapped(point));
    }
  }
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Edge> parts;
  for (std::size_t p = 0; p + 1 < points.size(); ++p) {
    if (points[p].second != points[p + 1].second) parts.push_back({points[p].second, points[p + 1].second});
  }
  return parts;
}

bool is_beyond(const GridLines& lines, double parameter) {
  return parameter < lines.at(0) || parameter > lines.at(lines.cells());
}

bool cuts_a_cell(const Edge& part, const GridLines& u, const GridLines& v) {
  const Eigen::Vector2d middle = 0.5 * (part.from + part.to);
  if (is_beyond(u, middle.x()) || is_beyond(v, middle.y())) return false;
  const bool along_u_line = part.from.x() == part.to.x() && u.line_at(part.from.x()) >= 0;
  const bool along_v_line = part.from.y() == part.to.y() && v.line_at(part.from.y()) >= 0;
  return !along_u_line && !along_v_line;
}

}  // namespace

GridLines::GridLines(const GridDirection& direction)
    : at_(direction.parameters), samples_(static_cast<int>(direction.parameters.size())) {
  SPOONBILL_ASSERT(direction.parameters.size() >= 2);
  SPOONBILL_ASSERT(direction.knots.is_periodic() ||
                   (direction.parameters.front() == direction.knots.domain_start() &&
                    direction.parameters.back() == direction.knots.domain_end()));
  const KnotVector& knots = direction.knots;
  if (knots.is_periodic() && at_.back() < knots.domain_end()) at_.push_back(knots.domain_end());
  snap_ = snap_share * (knots.domain_end() - knots.domain_start());
}

double GridLines::snapped(double parameter) const {
  const auto after = std::lower_bound(at_.begin(), at_.end(), parameter);
  if (after != at_.end() && *after - parameter <= snap_) return *after;
  if (after != at_.begin() && parameter - *(after - 1) <= snap_) return *(after - 1);
  return parameter;
}

int GridLines::cell_of(double parameter) const {
  const auto after = std::upper_bound(at_.begin(), at_.end(), parameter) - at_.begin();
  return std::clamp(static_cast<int>(after) - 1, 0, cells() - 1);
}

int GridLines::line_at(double parameter) const {
  const auto found = std::lower_bound(at_.begin(), at_.end(), parameter);
  return found != at_.end() && *found == parameter ? static_cast<int>(found - at_.begin()) : -1;
}

double GridLines::joined(double parameter) const {
  return cells() == samples_ && parameter == at_.back() ? at_.front() : parameter;
}

TrimmedCells::TrimmedCells(const GridLines& u, const GridLines& v, const TrimmedArea& area)
    : columns_(v.cells()) {
  SPOONBILL_ASSERT(u.cells() > 0 && v.cells() > 0);
  const std::size_t count = static_cast<std::size_t>(u.cells()) * static_cast<std::size_t>(v.cells());
  std::vector<std::pair<std::size_t, Edge>> found;
  for (const Edge& edge : area.edges()) {
    for (const Edge& part : parts_of(edge, u, v)) {
      if (!cuts_a_cell(part, u, v)) continue;
      const Eigen::Vector2d middle = 0.5 * (part.from + part.to);
      found.emplace_back(index(u.cell_of(middle.x()), v.cell_of(middle.y())), part);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  starts_.assign(count + 1, 0);
  for (const auto& [cell, part] : found) {
    ++starts_[cell + 1];
    edges_.push_back(part);
  }
  for (std::size_t cell = 0; cell < count; ++cell) starts_[cell + 1] += starts_[cell];
  states_.assign(count, State::cut);
  for (int i = 0; i < u.cells(); ++i) {
    for (int j = 0; j < v.cells(); ++j) {
      if (!edges(i, j).empty()) continue;
      const bool kept = area.contains(0.5 * (u.at(i) + u.at(i + 1)), 0.5 * (v.at(j) + v.at(j + 1)));
      states_[index(i, j)] = kept ? State::kept : State::away;
    }
  }
}

}  // namespace spoonbill
