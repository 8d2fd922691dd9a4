#include "engine/collision/levels/surface_levels.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels) {
  SPOONBILL_ASSERT(levels >= 0);
  NestedParameters in_u = nested_parameters(u, 1, levels), in_v = nested_parameters(v, 1, levels);
  Result<Grid> grid = make_grid(u, v, std::move(in_u.parameters), std::move(in_v.parameters));
  if (!grid.ok()) return grid.error();
  return NestedGrid{std::move(grid).value(), levels};
}

namespace {

const PatchKernels& kernels_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return kernels_avx512::patch_kernels;
    case InstructionSet::avx2:
      return kernels_avx2::patch_kernels;
    case InstructionSet::baseline:
      break;
  }
  return kernels_baseline::patch_kernels;
}

constexpr int tile_padding = 4;

// How many knots lie at the end of an element: by so many the basis functions of the sample there are
// shifted, which is the next element's first.
int knots_at_end(const GridDirection& direction, int levels, int element) {
  const KnotVector& knots = direction.knots;
  const int elements = (static_cast<int>(direction.parameters.size()) - 1) >> levels;
  const auto span = [&](int e) {
    return knots.find_span(0.5 *
                           (direction.parameters[e << levels] + direction.parameters[(e + 1) << levels]));
  };
  if (element + 1 < elements) return span(element + 1) - span(element);
  return knots.is_periodic() ? span(0) + knots.control_point_count() - span(element) : 0;
}

}  // namespace

SurfaceLevels::Bands SurfaceLevels::bands_of(const GridDirection& direction, int levels) {
  const BlendingMatrix& matrix = direction.values;
  Bands bands;
  bands.bandwidth = matrix.bandwidth;
  bands.samples = (1 << levels) + 1;
  bands.padded = (bands.samples + tile_padding - 1) / tile_padding * tile_padding;
  const int elements = (matrix.rows - 1) >> levels;
  bands.controls.resize(static_cast<std::size_t>(elements * bands.bandwidth));
  bands.values.assign(static_cast<std::size_t>(elements * bands.bandwidth * bands.padded), 0.0);
  for (int element = 0; element < elements; ++element) {
    const int first_row = element << levels;
    for (int k = 0; k < bands.bandwidth; ++k) {
      bands.controls[element * bands.bandwidth + k] = matrix.column(first_row, k);
    }
    for (int sample = 0; sample < bands.samples; ++sample) {
      const int row = first_row + sample;
      const int shift = sample + 1 < bands.samples ? 0 : knots_at_end(direction, levels, element);
      // Those shifted beyond the element's own vanish at its end.
      for (int k = 0; k + shift < bands.bandwidth; ++k) {
        bands.values[(element * bands.bandwidth + k + shift) * bands.padded + sample] =
            matrix.values[row * bands.bandwidth + k];
      }
    }
  }
  return bands;
}

SurfaceLevels::SurfaceLevels(const NestedGrid& nested, InstructionSet set)
    : nested_(&nested),
      kernels_(&kernels_for(set)),
      bounds_(nested.grid.u.knots, nested.grid.v.knots),
      u_pieces_(nested.grid.u.knots),
      v_pieces_(nested.grid.v.knots),
      u_bands_(bands_of(nested.grid.u, nested.levels)),
      v_bands_(bands_of(nested.grid.v, nested.levels)) {
  SPOONBILL_ASSERT(nested.levels >= 0 && nested.grid.rows() > 1 && nested.grid.columns() > 1);
  const std::size_t count =
      static_cast<std::size_t>(nested.grid.rows()) * static_cast<std::size_t>(nested.grid.columns());
  for (std::vector<double>* values : {&x_, &y_, &z_}) values->resize(count);
  sampled_at_.assign(count, 0);
  element_at_.assign(static_cast<std::size_t>(cell_count(0)), 0);
  tile_lines_.resize(static_cast<std::size_t>(3 * u_bands_.bandwidth * v_bands_.padded));
  column_at_.assign(static_cast<std::size_t>(nested.grid.columns()), 0);
  lines_.resize(static_cast<std::size_t>(nested.grid.u.knots.control_point_count()));
  net_ = ControlNet(nested.grid.u.knots.control_point_count(), nested.grid.v.knots.control_point_count());
  int cells = 0;
  for (int level = 0; level <= nested.levels; ++level) {
    first_cell_.push_back(cells);
    cells += cell_count(level);
  }
  covers_.resize(static_cast<std::size_t>(cells));
  covered_at_.assign(static_cast<std::size_t>(cells), 0);
}

