#include "engine/collision/levels/surface_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

double safe_quotient(double numerator, double denominator) {
  return denominator > 0.0 ? numerator / denominator : 0.0;
}

struct UnrolledKnots {
  std::vector<int> span, control;
  std::vector<double> first_scale, second_scale;
};

UnrolledKnots unroll(const KnotVector& knots) {
  UnrolledKnots result;
  const std::vector<double>& u = knots.extended_knots();
  const int p = knots.degree();
  const int count = static_cast<int>(u.size()) - p - 1;
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    result.span.push_back(knots.find_span(0.5 * (breaks[b] + breaks[b + 1])));
  }
  for (int i = 0; i < count; ++i) {
    result.control.push_back(knots.control_index(i, p));
    result.first_scale.push_back(i + 1 < count ? safe_quotient(p, u[i + p + 1] - u[i + 1]) : 0.0);
    result.second_scale.push_back(i + 2 < count ? safe_quotient(p - 1, u[i + p + 1] - u[i + 2]) : 0.0);
  }
  return result;
}

}  // namespace

SurfaceBounds::SurfaceBounds(const KnotVector& u, const KnotVector& v)
    : degree_u_(u.degree()), degree_v_(v.degree()) {
  UnrolledKnots in_u = unroll(u), in_v = unroll(v);
  rows_ = static_cast<int>(in_u.control.size());
  columns_ = static_cast<int>(in_v.control.size());
  span_u_ = std::move(in_u.span);
  span_v_ = std::move(in_v.span);
  control_u_ = std::move(in_u.control);
  control_v_ = std::move(in_v.control);
  first_scale_u_ = std::move(in_u.first_scale);
  second_scale_u_ = std::move(in_u.second_scale);
  first_scale_v_ = std::move(in_v.first_scale);
  second_scale_v_ = std::move(in_v.second_scale);
  norm_uu_.assign(static_cast<std::size_t>(rows_ * columns_), 0.0);
  norm_vv_ = norm_uu_;
  second_uu_.assign(span_u_.size() * span_v_.size(), 0.0);
  second_vv_ = second_uu_;
  for (auto& row : row_) {
    for (std::vector<double>& values : row) values.assign(static_cast<std::size_t>(columns_), 0.0);
  }
  row_boxes_.resize(static_cast<std::size_t>(u.control_point_count()));
  column_at_.assign(static_cast<std::size_t>(columns_), 0);
  element_at_.assign(span_v_.size(), 0);
  for (std::vector<double>* edge : {&low_[0], &low_[1], &low_[2], &high_[0], &high_[1], &high_[2]}) {
    edge->assign(static_cast<std::size_t>(v.control_point_count()), 0.0);
  }
}

void SurfaceBounds::update(const ControlNet& net) {
  SPOONBILL_ASSERT(net.z.size() == net.size() && net.rows > 0);
  begin();
  std::fill(column_at_.begin(), column_at_.end(), stamp_);
  std::fill(element_at_.begin(), element_at_.end(), stamp_);
  for (int i = 0; i < std::min(2, rows_); ++i) unroll_row(net, i);
  for (int i = 0; i < rows_; ++i) update_row_norms(net, i);
  for (int eu = 0; eu < elements_u(); ++eu) update_elements(eu);
}

void SurfaceBounds::unroll_row(const ControlNet& net, int i) {
  const std::vector<double>* coordinates[3] = {&net.x, &net.y, &net.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* const from = coordinates[axis]->data() + control_u_[i] * net.columns;
    double* const to = row_[i % 3][axis].data();
    for (int j = 0; j < columns_; ++j) to[j] = from[control_v_[j]];
  }
}

