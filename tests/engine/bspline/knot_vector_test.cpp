#include "engine/bspline/knot_vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace spoonbill {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// Expects an error with the code `code` and with `part` in its message. `part` is empty if the code alone
// identifies the fault.
void expect_refused(const Result<KnotVector>& result, ErrorCode code, const std::string& part = "") {
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, code) << result.error().message;
  EXPECT_NE(result.error().message.find(part), std::string::npos) << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
}

TEST(KnotVector, RefusesADegreeOutOfRange) {
  for (const int degree : {-1, 0, 10, 1000000}) {
    const std::string part = "degree " + std::to_string(degree) + " is outside 1 to 9";
    expect_refused(KnotVector::open(degree, {0, 0, 1, 1}), ErrorCode::out_of_range, part);
    expect_refused(KnotVector::periodic(degree, {0, 1, 2}), ErrorCode::out_of_range, part);
    expect_refused(KnotVector::clamped_uniform(degree, 12), ErrorCode::out_of_range, part);
    expect_refused(KnotVector::periodic_uniform(degree, 12), ErrorCode::out_of_range, part);
  }
}

TEST(KnotVector, RefusesTooFewKnotsOrControlPoints) {
  expect_refused(KnotVector::open(3, {}), ErrorCode::too_few);
  expect_refused(KnotVector::open(3, {0, 0, 0, 0, 1, 1, 1}), ErrorCode::too_few);
  expect_refused(KnotVector::periodic(3, {0, 1}), ErrorCode::too_few);
  expect_refused(KnotVector::clamped_uniform(3, 3), ErrorCode::too_few);
  expect_refused(KnotVector::periodic_uniform(3, 1), ErrorCode::too_few);
}

TEST(KnotVector, RefusesKnotsThatAreNotFinite) {
  expect_refused(KnotVector::open(1, {0, 0, not_a_number, 1, 1}), ErrorCode::out_of_range,
                 "knot 2 (nan) is not a finite number");
  expect_refused(KnotVector::open(1, {-std::numeric_limits<double>::infinity(), 0, 0.5, 1, 1}),
                 ErrorCode::out_of_range, "knot 0 (-inf) is not a finite number");
  expect_refused(KnotVector::periodic(2, {0, 1, std::numeric_limits<double>::infinity()}),
                 ErrorCode::out_of_range, "knot 2 (inf) is not a finite number");
  expect_refused(KnotVector::open(1, {-1e308, -1e308, 1e308, 1e308}), ErrorCode::degenerate);
}

TEST(KnotVector, RefusesKnotsThatDecrease) {
  expect_refused(KnotVector::open(1, {0, 0, 0.25, 0.3, 0.4, 0.35, 1, 1}), ErrorCode::malformed,
                 "knot 5 (0.35) is smaller than knot 4 (0.4); knots must not decrease");
  expect_refused(KnotVector::periodic(1, {0, 0.5, 0.25, 1}), ErrorCode::malformed,
                 "knot 2 (0.25) is smaller than knot 1 (0.5)");
}

TEST(KnotVector, RefusesAnEmptyDomain) {
  expect_refused(KnotVector::open(2, {1, 1, 1, 1, 1, 1}), ErrorCode::degenerate);
  expect_refused(KnotVector::periodic(2, {1, 1, 1}), ErrorCode::degenerate);
}

TEST(KnotVector, RefusesExcessiveMultiplicity) {
  expect_refused(KnotVector::open(2, {0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1}), ErrorCode::malformed,
                 "knot 0.5 appears 3 times inside the domain, but at most 2");
  expect_refused(KnotVector::open(2, {0, 0, 0, 0, 0.5, 1, 1, 1}), ErrorCode::malformed,
                 "knot 0 appears 4 times at an end");
  expect_refused(KnotVector::open(2, {0, 0, 0, 0.5, 1, 1, 1, 1}), ErrorCode::malformed,
                 "knot 1 appears 4 times at an end");
  expect_refused(KnotVector::periodic(2, {0, 0.5, 0.5, 0.5, 1}), ErrorCode::malformed,
                 "knot 0.5 appears 3 times inside the period");
  expect_refused(KnotVector::periodic(2, {0, 0, 0.5, 1, 1}), ErrorCode::malformed,
                 "knot 0 appears 3 times at the periodic seam");
}