int SurfaceLevels::cell_count(int level) const {
  SPOONBILL_ASSERT(level >= 0 && level <= nested_->levels);
  return ((nested_->grid.rows() - 1) >> (nested_->levels - level)) *
         ((nested_->grid.columns() - 1) >> (nested_->levels - level));
}

bool SurfaceLevels::begin(const Surface& surface, const PlanarPoints& samples) {
  SPOONBILL_ASSERT(surface.net.rows == nested_->grid.u.knots.control_point_count());
  SPOONBILL_ASSERT(surface.net.columns == nested_->grid.v.knots.control_point_count());
  SPOONBILL_ASSERT(surface.net.x.size() == surface.net.size());
  SPOONBILL_ASSERT_DEBUG(surface.u == nested_->grid.u.knots && surface.v == nested_->grid.v.knots);
  surface_ = &surface;
  given_ = samples;
  samples_evaluated_ = 0;
  if (!take_net(surface.net)) return false;
  ++begun_;
  bounds_.begin();
  return true;
}

// False where it is the one of before.
bool SurfaceLevels::take_net(const ControlNet& net) {
  const bool known = begun_ > 0 && net.x == net_.x && net.y == net_.y && net.z == net_.z;
  if (!known) net_ = net;
  return !known;
}

void SurfaceLevels::set_sample(int index, const Vector3& point) {
  ++samples_evaluated_;
  x_[index] = point.x();
  y_[index] = point.y();
  z_[index] = point.z();
  sampled_at_[index] = begun_;
}

Vector3 SurfaceLevels::sample(int index) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && index >= 0 &&
                         index < nested_->grid.rows() * nested_->grid.columns());
  if (given_.x != nullptr) return {given_.x[index], given_.y[index], given_.z[index]};
  if (sampled_at_[index] == begun_) return {x_[index], y_[index], z_[index]};
  const Grid& grid = nested_->grid;
  const int row = index / grid.columns(), column = index % grid.columns();
  const BandEntry u = u_bands_.at(row), v = v_bands_.at(column);
  Vector3 point = Vector3::Zero();
  for (int a = 0; a < u_bands_.bandwidth; ++a) {
    Vector3 line = Vector3::Zero();
    for (int b = 0; b < v_bands_.bandwidth; ++b) {
      line += v.values[b * v_bands_.padded] * surface_->net.point(u.controls[a], v.controls[b]);
    }
    point += u.values[a * u_bands_.padded] * line;
  }
  set_sample(index, point);
  return point;
}

TileBand SurfaceLevels::Bands::of(int element) const {
  return {controls.data() + element * bandwidth, values.data() + element * bandwidth * padded, bandwidth,
          samples, padded};
}

// A sample between two elements is the first of the later.
SurfaceLevels::BandEntry SurfaceLevels::Bands::at(int row) const {
  const int cells = samples - 1, elements = static_cast<int>(controls.size()) / bandwidth;
  const int element = std::min(row / cells, elements - 1);
  const TileBand band = of(element);
  return {band.controls, band.values + (row - element * cells)};
}

void SurfaceLevels::sample_element(int element_u, int element_v) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && element_u >= 0 && element_u < bounds_.elements_u() &&
                         element_v >= 0 && element_v < bounds_.elements_v());
  if (given_.x != nullptr) return;
  const int columns = nested_->grid.columns(), side = u_bands_.samples;
  std::uint32_t& element_at = element_at_[element_u * ((columns - 1) >> nested_->levels) + element_v];
  if (element_at == begun_) return;
  element_at = begun_;
  const int first = ((element_u * columns + element_v) << nested_->levels);
  kernels_->sample_tile(u_bands_.of(element_u), v_bands_.of(element_v),
                        {surface_->net.x.data(), surface_->net.y.data(), surface_->net.z.data()},
                        surface_->net.columns, tile_lines_.data(),
                        {x_.data() + first, y_.data() + first, z_.data() + first}, columns);
  for (int row = 0; row < side; ++row) {
    std::fill_n(sampled_at_.begin() + first + row * columns, side, begun_);
  }
  samples_evaluated_ += side * side;
}

