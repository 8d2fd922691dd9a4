#include "engine/collision/surface_levels.h"

#include <algorithm>

namespace spoonbill {

Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels) {
  NestedParameters in_u = nested_parameters(u, 1, levels), in_v = nested_parameters(v, 1, levels);
  Result<Grid> grid = make_grid(u, v, std::move(in_u.parameters), std::move(in_v.parameters));
  if (!grid.ok()) return grid.error();
  return NestedGrid{std::move(grid).value(), levels};
}

SurfaceLevels::SurfaceLevels(const NestedGrid& nested)
    : nested_(&nested), bounds_(nested.grid.u.knots, nested.grid.v.knots) {
  const std::size_t count =
      static_cast<std::size_t>(nested.grid.rows()) * static_cast<std::size_t>(nested.grid.columns());
  samples_.resize(count);
  sampled_at_.assign(count, 0);
  column_at_.assign(static_cast<std::size_t>(nested.grid.columns()), 0);
  lines_.resize(static_cast<std::size_t>(nested.grid.u.knots.control_point_count()));
  int cells = 0;
  for (int level = 0; level <= nested.levels; ++level) {
    first_cell_.push_back(cells);
    cells += cell_count(level);
  }
  covers_.resize(static_cast<std::size_t>(cells));
  covered_at_.assign(static_cast<std::size_t>(cells), 0);
}

int SurfaceLevels::cell_count(int level) const {
  return ((nested_->grid.rows() - 1) >> (nested_->levels - level)) *
         ((nested_->grid.columns() - 1) >> (nested_->levels - level));
}

int SurfaceLevels::cell_index(const LevelCell& cell) const {
  const int shift = nested_->levels - cell.level;
  return first_cell_[cell.level] + (cell.i >> shift) * ((nested_->grid.columns() - 1) >> shift) +
         (cell.j >> shift);
}

void SurfaceLevels::begin(const Surface& surface) {
  surface_ = &surface;
  ++begun_;
  samples_evaluated_ = 0;
  bounds_.begin();
}

const Vector3& SurfaceLevels::sample(int index) {
  if (sampled_at_[index] == begun_) return samples_[index];
  const Grid& grid = nested_->grid;
  const BlendingMatrix& a_u = grid.u.values;
  const BlendingMatrix& a_v = grid.v.values;
  const int row = index / grid.columns(), column = index % grid.columns();
  Vector3 point = Vector3::Zero();
  for (int a = 0; a < a_u.bandwidth; ++a) {
    const int i = a_u.column(row, a);
    Vector3 line = Vector3::Zero();
    for (int b = 0; b < a_v.bandwidth; ++b) {
      line += a_v.values[column * a_v.bandwidth + b] * surface_->net.point(i, a_v.column(column, b));
    }
    point += a_u.values[row * a_u.bandwidth + a] * line;
  }
  ++samples_evaluated_;
  samples_[index] = point;
  sampled_at_[index] = begun_;
  return samples_[index];
}

void SurfaceLevels::sample_column(int column) {
  if (column_at_[column] == begun_) return;
  column_at_[column] = begun_;
  const Grid& grid = nested_->grid;
  const BlendingMatrix& a_u = grid.u.values;
  const BlendingMatrix& a_v = grid.v.values;
  for (int i = 0; i < surface_->net.rows; ++i) {
    lines_[i].setZero();
    for (int b = 0; b < a_v.bandwidth; ++b) {
      lines_[i] += a_v.values[column * a_v.bandwidth + b] * surface_->net.point(i, a_v.column(column, b));
    }
  }
  for (int row = 0; row < grid.rows(); row += step(0)) {
    const int index = row * grid.columns() + column;
    if (sampled_at_[index] == begun_) continue;
    Vector3 point = Vector3::Zero();
    for (int a = 0; a < a_u.bandwidth; ++a) {
      point += a_u.values[row * a_u.bandwidth + a] * lines_[a_u.column(row, a)];
    }
    ++samples_evaluated_;
    samples_[index] = point;
    sampled_at_[index] = begun_;
  }
}

PatchCorners SurfaceLevels::corners(const LevelCell& cell) {
  const int columns = nested_->grid.columns(), along = step(cell.level);
  const int index = cell.i * columns + cell.j;
  return {sample(index), sample(index + along), sample(index + along * columns),
          sample(index + along * columns + along)};
}

double SurfaceLevels::bulge(const LevelCell& cell) {
  const Grid& grid = nested_->grid;
  const int along = step(cell.level), element_v = cell.j >> nested_->levels;
  const double h_u = grid.u.parameters[cell.i + along] - grid.u.parameters[cell.i];
  const double h_v = grid.v.parameters[cell.j + along] - grid.v.parameters[cell.j];
  bounds_.update(surface_->net, element_v);
  return bounds_.bulge(cell.i >> nested_->levels, element_v, h_u, h_v);
}

const CoverSphere& SurfaceLevels::cover(const LevelCell& cell) {
  const int index = cell_index(cell);
  CoverSphere& sphere = covers_[index];
  if (covered_at_[index] == begun_) return sphere;
  covered_at_[index] = begun_;
  const PatchCorners at = corners(cell);
  sphere.centre = 0.25 * (at[0] + at[1] + at[2] + at[3]);
  sphere.radius = 0.0;
  for (const Vector3& corner : at) sphere.radius = std::max(sphere.radius, (corner - sphere.centre).norm());
  sphere.radius += bulge(cell);
  return sphere;
}

}  // namespace spoonbill
