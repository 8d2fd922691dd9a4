#include "app/report/surface_extent.h"

#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {
namespace {

// The cells that loops cross are cut along them, which takes longer: fewer do, for the loops themselves
// count.
constexpr int samples = 201, trimmed_samples = 61;

Box extent_within(const Surface& surface, const Grid& grid, const TrimmedArea& area) {
  const TrimmedGrid trimmed = trim_grid(grid.u, grid.v, area);
  const auto columns = static_cast<std::size_t>(grid.columns());
  const std::size_t count = grid.u.parameters.size() * columns;
  std::vector<bool> kept(count, false);
  for (const auto& triangle : trimmed.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (vertex < count) kept[vertex] = true;
    }
  }
  Box box;
  for (std::size_t s = 0; s < count; ++s) {
    if (!kept[s]) continue;
    box.include(position(surface, grid.u.parameters[s / columns], grid.v.parameters[s % columns]));
  }
  for (const CutVertex& cut : trimmed.vertices) box.include(position(surface, cut.u, cut.v));
  return box;
}

}  // namespace

Box extent_of(const Surface& surface, const std::vector<TrimLoop>& trims) {
  if (!trims.empty()) {
    const auto area = TrimmedArea::make(surface.u, surface.v, trims);
    const auto grid = make_grid(surface.u, surface.v, uniform_parameters(surface.u, trimmed_samples),
                                uniform_parameters(surface.v, trimmed_samples));
    if (area && grid) return extent_within(surface, grid.value(), area.value());
  }
  Box box;
  const auto v_parameters = uniform_parameters(surface.v, samples);
  for (const double u : uniform_parameters(surface.u, samples)) {
    for (const double v : v_parameters) box.include(position(surface, u, v));
  }
  return box;
}

}  // namespace spoonbill
