#include "engine/collision/levels/surface_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

double reciprocal(double numerator, double denominator) {
  return denominator > 0.0 ? numerator / denominator : 0.0;
}

struct Unrolled {
  std::vector<int> span, control;
  std::vector<double> first_scale, second_scale;
};

Unrolled unroll(const KnotVector& knots) {
  Unrolled result;
  const std::vector<double>& u = knots.extended_knots();
  const int p = knots.degree();
  const int count = static_cast<int>(u.size()) - p - 1;
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    result.span.push_back(knots.find_span(0.5 * (breaks[b] + breaks[b + 1])));
  }
  for (int i = 0; i < count; ++i) {
    result.control.push_back(knots.control_index(i, p));
    result.first_scale.push_back(i + 1 < count ? reciprocal(p, u[i + p + 1] - u[i + 1]) : 0.0);
    result.second_scale.push_back(i + 2 < count ? reciprocal(p - 1, u[i + p + 1] - u[i + 2]) : 0.0);
  }
  return result;
}

}  // namespace

SurfaceBounds::SurfaceBounds(const KnotVector& u, const KnotVector& v)
    : degree_u_(u.degree()), degree_v_(v.degree()) {
  Unrolled in_u = unroll(u), in_v = unroll(v);
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
  for (int i = 0; i < rows_; ++i) take_row(net, i);
  for (int eu = 0; eu < elements_u(); ++eu) take_elements(eu);
}

void SurfaceBounds::unroll_row(const ControlNet& net, int i) {
  const std::vector<double>* coordinates[3] = {&net.x, &net.y, &net.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* const from = coordinates[axis]->data() + control_u_[i] * net.columns;
    double* const to = row_[i % 3][axis].data();
    for (int j = 0; j < columns_; ++j) to[j] = from[control_v_[j]];
  }
}

// The norms of one unrolled row of control points, all columns at once. It and the next are unrolled already.
void SurfaceBounds::take_row(const ControlNet& net, int i) {
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

// The bounds of the elements (eu, .): first over their rows, all columns at once.
void SurfaceBounds::take_elements(int eu) {
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

void SurfaceBounds::take_norms(const ControlNet& net, int j) {
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
  for (int j = first; j <= span_v_[ev]; ++j) take_norms(net, j);
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

void SurfaceBounds::take_boxes(const ControlNet& net) {
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

}  // namespace spoonbill
