#include "engine/base/result.h"

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "tests/engine/throwing_asserts.h"

namespace spoonbill {
namespace {

TEST(Result, AssertsThatItHoldsWhatIsTaken) {
  const ThrowingAsserts throwing;
  const Result<int> three = 3, refused = Error{ErrorCode::too_many, "too many", "bodies"};
  EXPECT_EQ(three.value(), 3);
  EXPECT_EQ(refused.error().code, ErrorCode::too_many);
  EXPECT_EQ(refused.error().message, "too many");
  EXPECT_EQ(refused.error().field, "bodies");
  EXPECT_EQ(refused.error().in("scene").message, "scene: too many");
  EXPECT_EQ(refused.error().in("scene").code, ErrorCode::too_many);
  EXPECT_THROW(refused.value(), FailedAssertion);
  EXPECT_THROW(three.error(), FailedAssertion);
  EXPECT_THROW(Status().error(), FailedAssertion);
}

TEST(Progress, AssertsThatPartsRunForwards) {
  const ThrowingAsserts throwing;
  EXPECT_THROW(Progress().part(0.5, 0.2), FailedAssertion);
  EXPECT_THROW(RoundsDone(1.0), FailedAssertion);
}

}  // namespace
}  // namespace spoonbill
