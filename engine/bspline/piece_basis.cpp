#include "engine/bspline/piece_basis.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr int vector_width = 4;
// Smallest sine of the angle between the tangents for which their cross product keeps enough digits.
constexpr double min_sine = 1e-5;

using Polynomials = std::array<std::array<double, max_degree + 1>, max_degree + 1>;

// Returns the basis functions of a span (Cox-de Boor recursion) as polynomials in x, where u = centre + half
// x: result[j][k] is the coefficient of x^k in the j-th function.
Polynomials compute_polynomials(const double* at, int degree, double centre, double half) {
  Polynomials result{};
  result[0][0] = 1.0;
  for (int p = 1; p <= degree; ++p) {
    Polynomials next{};
    for (int j = 0; j < p; ++j) {
      // Function j of degree p - 1 extends over the knots from `low` to `high`.
      const double low = at[j - p + 1], high = at[j + 1], scale = 1.0 / (high - low);
      for (int k = 0; k < p; ++k) {
        const double coefficient = scale * result[j][k];
        next[j + 1][k] += (centre - low) * coefficient;
        next[j + 1][k + 1] += half * coefficient;
        next[j][k] += (high - centre) * coefficient;
        next[j][k + 1] -= half * coefficient;
      }
    }
    result = next;
  }
  return result;
}

}  // namespace

PieceBasis::PieceBasis(const KnotVector& knots)
    : knots_(&knots),
      degree_(knots.degree()),
      padded_((knots.degree() + vector_width) / vector_width * vector_width),
      breaks_(knots.breakpoints()) {
  const int pieces = static_cast<int>(breaks_.size()) - 1;
  pieces_a_unit_ = pieces / (breaks_.back() - breaks_.front());
  coefficients_.assign(static_cast<std::size_t>(pieces * (degree_ + 1) * padded_), 0.0);
  for (int piece = 0; piece < pieces; ++piece) {
    const double centre = 0.5 * (breaks_[piece] + breaks_[piece + 1]),
                 half = 0.5 * (breaks_[piece + 1] - breaks_[piece]);
    scales_.push_back(1.0 / half);
    const int span = knots.find_span(centre);
    const Polynomials polynomials =
        compute_polynomials(knots.extended_knots().data() + span, degree_, centre, half);
    for (int j = 0; j <= degree_; ++j) {
      controls_.push_back(knots.control_index(span, j));
      for (int k = 0; k <= degree_; ++k) {
        coefficients_[(piece * (degree_ + 1) + degree_ - k) * padded_ + j] = polynomials[j][k];
      }
    }
  }
}

// Finds the piece by an estimate that is exact for evenly spaced knots. For other knots, steps to
// neighbouring pieces correct the estimate.
int PieceBasis::find_piece(double u) const {
  const int pieces = static_cast<int>(breaks_.size()) - 1;
  int piece = std::clamp(static_cast<int>((u - breaks_.front()) * pieces_a_unit_), 0, pieces - 1);
  while (piece > 0 && u < breaks_[piece]) --piece;
  while (piece + 1 < pieces && u >= breaks_[piece + 1]) ++piece;
  return piece;
}

void PieceBasis::evaluate(double u, Values& values) const {
  SPOONBILL_ASSERT_DEBUG(u >= breaks_.front() && u <= breaks_.back());
  const int piece = find_piece(u);
  values.controls = controls_.data() + piece * (degree_ + 1);
  const double* row = coefficients_.data() + piece * (degree_ + 1) * padded_;
  const double scale = scales_[piece], x = (u - breaks_[piece]) * scale - 1.0;
  for (int first = 0; first < padded_; first += vector_width) {
    double value[vector_width] = {}, slope[vector_width] = {}, bend[vector_width] = {};
    const double* coefficient = row + first;
    for (int k = 0; k <= degree_; ++k, coefficient += padded_) {
      for (int j = 0; j < vector_width; ++j) {
        bend[j] = bend[j] * x + slope[j];
        slope[j] = slope[j] * x + value[j];
        value[j] = value[j] * x + coefficient[j];
      }
    }
    for (int j = 0; j < vector_width; ++j) {
      values.value[0][first + j] = value[j];
      values.value[1][first + j] = slope[j] * scale;
      values.value[2][first + j] = bend[j] * (2.0 * scale * scale);
    }
  }
}

