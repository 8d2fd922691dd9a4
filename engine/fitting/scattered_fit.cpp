#include "engine/fitting/scattered_fit.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/piece_basis.h"

namespace spoonbill {
namespace {

// Weight of the condition that makes a pole smooth, relative to the weight of one span's points. It is low,
// because u may run unevenly around a pole.
constexpr double smooth_pole_fraction = 0.1;
// Weight of the condition that keeps the rings next to a pole elliptic, relative to the weight of one span's
// points. It falls with the cube of the distance from the pole, because deviations from an ellipse grow with
// that cube on a smooth surface.
constexpr double round_pole_fraction = 0.003;
constexpr int round_pole_spans = 3;

// Normal equations of the fit. For each control point they hold the products of its basis function with the
// basis functions of all control points up to `degree` away, so that adding needs no search. The indices of
// an entry are (control, du + degree, dv + degree), where du and dv are the index differences between the two
// control points.
class NormalEquations {
 public:
  NormalEquations(const SurfaceStructure& structure)
      : pu_(structure.u.degree()),
        pv_(structure.v.degree()),
        rows_(structure.u.control_point_count()),
        columns_(structure.v.control_point_count()),
        width_(2 * pv_ + 1),
        block_((2 * pu_ + 1) * width_),
        products_(static_cast<std::size_t>(rows_) * columns_ * block_),
        right_(static_cast<std::size_t>(rows_) * columns_, Vector3::Zero()) {}

  // Adds a weighted equation: the sum over k and l of a_k b_l times the control point (rows[k], columns[l])
  // equals `value`. If `value` is null, it is zero.
  void add(const double* a, const int* rows, const double* b, const int* columns, double weight,
           const Vector3* value) {
    for (int k = 0; k <= pu_; ++k) {
      for (int l = 0; l <= pv_; ++l) {
        const double factor = weight * a[k] * b[l];
        const std::size_t control = index(rows[k], columns[l]);
        double* const block = &products_[control * block_];
        for (int m = k; m <= pu_; ++m) {
          double* const line = block + (m - k + pu_) * width_ + pv_ - l;
          const double along = factor * a[m];
          for (int n = 0; n <= pv_; ++n) line[n] += along * b[n];
        }
        if (value != nullptr) right_[control] += factor * *value;
      }
    }
  }

  void set_pole_weight(double weight) { pole_weight_ = weight; }
  // Adds the matrix of another system, multiplied by the factor; its right-hand side is not added.
  void add(const NormalEquations& other, double factor) {
    for (std::size_t k = 0; k < products_.size(); ++k) products_[k] += factor * other.products_[k];
  }
  Result<Surface> solve(const SurfaceStructure& structure) const;

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
  }
  std::vector<int> unknowns(const SurfaceStructure& structure, int& count) const;
  template <class Put>
  void add_smooth_pole(const SurfaceStructure& structure, const std::vector<int>& unknown, int pole, int ring,
                       const Put& put) const;

  int pu_, pv_, rows_, columns_, width_, block_;
  std::vector<double> products_;
  std::vector<Vector3> right_;
  double pole_weight_ = 0.0;
};

// Returns the index of the unknown of each control point; the control points of a pole share one unknown.
std::vector<int> NormalEquations::unknowns(const SurfaceStructure& structure, int& count) const {
  std::vector<int> unknown(right_.size());
  count = 0;
  const int start = structure.pole_at_start ? count++ : -1;
  const int end = structure.pole_at_end ? count++ : -1;
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) {
      const bool at_start = j == 0 && start >= 0, at_end = j == columns_ - 1 && end >= 0;
      unknown[index(i, j)] = at_start ? start : at_end ? end : count++;
    }
  }
  return unknown;
}