TEST(KnotVector, OpenKeepsItsKnotsAndDomain) {
  const auto clamped = KnotVector::clamped_uniform(3, 6).value();
  EXPECT_EQ(clamped.knots(), (std::vector<double>{0, 0, 0, 0, 1.0 / 3, 2.0 / 3, 1, 1, 1, 1}));
  EXPECT_EQ(clamped.control_point_count(), 6);
  EXPECT_EQ(clamped.breakpoints(), (std::vector<double>{0, 1.0 / 3, 2.0 / 3, 1}));

  const auto unclamped = KnotVector::open(2, {0, 1, 2, 3, 4, 5, 6}).value();
  EXPECT_EQ(unclamped.domain_start(), 2);
  EXPECT_EQ(unclamped.domain_end(), 4);
  EXPECT_EQ(unclamped.control_point_count(), 4);
}

TEST(KnotVector, PeriodicRepeatsItsKnotsOnBothSides) {
  const auto knots = KnotVector::periodic(2, {1, 2, 4, 5}).value();
  EXPECT_EQ(knots.extended_knots(), (std::vector<double>{-2, 0, 1, 2, 4, 5, 6, 8}));
  EXPECT_EQ(knots.domain_start(), 1);
  EXPECT_EQ(knots.domain_end(), 5);

  const auto few = KnotVector::periodic(5, {0, 1, 3}).value();
  EXPECT_EQ(few.extended_knots(), (std::vector<double>{-8, -6, -5, -3, -2, 0, 1, 3, 4, 6, 7, 9, 10}));
}

TEST(KnotVector, SeamMultiplicityMayStandAtEitherEnd) {
  EXPECT_TRUE(KnotVector::periodic(2, {0, 0, 0.5, 1}).ok());
  EXPECT_TRUE(KnotVector::periodic(2, {0, 0.5, 1, 1}).ok());
  EXPECT_TRUE(KnotVector::periodic(3, {0, 0, 0.5, 1, 1}).ok());
}

TEST(KnotVector, KnotsThatCoincideAtTheSeamCoincideToTheLastBit) {
  const auto at_end = KnotVector::periodic(3, {0.1, 0.4, 0.8, 0.8}).value();
  EXPECT_EQ(at_end.extended_knots()[2], 0.1);
  const auto at_start = KnotVector::periodic(3, {0.2, 0.2, 0.4, 0.9}).value();
  EXPECT_EQ(at_start.extended_knots()[7], 0.9);
}

// With fewer control points than the degree, the knots repeat over several periods.
TEST(KnotVector, KnotsThatCoincideDoSoInEveryPeriod) {
  const double seam = -0.84947456852662273, end = -0.34614869330139586;
  const std::vector<double> knots = KnotVector::periodic(8, {seam, seam, end}).value().extended_knots();
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double step = knots[i] - knots[i - 1];
    EXPECT_TRUE(step == 0.0 || step > 0.5) << "at knot " << i;
  }
}

TEST(KnotVector, BringsParametersIntoTheDomain) {
  const auto open = KnotVector::clamped_uniform(2, 5).value();
  EXPECT_EQ(open.into_domain(-3), 0);
  EXPECT_EQ(open.into_domain(0.3), 0.3);
  EXPECT_EQ(open.into_domain(7), 1);
  EXPECT_EQ(open.into_domain(not_a_number), 0);

  const auto periodic = KnotVector::periodic_uniform(2, 4).value();
  EXPECT_EQ(periodic.into_domain(1), 0);
  EXPECT_EQ(periodic.into_domain(2.25), 0.25);
  EXPECT_EQ(periodic.into_domain(-0.25), 0.75);
  EXPECT_EQ(periodic.into_domain(-1e-30), 0);
  EXPECT_EQ(periodic.into_domain(std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ(periodic.into_domain(not_a_number), 0);
}

TEST(KnotVector, SpansAreHalfOpenAndTheLastIsClosed) {
  const auto knots = KnotVector::open(2, {0, 0, 0, 1, 1, 2, 3, 3, 3}).value();
  EXPECT_EQ(knots.find_span(0), 2);
  EXPECT_EQ(knots.find_span(std::nextafter(1, 0)), 2);
  EXPECT_EQ(knots.find_span(1), 4);
  EXPECT_EQ(knots.find_span(2), 5);
  EXPECT_EQ(knots.find_span(3), 5);
}

TEST(KnotVector, PeriodicBasisFunctionsStartAtTheirKnot) {
  const auto knots = KnotVector::periodic_uniform(2, 4).value();
  const int span = knots.find_span(0.0);
  EXPECT_EQ(knots.control_index(span, 2), 0);
  EXPECT_EQ(knots.control_index(span, 1), 3);
  EXPECT_EQ(knots.control_index(span, 0), 2);
  EXPECT_EQ(knots.control_index(knots.find_span(0.8), 2), 3);
}

}  // namespace
}  // namespace spoonbill