// Computes row i of norm_uu_ and norm_vv_, the squared norms of the second derivatives' control points. Rows
// i and i + 1 of the unrolled control net must already be in row_.
void SurfaceBounds::update_row_norms(const ControlNet& net, int i) {
  if (i + 2 < rows_) unroll_row(net, i + 2);
  const std::vector<double>*const here = row_[i % 3], *const next = row_[(i + 1) % 3],
                                  *const after = row_[(i + 2) % 3];
  const double *x0 = here[0].data(), *y0 = here[1].data(), *z0 = here[2].data();
  const double *x1 = next[0].data(), *y1 = next[1].data(), *z1 = next[2].data();
  const double *x2 = after[0].data(), *y2 = after[1].data(), *z2 = after[2].data();
  if (i + 2 < rows_) {
    double* const norm = norm_uu_.data() + i * columns_;
    const double low = first_scale_u_[i], high = first_scale_u_[i + 1], scale = second_scale_u_[i];
    for (int j = 0; j < columns_; ++j) {
      const double x = scale * (high * (x2[j] - x1[j]) - low * (x1[j] - x0[j]));
      const double y = scale * (high * (y2[j] - y1[j]) - low * (y1[j] - y0[j]));
      const double z = scale * (high * (z2[j] - z1[j]) - low * (z1[j] - z0[j]));
      norm[j] = x * x + (y * y + z * z);
    }
  }
  double* const norm = norm_vv_.data() + i * columns_;
  const double* const first = first_scale_v_.data();
  const double* const second = second_scale_v_.data();
  for (int j = 0; j + 2 < columns_; ++j) {
    const double x = second[j] * (first[j + 1] * (x0[j + 2] - x0[j + 1]) - first[j] * (x0[j + 1] - x0[j]));
    const double y = second[j] * (first[j + 1] * (y0[j + 2] - y0[j + 1]) - first[j] * (y0[j + 1] - y0[j]));
    const double z = second[j] * (first[j + 1] * (z0[j + 2] - z0[j + 1]) - first[j] * (z0[j + 1] - z0[j]));
    norm[j] = x * x + (y * y + z * z);
  }
}

// Computes the bounds of the elements in row eu. First computes, for each column of the unrolled net, the
// largest norm in the rows on which these elements depend.
void SurfaceBounds::update_elements(int eu) {
  double* const uu = row_[0][0].data();
  double* const vv = row_[0][1].data();
  const int low = span_u_[eu] - degree_u_;
  std::fill_n(uu, columns_, 0.0);
  std::fill_n(vv, columns_, 0.0);
  for (int i = low; i <= span_u_[eu]; ++i) {
    const double* const row_uu = norm_uu_.data() + i * columns_;
    const double* const row_vv = norm_vv_.data() + i * columns_;
    for (int j = 0; j < columns_; ++j) vv[j] = vv[j] < row_vv[j] ? row_vv[j] : vv[j];
    if (i + 2 > span_u_[eu]) continue;
    for (int j = 0; j < columns_; ++j) uu[j] = uu[j] < row_uu[j] ? row_uu[j] : uu[j];
  }
  for (int ev = 0; ev < elements_v(); ++ev) {
    double most_uu = 0.0, most_vv = 0.0;
    for (int j = span_v_[ev] - degree_v_; j <= span_v_[ev]; ++j) {
      most_uu = std::max(most_uu, uu[j]);
      if (j + 2 <= span_v_[ev]) most_vv = std::max(most_vv, vv[j]);
    }
    const std::size_t e = static_cast<std::size_t>(eu * elements_v() + ev);
    second_uu_[e] = std::sqrt(most_uu);
    second_vv_[e] = std::sqrt(most_vv);
  }
}

void SurfaceBounds::update_column_norms(const ControlNet& net, int j) {
  if (column_at_[j] == stamp_) return;
  column_at_[j] = stamp_;
  const auto point = [&](int i, int column) { return net.point(control_u_[i], control_v_[column]); };
  for (int i = 0; i < rows_; ++i) {
    const std::size_t at = static_cast<std::size_t>(i * columns_ + j);
    const Vector3 here = point(i, j);
    if (i + 2 < rows_) {
      const Vector3 next = point(i + 1, j);
      const Vector3 a = first_scale_u_[i] * (next - here);
      const Vector3 b = first_scale_u_[i + 1] * (point(i + 2, j) - next);
      norm_uu_[at] = (second_scale_u_[i] * (b - a)).squaredNorm();
    }
    if (j + 2 < columns_) {
      const Vector3 next = point(i, j + 1);
      const Vector3 a = first_scale_v_[j] * (next - here);
      const Vector3 b = first_scale_v_[j + 1] * (point(i, j + 2) - next);
      norm_vv_[at] = (second_scale_v_[j] * (b - a)).squaredNorm();
    }
  }
}

