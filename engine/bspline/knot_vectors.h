// New knot vectors from old ones: of a higher degree, common to two, on a part of the domain, turned around.
// Pure functions; any thread.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Knots nearer to each other than this share of the domain count as one, because documents hold none that are
// nearer without being equal.
inline constexpr double same_knot_share = 1e-9;

// A distinct knot inside the domain, its ends included (of a period, the start alone), and how often it
// stands there. Open ends count as clamped.
struct KnotMultiplicity {
  double knot;
  int multiplicity;
};
std::vector<KnotMultiplicity> knot_multiplicities(const KnotVector& knots);

// Where a knot stands within a period from `start` on, both of its places where the period ends on it; of
// open knots, itself.
std::vector<double> places_from(const KnotVector& knots, double knot, double start);

// Of the degree, not below that of `knots`, and such that every spline over `knots` is one over these: each
// knot stands as many times more often as the degree is higher. Open ones become clamped.
Result<KnotVector> elevated(const KnotVector& knots, int degree);

// Of a lower degree and the same continuity at every knot, but at most C^(degree - 1). Open ones become
// clamped.
Result<KnotVector> reduced(const KnotVector& knots, int degree);

// Every knot of both, as often as in that which has it more often. Refused: different degrees, one of them
// periodic alone, domains that differ by more than same_knot_share.
Result<KnotVector> knot_union(const KnotVector& a, const KnotVector& b);

// The part from `start` to `end` as a clamped knot vector; of a periodic one also across the seam, where
// `end` is at most one period beyond `start`. Refused: a part that is empty or outside the domain.
Result<KnotVector> clamped_part(const KnotVector& knots, double start, double end);

// Stretched so that the domain is [start, end]. Refused unless start < end, both finite.
Result<KnotVector> with_domain(const KnotVector& knots, double start, double end);

// The same domain, run through from its end to its start.
KnotVector reversed(const KnotVector& knots);

// One more knot in the middle of each piece that holds a parameter of `where`. Pieces shorter than a
// millionth of the domain are left.
Result<KnotVector> with_pieces_halved(const KnotVector& knots, const std::vector<double>& where);

}  // namespace spoonbill