void PieceBasis::evaluate_values(double u, Values& values) const {
  SPOONBILL_ASSERT_DEBUG(u >= breaks_.front() && u <= breaks_.back());
  const int piece = find_piece(u);
  values.controls = controls_.data() + piece * (degree_ + 1);
  const double* row = coefficients_.data() + piece * (degree_ + 1) * padded_;
  const double x = (u - breaks_[piece]) * scales_[piece] - 1.0;
  for (int first = 0; first < padded_; first += vector_width) {
    double value[vector_width] = {};
    const double* coefficient = row + first;
    for (int k = 0; k <= degree_; ++k, coefficient += padded_) {
      for (int j = 0; j < vector_width; ++j) value[j] = value[j] * x + coefficient[j];
    }
    for (int j = 0; j < vector_width; ++j) values.value[0][first + j] = value[j];
  }
}

SurfacePoint evaluate(const PiecewiseSurface& surface, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(surface.surface != nullptr && surface.u != nullptr && surface.v != nullptr);
  const Surface& whole = *surface.surface;
  PieceBasis::Values bu, bv;
  surface.u->evaluate(whole.u.into_domain(u), bu);
  surface.v->evaluate(whole.v.into_domain(v), bv);
  const double* const controls[3] = {whole.net.x.data(), whole.net.y.data(), whole.net.z.data()};
  SurfacePoint point;
  for (int axis = 0; axis < 3; ++axis) {
    double sums[6] = {};  // sums for the position, du, dv, duu, duv and dvv
    for (int i = 0; i <= surface.u->degree(); ++i) {
      const double* const row = controls[axis] + bu.controls[i] * whole.net.columns;
      double value = 0.0, dv = 0.0, dvv = 0.0;
      for (int j = 0; j <= surface.v->degree(); ++j) {
        const double control = row[bv.controls[j]];
        value += bv.value[0][j] * control;
        dv += bv.value[1][j] * control;
        dvv += bv.value[2][j] * control;
      }
      sums[0] += bu.value[0][i] * value;
      sums[1] += bu.value[1][i] * value;
      sums[2] += bu.value[0][i] * dv;
      sums[3] += bu.value[2][i] * value;
      sums[4] += bu.value[1][i] * dv;
      sums[5] += bu.value[0][i] * dvv;
    }
    point.position_m[axis] = sums[0];
    point.du[axis] = sums[1];
    point.dv[axis] = sums[2];
    point.duu[axis] = sums[3];
    point.duv[axis] = sums[4];
    point.dvv[axis] = sums[5];
  }
  return point;
}

Vector3 position(const PiecewiseSurface& surface, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(surface.surface != nullptr && surface.u != nullptr && surface.v != nullptr);
  const Surface& whole = *surface.surface;
  PieceBasis::Values bu, bv;
  surface.u->evaluate_values(whole.u.into_domain(u), bu);
  surface.v->evaluate_values(whole.v.into_domain(v), bv);
  return position(surface, bu, bv);
}

Vector3 position(const PiecewiseSurface& surface, const PieceBasis::Values& u, const PieceBasis::Values& v) {
  const Surface& whole = *surface.surface;
  const double* const controls[3] = {whole.net.x.data(), whole.net.y.data(), whole.net.z.data()};
  Vector3 point = Vector3::Zero();
  for (int i = 0; i <= surface.u->degree(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double* const row = controls[axis] + u.controls[i] * whole.net.columns;
      double value = 0.0;
      for (int j = 0; j <= surface.v->degree(); ++j) value += v.value[0][j] * row[v.controls[j]];
      point[axis] += u.value[0][i] * value;
    }
  }
  return point;
}

namespace {

bool is_end(const KnotVector& knots, double parameter) {
  return !knots.is_periodic() && (parameter <= knots.domain_start() || parameter >= knots.domain_end());
}

}  // namespace

bool is_on_edge(const PiecewiseSurface& surface, double u, double v) {
  return is_end(surface.u->knots(), u) || is_end(surface.v->knots(), v);
}

namespace {

// On an edge that is collapsed to a point, and beside it, one of the tangents is only rounding noise. This is
// twice the distance from the edge, in domain lengths, at which unit_normal(Surface) expects that.
constexpr double beside_edge = 2e-6;

bool is_beside_end(const KnotVector& knots, double parameter) {
  if (knots.is_periodic()) return false;
  const double margin = beside_edge * knots.domain_length();
  return parameter <= knots.domain_start() + margin || parameter >= knots.domain_end() - margin;
}

}  // namespace

Vector3 unit_normal(const PiecewiseSurface& surface, const SurfacePoint& at, double u, double v) {
  if (is_beside_end(surface.u->knots(), u) || is_beside_end(surface.v->knots(), v)) {
    return unit_normal(*surface.surface, u, v);
  }
  const Vector3 across = at.du.cross(at.dv);
  const double squared = across.squaredNorm();
  if (squared > min_sine * min_sine * at.du.squaredNorm() * at.dv.squaredNorm()) {
    return across / std::sqrt(squared);
  }
  return unit_normal(*surface.surface, u, v);
}

}  // namespace spoonbill