// Adds the condition that makes a pole smooth. Around a pole with a tangent plane, the mean of the derivative
// with respect to v is zero. The pole is therefore the mean of the next ring of control points, weighted by
// the integrals of their basis functions.
template <class Put>
void NormalEquations::add_smooth_pole(const SurfaceStructure& structure, const std::vector<int>& unknown,
                                      int pole, int ring, const Put& put) const {
  const std::vector<double>& knots = structure.u.extended_knots();
  const double period = structure.u.domain_length();
  std::vector<std::pair<int, double>> terms{{unknown[index(0, pole)], -1.0}};
  for (int i = 0; i < rows_; ++i) terms.emplace_back(unknown[index(i, ring)], 0.0);
  // Basis function k is nonzero between knots[k] and knots[k + degree + 1].
  for (int k = 0; k < rows_; ++k) {
    const auto first = static_cast<std::size_t>(k), last = first + static_cast<std::size_t>(pu_) + 1;
    const int control = structure.u.control_index(k + pu_, 0);
    terms[static_cast<std::size_t>(control) + 1].second +=
        (knots[last] - knots[first]) / ((pu_ + 1) * period);
  }
  for (const auto& [a, at_a] : terms) {
    for (const auto& [b, at_b] : terms) put(a, b, pole_weight_ * at_a * at_b);
  }
}

Result<Surface> NormalEquations::solve(const SurfaceStructure& structure) const {
  int count = 0;
  const std::vector<int> unknown = unknowns(structure, count);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(products_.size());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  const auto put = [&](int a, int b, double value) {
    if (a >= b) entries.emplace_back(a, b, value);
  };
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) {
      const std::size_t control = index(i, j);
      right.row(unknown[control]) += right_[control].transpose();
      const double* const block = &products_[control * block_];
      for (int di = 0; di <= pu_; ++di) {
        if (i + di >= rows_ && !structure.u.is_periodic()) break;
        for (int dj = -pv_; dj <= pv_; ++dj) {
          if (j + dj < 0 || j + dj >= columns_) continue;
          const double value = block[(di + pu_) * width_ + dj + pv_];
          const int other = unknown[index((i + di) % rows_, j + dj)];
          put(unknown[control], other, value);
          // Adds the symmetric half of the matrix, which add() does not store.
          if (di > 0) put(other, unknown[control], value);
        }
      }
    }
  }
  if (structure.pole_at_start) add_smooth_pole(structure, unknown, 0, 1, put);
  if (structure.pole_at_end) add_smooth_pole(structure, unknown, columns_ - 1, columns_ - 2, put);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  const Error indefinite{ErrorCode::degenerate,
                         "the points do not determine the surface; use fewer control points"};
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return indefinite;
  const Eigen::MatrixXd solution = factor.solve(right);
  if (!solution.allFinite()) return indefinite;
  ControlNet net(rows_, columns_);
  for (int i = 0; i < rows_; ++i) {
    for (int j = 0; j < columns_; ++j) net.set_point(i, j, solution.row(unknown[index(i, j)]).transpose());
  }
  return make_surface(structure.u, structure.v, std::move(net));
}

double span_weight(const ScatteredData& data, std::size_t spans) {
  double sum = 0.0;
  for (std::size_t p = 0; p < data.uv.size(); ++p) {
    if (!data.uv[p].hasNaN()) sum += data.weights[p];
  }
  return sum / static_cast<double>(spans);
}

// Values and derivatives of the basis functions at the two Gauss points of a span. A derivative of order n is
// multiplied by the n-th power of the span's length.
struct SpanBasis {
  std::array<PieceBasis::Values, 2> at;
};

std::vector<SpanBasis> span_bases(const PieceBasis& basis) {
  const double gauss = 0.5 / std::sqrt(3.0);
  const std::vector<double> breaks = basis.knots().breakpoints();
  std::vector<SpanBasis> spans(breaks.size() - 1);
  for (std::size_t s = 0; s < spans.size(); ++s) {
    const double length = breaks[s + 1] - breaks[s], midpoint = 0.5 * (breaks[s] + breaks[s + 1]);
    for (int side = 0; side < 2; ++side) {
      PieceBasis::Values& values = spans[s].at[side];
      basis.evaluate(midpoint + (side == 0 ? -gauss : gauss) * length, values);
      for (int k = 0; k <= basis.degree(); ++k) {
        values.value[1][k] *= length;
        values.value[2][k] *= length * length;
      }
    }
  }
  return spans;
}

