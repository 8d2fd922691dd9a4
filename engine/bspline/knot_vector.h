// One direction of a B-spline surface: degree, knots and, by them, the number of control points.
// A value type, immutable once made; any thread may read it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

// Degrees 1 to max_degree. Above 9 the refit of Eq. 5 loses more digits than a concept needs.
inline constexpr int max_degree = 9;

class KnotVector {
 public:
  // No knots, of no surface: to be assigned before anything is asked of it but whether it equals another.
  KnotVector() = default;

  // An open knot vector of n + degree + 1 nondecreasing knots for n control points, clamped or not. The
  // domain is [knots[degree], knots[n]]. Refused, with the offending knot named: degree out of 1..max_degree,
  // fewer than degree + 1 control points, a non-finite or decreasing knot, an empty domain, multiplicity
  // above the degree inside the domain or above degree + 1 at its ends.
  static Result<KnotVector> open(int degree, std::vector<double> knots);

  // A periodic knot vector: the r + 1 knots of one period, the last equal to the first plus the period, for r
  // control points. B_i starts at knot i, and B_i(u) = B_0((u - i + r) mod r) for uniform knots (Eq. 3 of
  // Pungotra et al. 2013, whose modulus r + 1 makes the sum fall to 1/3 at the seam). Needs r >= 2.
  static Result<KnotVector> periodic(int degree, std::vector<double> knots);

  // Uniform knots over [0, 1].
  static Result<KnotVector> clamped_uniform(int degree, int control_point_count);
  static Result<KnotVector> periodic_uniform(int degree, int control_point_count);

  int degree() const { return degree_; }
  int control_point_count() const { return control_point_count_; }
  bool is_periodic() const { return periodic_; }
  double domain_start() const { return extended_[degree_]; }
  double domain_end() const { return extended_[extended_.size() - 1 - degree_]; }

  // The knots as given to open() or periodic().
  const std::vector<double>& knots() const { return knots_; }

  // The knots that the recursion runs on: knots() itself when open; one period with `degree` further knots on
  // either side when periodic.
  const std::vector<double>& extended_knots() const { return extended_; }

  // The distinct knots inside the domain, both ends included: the ends of the polynomial pieces.
  std::vector<double> breakpoints() const;

  // u brought into the domain: wrapped when periodic (the end maps to the start), clamped to it when open.
  // What is not a number maps to the start, so that no parameter whatever leads out of the knots.
  double into_domain(double u) const;

  // The index k into extended_knots() with extended[k] <= u < extended[k + 1], the last span closed.
  // u must lie in the domain.
  int find_span(double u) const;

  // The control point that the basis function j of span k (j = 0..degree) belongs to.
  int control_index(int span, int j) const;

  friend bool operator==(const KnotVector&, const KnotVector&) = default;

 private:
  int degree_ = 0;
  int control_point_count_ = 0;
  bool periodic_ = false;
  std::vector<double> knots_;
  std::vector<double> extended_;
};

}  // namespace spoonbill
