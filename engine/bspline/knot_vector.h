// Knot vectors: one direction of a B-spline surface or curve, and new knot vectors derived from existing
// ones. All functions are pure; any thread may call them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

// Largest degree; the smallest is 1. Above 9, the pseudo-inverse in a least-squares fit (pseudo_inverse())
// loses too many digits.
inline constexpr int max_degree = 9;

// A parameter direction of a surface.
enum class Direction { u, v };

// Returns "direction u" or "direction v", the context of error messages.
constexpr const char* direction_name(Direction direction) {
  return direction == Direction::u ? "direction u" : "direction v";
}

// Degree and knots of one direction, which determine the number of control points. A value type, immutable
// once made; any thread may read it.
class KnotVector {
 public:
  // Constructs an empty knot vector, to be assigned before any use other than comparison.
  KnotVector() = default;

  // Makes an open knot vector, clamped or not, from n + degree + 1 nondecreasing knots for n control points.
  // The domain is [knots[degree], knots[n]]. Refuses a degree outside 1..max_degree, fewer than degree + 1
  // control points, non-finite or decreasing knots, an empty domain, and a multiplicity above the degree
  // inside the domain or above degree + 1 at its ends.
  static Result<KnotVector> open(int degree, std::vector<double> knots);

  // Makes a periodic knot vector for r >= 2 control points from the r + 1 knots of one period; the last knot
  // is the first plus the period. The support of basis function B_i starts at knot i. For the knots 0, 1,
  // ..., r, B_i(u) = B_0((u - i + r) mod r). This is Eq. 3 of Pungotra et al. (2013), but with modulus r:
  // with their modulus r + 1, the sum of the basis functions falls to 1/3 at the seam.
  static Result<KnotVector> periodic(int degree, std::vector<double> knots);

  // Makes evenly spaced knots over the domain [0, 1].
  static Result<KnotVector> clamped_uniform(int degree, int control_point_count);
  static Result<KnotVector> periodic_uniform(int degree, int control_point_count);

  int degree() const { return degree_; }
  int control_point_count() const { return control_point_count_; }
  bool is_periodic() const { return periodic_; }
  // Returns whether the surface interpolates its control points at the end of the domain (`at_end` is true)
  // or at the start (`at_end` is false). Always false for a periodic direction.
  bool is_clamped(bool at_end) const {
    if (periodic_) return false;
    return at_end ? knots_.back() == domain_end() : knots_.front() == domain_start();
  }
  double domain_start() const { return extended_[degree_]; }
  double domain_end() const { return extended_[extended_.size() - 1 - degree_]; }
  double domain_length() const { return domain_end() - domain_start(); }
  // Returns the parameter at a fraction of the domain, 0 to 1.
  double parameter_at(double fraction) const { return domain_start() + fraction * domain_length(); }

  // Returns the knots as given to open() or periodic().
  const std::vector<double>& knots() const { return knots_; }

  // Returns the knots for the Cox-de Boor recursion: knots() if open; one period with `degree` further knots
  // on either side if periodic.
  const std::vector<double>& extended_knots() const { return extended_; }

  // Returns the distinct knots in the domain, both ends included, which are the ends of the polynomial
  // pieces.
  std::vector<double> breakpoints() const;

  // Returns u wrapped (periodic; the end maps to the start) or clamped (open) into the domain. NaN maps to
  // the start, so that the result is always in the domain.
  double into_domain(double u) const;

  // Returns the index k into extended_knots() with extended[k] <= u < extended[k + 1]. The end of the domain
  // belongs to the last span. u must be in the domain.
  int find_span(double u) const;

  // Returns the index of the control point that belongs to basis function j (0..degree) of a span.
  int control_index(int span, int j) const;

  // Reserves memory, so that a knot vector of up to so many control points can be assigned without
  // allocation.
  void reserve(int control_points);

  friend bool operator==(const KnotVector&, const KnotVector&) = default;

 private:
  int degree_ = 0;
  int control_point_count_ = 0;
  bool periodic_ = false;
  std::vector<double> knots_;
  std::vector<double> extended_;
};

// Fraction of the domain below which the distance of two knots is ignored, so that they count as one.
// Documents contain no distinct knots that are closer than this.
inline constexpr double same_knot_fraction = 1e-9;

// A distinct knot and its multiplicity.
struct KnotMultiplicity {
  double knot;
  int multiplicity;
};
// Returns the distinct knots in the domain, except its end, with their multiplicities. The start of an open
// direction counts as clamped; the start of a period has the multiplicity of the seam.
std::vector<KnotMultiplicity> knot_multiplicities(const KnotVector& knots);

// Returns the first two positions of a knot at or after `start` in a periodic direction, where the knot
// occurs once in every period. In an open direction, returns the knot itself.
std::vector<double> knot_positions_from(const KnotVector& knots, double knot, double start);

// Returns a knot vector of a higher or equal degree that represents every spline over `knots`: each
// multiplicity grows by the difference of the degrees. Open ends become clamped. Refuses a lower degree and a
// degree above max_degree.
Result<KnotVector> elevate_degree(const KnotVector& knots, int degree);

// Returns a knot vector of a lower or equal degree. The continuity at every knot stays the same but is at
// most C^(degree - 1). Open ends become clamped.
Result<KnotVector> reduce_degree(const KnotVector& knots, int degree);

// Returns the union of two knot vectors: every knot of either, with the larger of its two multiplicities.
// Refuses different degrees, periodicity or domains.
Result<KnotVector> knot_union(const KnotVector& a, const KnotVector& b);

// Returns the part from `start` to `end` as a clamped knot vector. In a periodic direction the part may cross
// the seam, with `end` at most one period beyond `start`. Refuses a part that is empty or outside the domain.
Result<KnotVector> clamped_part(const KnotVector& knots, double start, double end);

// Returns the knots scaled to the domain [start, end]. Refuses ends that are not finite or not increasing.
Result<KnotVector> with_domain(const KnotVector& knots, double start, double end);

// Returns the knots mirrored within the same domain.
KnotVector reversed(const KnotVector& knots);

// Returns the knots with one more knot at the midpoint of each polynomial piece that contains a parameter of
// `where`. Pieces shorter than a millionth of the domain stay as they are.
Result<KnotVector> halve_pieces(const KnotVector& knots, const std::vector<double>& where);

}  // namespace spoonbill