void SurfaceBounds::update(const ControlNet& net, int ev) {
  SPOONBILL_ASSERT_DEBUG(ev >= 0 && ev < elements_v());
  if (element_at_[ev] == stamp_) return;
  element_at_[ev] = stamp_;
  const int first = span_v_[ev] - degree_v_;
  for (int j = first; j <= span_v_[ev]; ++j) update_column_norms(net, j);
  for (int eu = 0; eu < elements_u(); ++eu) {
    double uu = 0.0, vv = 0.0;
    for (int i = span_u_[eu] - degree_u_; i <= span_u_[eu]; ++i) {
      for (int j = first; j <= span_v_[ev]; ++j) {
        const std::size_t at = static_cast<std::size_t>(i * columns_ + j);
        if (i + 2 <= span_u_[eu]) uu = std::max(uu, norm_uu_[at]);
        if (j + 2 <= span_v_[ev]) vv = std::max(vv, norm_vv_[at]);
      }
    }
    const std::size_t e = static_cast<std::size_t>(eu * elements_v() + ev);
    second_uu_[e] = std::sqrt(uu);
    second_vv_[e] = std::sqrt(vv);
  }
}

void SurfaceBounds::update_boxes(const ControlNet& net) {
  SPOONBILL_ASSERT(net.z.size() == net.size() && net.rows > 0);
  const std::vector<double>* values[3] = {&net.x, &net.y, &net.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* from = values[axis]->data();
    double* low = low_[axis].data();
    double* high = high_[axis].data();
    std::copy_n(from, net.columns, low);
    std::copy_n(from, net.columns, high);
    for (int i = 0; i < net.rows; ++i, from += net.columns) {
      double row_low = from[0], row_high = from[0];
      for (int j = 0; j < net.columns; ++j) {
        low[j] = from[j] < low[j] ? from[j] : low[j];
        high[j] = high[j] < from[j] ? from[j] : high[j];
      }
      for (int j = 1; j < net.columns; ++j) {
        row_low = from[j] < row_low ? from[j] : row_low;
        row_high = row_high < from[j] ? from[j] : row_high;
      }
      row_boxes_[i].low[axis] = row_low;
      row_boxes_[i].high[axis] = row_high;
    }
  }
}

Box SurfaceBounds::row_box(int element_u) const {
  SPOONBILL_ASSERT_DEBUG(element_u >= 0 && element_u < elements_u());
  const int last = span_u_[element_u];
  Box box = row_boxes_[control_u_[last]];
  for (int i = last - degree_u_; i < last; ++i) box.join(row_boxes_[control_u_[i]]);
  return box;
}

Box SurfaceBounds::box(int element_v) const {
  SPOONBILL_ASSERT_DEBUG(element_v >= 0 && element_v < elements_v());
  Box box{Vector3::Constant(std::numeric_limits<double>::infinity()),
          Vector3::Constant(-std::numeric_limits<double>::infinity())};
  for (int j = span_v_[element_v] - degree_v_; j <= span_v_[element_v]; ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], low_[axis][control_v_[j]]);
      box.high[axis] = std::max(box.high[axis], high_[axis][control_v_[j]]);
    }
  }
  return box;
}

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

// Returns the number of control points from the first one of an element to the first one of the next element.
// It is the multiplicity of the knot between the two, or 0 for the last element of an open direction. The
// sample at this knot belongs to the next element.
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

SurfaceLevels::Bands SurfaceLevels::make_bands(const GridDirection& direction, int levels) {
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
      // Basis functions with larger k belong only to the next element and vanish at this sample.
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
      u_bands_(make_bands(nested.grid.u, nested.levels)),
      v_bands_(make_bands(nested.grid.v, nested.levels)) {
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
  external_samples_ = samples;
  samples_evaluated_ = 0;
  if (!store_net(surface.net)) return false;
  ++generation_;
  bounds_.begin();
  return true;
}

// Stores the control points. Returns false if they equal the stored control points.
bool SurfaceLevels::store_net(const ControlNet& net) {
  const bool known = generation_ > 0 && net.x == net_.x && net.y == net_.y && net.z == net_.z;
  if (!known) net_ = net;
  return !known;
}

void SurfaceLevels::set_sample(int index, const Vector3& point) {
  ++samples_evaluated_;
  x_[index] = point.x();
  y_[index] = point.y();
  z_[index] = point.z();
  sampled_at_[index] = generation_;
}

Vector3 SurfaceLevels::sample(int index) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && index >= 0 &&
                         index < nested_->grid.rows() * nested_->grid.columns());
  if (external_samples_.x != nullptr)
    return {external_samples_.x[index], external_samples_.y[index], external_samples_.z[index]};
  if (sampled_at_[index] == generation_) return {x_[index], y_[index], z_[index]};
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

TileBand SurfaceLevels::Bands::tile_band(int element) const {
  return {controls.data() + element * bandwidth, values.data() + element * bandwidth * padded, bandwidth,
          samples, padded};
}