void add_fairness(const SurfaceStructure& structure, double weight, std::span<const double> fairness,
                  NormalEquations& equations) {
  const PieceBasis u_basis(structure.u), v_basis(structure.v);
  const std::vector<SpanBasis> u_spans = span_bases(u_basis), v_spans = span_bases(v_basis);
  constexpr double gauss_weight = 0.25;
  for (std::size_t s = 0; s < u_spans.size(); ++s) {
    for (std::size_t t = 0; t < v_spans.size(); ++t) {
      const double factor = gauss_weight * weight * fairness[s * v_spans.size() + t];
      for (const PieceBasis::Values& u : u_spans[s].at) {
        for (const PieceBasis::Values& v : v_spans[t].at) {
          const auto add = [&](int du, int dv, double times) {
            equations.add(u.value[du].data(), u.controls, v.value[dv].data(), v.controls, times * factor,
                          nullptr);
          };
          add(2, 0, 1.0);
          add(1, 1, 2.0);
          add(0, 2, 1.0);
        }
      }
    }
  }
}

// Returns the non-elliptic part of a ring, (S_u + S_uuu / (2 pi)^2) / (2 pi), at two Gauss points of each
// span of u. The values are factors of the control points.
std::vector<PieceBasis::Values> ring_bases(const PieceBasis& u_basis) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const std::vector<double> breaks = u_basis.knots().breakpoints();
  std::vector<PieceBasis::Values> rings;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) {
    const double length = breaks[s + 1] - breaks[s];
    const auto at = [&](double fraction) {
      PieceBasis::Values values;
      u_basis.evaluate(breaks[s] + fraction * length, values);
      return values;
    };
    // The second derivative of a cubic is linear within a span, so its values at two points determine the
    // third derivative.
    const PieceBasis::Values low = at(0.25), high = at(0.75);
    for (const double fraction : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      PieceBasis::Values ring = at(fraction);
      const double root = std::sqrt(0.5 * length);  // square root of the Gauss weight
      for (int k = 0; k <= u_basis.degree(); ++k) {
        const double third = (high.value[2][k] - low.value[2][k]) / (0.5 * length);
        ring.value[0][k] = root * (ring.value[1][k] / turn + third / (turn * turn * turn));
      }
      rings.push_back(ring);
    }
  }
  return rings;
}

void add_round_poles(const SurfaceStructure& structure, double weight, NormalEquations& equations) {
  const PieceBasis u_basis(structure.u), v_basis(structure.v);
  const std::vector<PieceBasis::Values> rings = ring_bases(u_basis);
  const std::vector<double> v_breaks = structure.v.breakpoints();
  const int v_spans = static_cast<int>(v_breaks.size()) - 1;
  for (const bool at_end : {false, true}) {
    if (!(at_end ? structure.pole_at_end : structure.pole_at_start)) continue;
    for (int t = 0; t < std::min(round_pole_spans, v_spans / 2); ++t) {
      const auto span = static_cast<std::size_t>(at_end ? v_spans - 1 - t : t);
      PieceBasis::Values v;
      v_basis.evaluate_values(0.5 * (v_breaks[span] + v_breaks[span + 1]), v);
      const double factor =
          round_pole_fraction * weight * static_cast<double>(span_count(structure.u)) / std::pow(t + 1, 3);
      for (const PieceBasis::Values& ring : rings) {
        equations.add(ring.value[0].data(), ring.controls, v.value[0].data(), v.controls, factor, nullptr);
      }
    }
  }
}

}  // namespace

std::size_t span_count(const KnotVector& knots) {
  return knots.breakpoints().size() - 1;
}

Result<std::vector<Surface>> fit_scattered_family(const SurfaceStructure& structure,
                                                  const ScatteredData& data, std::span<const double> fairness,
                                                  std::span<const double> factors) {
  SPOONBILL_ASSERT(data.uv.size() == data.points_m.size() && data.weights.size() == data.points_m.size());
  SPOONBILL_ASSERT(fairness.size() == span_count(structure.u) * span_count(structure.v));
  const std::size_t spans = span_count(structure.u) * span_count(structure.v);
  const double weight = span_weight(data, spans);
  if (!(weight > 0.0)) return Error(ErrorCode::too_few, "no points are left to fit");
  NormalEquations distances(structure), stiffness(structure);
  const PieceBasis u_basis(structure.u), v_basis(structure.v);
  PieceBasis::Values u, v;
  for (std::size_t p = 0; p < data.uv.size(); ++p) {
    if (data.uv[p].hasNaN() || data.weights[p] == 0.0) continue;
    u_basis.evaluate_values(structure.u.into_domain(data.uv[p].x()), u);
    v_basis.evaluate_values(structure.v.into_domain(data.uv[p].y()), v);
    distances.add(u.value[0].data(), u.controls, v.value[0].data(), v.controls, data.weights[p],
                  &data.points_m[p]);
  }
  add_round_poles(structure, weight, distances);
  distances.set_pole_weight(smooth_pole_fraction * weight);
  add_fairness(structure, weight, fairness, stiffness);
  std::vector<Surface> surfaces;
  for (const double factor : factors) {
    NormalEquations equations = distances;
    equations.add(stiffness, factor);
    auto surface = equations.solve(structure);
    if (!surface) return surface.error();
    surfaces.push_back(std::move(surface).value());
  }
  return surfaces;
}

