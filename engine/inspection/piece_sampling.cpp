#include "engine/inspection/piece_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Of a piece.
constexpr double off_knots = 1e-6;
constexpr double off_poles = 1e-2;
// Of the net's size.
constexpr double collapsed = 1e-9;
// How many cells are searched further.
constexpr std::size_t searched = 12;
// Between two reports.
constexpr std::size_t watched_cells = 256;
// Each halves the step.
constexpr int halvings = 24;

struct Candidate {
  ParameterPlace place;
  PieceCell cell;
};

ParameterPlace best_in_cell(const PieceCell& cell, const std::function<double(double, double)>& value) {
  ParameterPlace best{0.0, 0.0, std::numeric_limits<double>::infinity()};
  const std::array<std::array<double, 2>, 5> places = {{{cell.middle_u(), cell.middle_v()},
                                                        {cell.u0, cell.v0},
                                                        {cell.u0, cell.v1},
                                                        {cell.u1, cell.v0},
                                                        {cell.u1, cell.v1}}};
  for (const auto& [u, v] : places) {
    const double found = value(u, v);
    if (found < best.value) best = {u, v, found};
  }
  return best;
}

// Steps to a better neighbour of eight, or halves the step.
ParameterPlace search_cell(Candidate from, const std::function<double(double, double)>& value) {
  double step_u = 0.5 * (from.cell.u1 - from.cell.u0), step_v = 0.5 * (from.cell.v1 - from.cell.v0);
  for (int halving = 0; halving < halvings;) {
    ParameterPlace best = from.place;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const double u = std::clamp(from.place.u + i * step_u, from.cell.u0, from.cell.u1);
        const double v = std::clamp(from.place.v + j * step_v, from.cell.v0, from.cell.v1);
        const double found = value(u, v);
        if (found < best.value) best = {u, v, found};
      }
    }
    if (best.value < from.place.value) {
      from.place = best;
      continue;
    }
    step_u *= 0.5;
    step_v *= 0.5;
    ++halving;
  }
  return from.place;
}

// Whether all control points of an edge are one: of the first or last row (of u) or column.
bool is_collapsed(const ControlNet& net, bool of_u, bool last) {
  const double size = bounding_box(net).size();
  const int count = of_u ? net.columns : net.rows, line = last ? (of_u ? net.rows : net.columns) - 1 : 0;
  const auto at = [&](int k) { return of_u ? net.point(line, k) : net.point(k, line); };
  for (int k = 1; k < count; ++k) {
    if ((at(k) - at(0)).norm() > collapsed * size) return false;
  }
  return true;
}

std::vector<std::array<double, 2>> intervals(const Surface& surface, bool of_u, int parts) {
  std::vector<std::array<double, 2>> result;
  const KnotVector& knots = of_u ? surface.u : surface.v;
  const std::vector<double> ends = knots.breakpoints();
  const auto off_end = [&](bool last) {
    return !knots.is_periodic() && is_collapsed(surface.net, of_u, last) ? off_poles : off_knots;
  };
  const double off_first = off_end(false), off_last = off_end(true);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double whole = ends[k + 1] - ends[k];
    const double start = ends[k] + (k == 0 ? off_first : off_knots) * whole;
    const double end = ends[k + 1] - (k + 2 == ends.size() ? off_last : off_knots) * whole;
    for (int p = 0; p < parts; ++p) {
      result.push_back({start + (end - start) * p / parts, start + (end - start) * (p + 1) / parts});
    }
  }
  return result;
}

}  // namespace

std::vector<PieceCell> piece_cells(const Surface& surface, int parts) {
  SPOONBILL_ASSERT(parts >= 1);
  std::vector<PieceCell> cells;
  const auto in_v = intervals(surface, false, parts);
  for (const auto& [u0, u1] : intervals(surface, true, parts)) {
    for (const auto& [v0, v1] : in_v) cells.push_back({u0, u1, v0, v1});
  }
  return cells;
}

ParameterPlace least_place(const std::vector<PieceCell>& cells,
                           const std::function<double(double u, double v)>& value, const Progress& progress) {
  SPOONBILL_ASSERT(static_cast<bool>(value));
  const ParameterPlace none{0.0, 0.0, std::numeric_limits<double>::infinity()};
  std::vector<Candidate> candidates;
  candidates.reserve(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (k % watched_cells == 0 &&
        !progress.report(static_cast<double>(k) / static_cast<double>(cells.size()))) {
      return none;
    }
    const ParameterPlace best = best_in_cell(cells[k], value);
    if (std::isfinite(best.value)) candidates.push_back({best, cells[k]});
  }
  if (candidates.empty()) return none;
  const std::size_t count = std::min(searched, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates.end(), [](const Candidate& a, const Candidate& b) {
                      if (a.place.value != b.place.value) return a.place.value < b.place.value;
                      return a.cell.u0 != b.cell.u0 ? a.cell.u0 < b.cell.u0 : a.cell.v0 < b.cell.v0;
                    });
  ParameterPlace least = candidates[0].place;
  for (std::size_t k = 0; k < count; ++k) {
    const ParameterPlace found = search_cell(candidates[k], value);
    if (found.value < least.value) least = found;
  }
  return least;
}

}  // namespace spoonbill