void SurfaceLevels::sample_column(int column) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && column >= 0 && column < nested_->grid.columns());
  if (given_.x != nullptr || column_at_[column] == begun_) return;
  column_at_[column] = begun_;
  const Grid& grid = nested_->grid;
  const ControlNet& net = surface_->net;
  const BandEntry v = v_bands_.at(column);
  for (int i = 0; i < net.rows; ++i) {
    const std::size_t row = net.index(i, 0);
    Vector3 line = Vector3::Zero();
    for (int b = 0; b < v_bands_.bandwidth; ++b) {
      const std::size_t at = row + static_cast<std::size_t>(v.controls[b]);
      line += v.values[b * v_bands_.padded] * Vector3(net.x[at], net.y[at], net.z[at]);
    }
    lines_[i] = line;
  }
  for (int row = 0; row < grid.rows(); row += step(0)) {
    const int index = row * grid.columns() + column;
    if (sampled_at_[index] == begun_) continue;
    const BandEntry u = u_bands_.at(row);
    Vector3 point = Vector3::Zero();
    for (int a = 0; a < u_bands_.bandwidth; ++a) {
      point += u.values[a * u_bands_.padded] * lines_[u.controls[a]];
    }
    set_sample(index, point);
  }
}

PatchCorners SurfaceLevels::corners(const LevelCell& cell) {
  SPOONBILL_ASSERT_DEBUG(cell.level >= 0 && cell.level <= nested_->levels);
  const int columns = nested_->grid.columns(), along = step(cell.level);
  const int index = cell.i * columns + cell.j;
  return {sample(index), sample(index + along), sample(index + along * columns),
          sample(index + along * columns + along)};
}

void SurfaceLevels::element_boxes(int element_u, Box* boxes, double* bulges) {
  SPOONBILL_ASSERT_DEBUG(element_u >= 0 && element_u < bounds_.elements_u() && boxes != nullptr &&
                         bulges != nullptr);
  const int stride = step(0), columns = nested_->grid.columns(), i = element_u * stride;
  for (int j = 0; j < columns; j += stride) sample_column(j);
  const std::vector<double>& in_u = nested_->grid.u.parameters;
  const std::vector<double>& in_v = nested_->grid.v.parameters;
  const PlanarPoints from = samples();
  const double* const values[3] = {from.x + i * columns, from.y + i * columns, from.z + i * columns};
  const double h_u = in_u[i + stride] - in_u[i];
  for (int element = 0; element < bounds_.elements_v(); ++element) {
    const int j = element * stride;
    bounds_.update(surface_->net, element);
    const double bulge = bounds_.bulge(element_u, element, h_u, in_v[j + stride] - in_v[j]);
    Box& box = boxes[element];
    for (int axis = 0; axis < 3; ++axis) {
      const double* const low = values[axis] + j;
      const double* const high = low + stride * columns;
      const double a = low[0], b = low[stride], c = high[0], d = high[stride];
      const double least_low = a < b ? a : b, least_high = c < d ? c : d;
      const double most_low = a < b ? b : a, most_high = c < d ? d : c;
      box.low[axis] = (least_low < least_high ? least_low : least_high) - bulge;
      box.high[axis] = (most_low < most_high ? most_high : most_low) + bulge;
    }
    bulges[element] = bulge;
  }
}

double SurfaceLevels::bulge(const LevelCell& cell) {
  SPOONBILL_ASSERT_DEBUG(cell.level >= 0 && cell.level <= nested_->levels);
  const Grid& grid = nested_->grid;
  const int along = step(cell.level), element_v = cell.j >> nested_->levels;
  const double h_u = grid.u.parameters[cell.i + along] - grid.u.parameters[cell.i];
  const double h_v = grid.v.parameters[cell.j + along] - grid.v.parameters[cell.j];
  bounds_.update(surface_->net, element_v);
  return bounds_.bulge(cell.i >> nested_->levels, element_v, h_u, h_v);
}

const CoverSphere& SurfaceLevels::cover(const LevelCell& cell) {
  SPOONBILL_ASSERT_DEBUG(cell.level >= 0 && cell.level <= nested_->levels);
  const int index = cell_index(cell);
  CoverSphere& sphere = covers_[index];
  if (covered_at_[index] == begun_) return sphere;
  covered_at_[index] = begun_;
  const PatchCorners at = corners(cell);
  sphere.centre = 0.25 * (at[0] + at[1] + at[2] + at[3]);
  sphere.radius = 0.0;
  for (const Vector3& corner : at) {
    sphere.radius = std::max(sphere.radius, (corner - sphere.centre).squaredNorm());
  }
  sphere.radius = std::sqrt(sphere.radius) + bulge(cell);
  return sphere;
}

}  // namespace spoonbill