Result<Surface> fit_scattered(const SurfaceStructure& structure, const ScatteredData& data,
                              std::span<const double> fairness) {
  SPOONBILL_ASSERT(data.uv.size() == data.points_m.size() && data.weights.size() == data.points_m.size());
  SPOONBILL_ASSERT(fairness.size() == span_count(structure.u) * span_count(structure.v));
  constexpr std::array as_it_is{1.0};
  auto surfaces = fit_scattered_family(structure, data, fairness, as_it_is);
  if (!surfaces) return surfaces.error();
  return std::move(surfaces.value().front());
}

namespace {

constexpr double evenly_spread_fraction = 0.3;

struct Span {
  double begin, end;
  double error;
};

std::vector<Span> spans_with_errors(const KnotVector& knots, int direction, std::span<const Vector2> uv,
                                    std::span<const double> weighted_squares) {
  const std::vector<double> breaks = knots.breakpoints();
  std::vector<Span> spans;
  for (std::size_t s = 0; s + 1 < breaks.size(); ++s) spans.push_back({breaks[s], breaks[s + 1], 0.0});
  for (std::size_t p = 0; p < uv.size(); ++p) {
    if (uv[p].hasNaN()) continue;
    const double at = knots.into_domain(uv[p][direction]);
    const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, at);
    spans[static_cast<std::size_t>(above - breaks.begin()) - 1].error += weighted_squares[p];
  }
  const double sum = std::accumulate(spans.begin(), spans.end(), 0.0,
                                     [](double total, const Span& span) { return total + span.error; });
  const double length = breaks.back() - breaks.front();
  for (Span& span : spans) span.error += evenly_spread_fraction * sum * (span.end - span.begin) / length;
  return spans;
}

KnotVector make_knots(const KnotVector& like, const std::vector<Span>& spans) {
  std::vector<double> knots;
  knots.reserve(spans.size() + 1);
  for (const Span& span : spans) knots.push_back(span.begin);
  knots.push_back(spans.back().end);
  if (like.is_periodic()) return KnotVector::periodic(like.degree(), std::move(knots)).value();
  const auto ends = static_cast<std::size_t>(like.degree());
  knots.insert(knots.begin(), ends, knots.front());
  knots.insert(knots.end(), ends, knots.back());
  return KnotVector::open(like.degree(), std::move(knots)).value();
}

}  // namespace

KnotVector refine_knots(const KnotVector& knots, int direction, int count, std::span<const Vector2> uv,
                        std::span<const double> weighted_squares) {
  SPOONBILL_ASSERT(direction == 0 || direction == 1);
  SPOONBILL_ASSERT(uv.size() == weighted_squares.size());
  std::vector<Span> spans = spans_with_errors(knots, direction, uv, weighted_squares);
  const double length = knots.domain_length();
  for (int missing = count - knots.control_point_count(); missing > 0; --missing) {
    const double shortest = length / static_cast<double>(8 * spans.size());
    const auto worth = [&](const Span& span) {
      return span.end - span.begin < 2.0 * shortest ? -1.0 : span.error;
    };
    const auto most = std::max_element(spans.begin(), spans.end(),
                                       [&](const Span& a, const Span& b) { return worth(a) < worth(b); });
    // Each half gets a quarter of the error, because the error of a cubic falls steeply with the length of
    // its span.
    const Span whole = *most;
    const double midpoint = 0.5 * (whole.begin + whole.end);
    *most = {whole.begin, midpoint, 0.25 * whole.error};
    spans.insert(most + 1, {midpoint, whole.end, 0.25 * whole.error});
  }
  return make_knots(knots, spans);
}

}  // namespace spoonbill