// Returns the basis functions at the sample of a row. A sample between two elements belongs to the element
// after it.
SurfaceLevels::BandEntry SurfaceLevels::Bands::at(int row) const {
  const int cells = samples - 1, elements = static_cast<int>(controls.size()) / bandwidth;
  const int element = std::min(row / cells, elements - 1);
  const TileBand band = tile_band(element);
  return {band.controls, band.values + (row - element * cells)};
}

void SurfaceLevels::sample_element(int element_u, int element_v) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && element_u >= 0 && element_u < bounds_.elements_u() &&
                         element_v >= 0 && element_v < bounds_.elements_v());
  if (external_samples_.x != nullptr) return;
  const int columns = nested_->grid.columns(), side = u_bands_.samples;
  std::uint32_t& element_at = element_at_[element_u * ((columns - 1) >> nested_->levels) + element_v];
  if (element_at == generation_) return;
  element_at = generation_;
  const int first = ((element_u * columns + element_v) << nested_->levels);
  kernels_->sample_tile(u_bands_.tile_band(element_u), v_bands_.tile_band(element_v),
                        {surface_->net.x.data(), surface_->net.y.data(), surface_->net.z.data()},
                        surface_->net.columns, tile_lines_.data(),
                        {x_.data() + first, y_.data() + first, z_.data() + first}, columns);
  for (int row = 0; row < side; ++row) {
    std::fill_n(sampled_at_.begin() + first + row * columns, side, generation_);
  }
  samples_evaluated_ += side * side;
}

void SurfaceLevels::sample_column(int column) {
  SPOONBILL_ASSERT_DEBUG(surface_ != nullptr && column >= 0 && column < nested_->grid.columns());
  if (external_samples_.x != nullptr || column_at_[column] == generation_) return;
  column_at_[column] = generation_;
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
    if (sampled_at_[index] == generation_) continue;
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
  if (covered_at_[index] == generation_) return sphere;
  covered_at_[index] = generation_;
  const PatchCorners at = corners(cell);
  sphere.centre = 0.25 * (at[0] + at[1] + at[2] + at[3]);
  sphere.radius = 0.0;
  for (const Vector3& corner : at) {
    sphere.radius = std::max(sphere.radius, (corner - sphere.centre).squaredNorm());
  }
  sphere.radius = std::sqrt(sphere.radius) + bulge(cell);
  return sphere;
}

namespace {

// Returns the gap between the corners of `a` and the corners of `b` along `direction`, multiplied by the
// length of `direction`. The gap is positive if all of `b` is beyond `a`, negative if the two overlap.
double gap_along(const Vector3& direction, const PatchCorners& a, const PatchCorners& b) {
  double last_a = -std::numeric_limits<double>::infinity(), first_b = -last_a;
  for (const Vector3& corner : a) last_a = std::max(last_a, direction.dot(corner));
  for (const Vector3& corner : b) first_b = std::min(first_b, direction.dot(corner));
  return first_b - last_a;
}

Vector3 patch_normal(const PatchCorners& corners) {
  return (corners[3] - corners[0]).cross(corners[2] - corners[1]);
}

// Indices of the two corners at the ends of each side of a patch.
constexpr std::array<std::array<std::size_t, 2>, 4> sides = {{{0, 1}, {1, 3}, {3, 2}, {2, 0}}};

}  // namespace

double patch_distance(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b) {
  const Vector3 offset = patch_centre(b) - patch_centre(a);
  const Vector3 normal_a = patch_normal(a), normal_b = patch_normal(b);
  double gap = 0.0;
  for (const Vector3& direction : {offset, normal_a, normal_b}) {
    const double length = direction.norm();
    if (!(length > 0.0)) continue;
    const Vector3 towards = (offset.dot(direction) < 0.0 ? -1.0 : 1.0) / length * direction;
    gap = std::max(gap, gap_along(towards, a, b));
  }
  return gap - bulge_a - bulge_b;
}

double patch_distance_in_plane(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b) {
  const Vector3 offset = patch_centre(b) - patch_centre(a);
  double gap = 0.0;
  for (const PatchCorners* patch : {&a, &b}) {
    const Vector3 normal = patch_normal(*patch);
    for (const auto& [from, to] : sides) {
      const Vector3 direction = normal.cross((*patch)[to] - (*patch)[from]);
      const double length = direction.norm();
      if (!(length > 0.0)) continue;
      const Vector3 towards = (offset.dot(direction) < 0.0 ? -1.0 : 1.0) / length * direction;
      gap = std::max(gap, gap_along(towards, a, b));
    }
  }
  return gap - bulge_a - bulge_b;
}

}  // namespace spoonbill
