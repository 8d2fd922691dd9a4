// Makes failed assertions throw while an object of this class exists. Tests of preconditions use it with
// EXPECT_THROW(..., FailedAssertion).
#pragma once

#include "engine/base/assert.h"

namespace spoonbill {

class ThrowingAsserts {
 public:
  ThrowingAsserts() : previous_(set_assertion_handler(throw_failed_assertion)) {}
  ~ThrowingAsserts() { set_assertion_handler(previous_); }
  ThrowingAsserts(const ThrowingAsserts&) = delete;
  ThrowingAsserts& operator=(const ThrowingAsserts&) = delete;

 private:
  AssertionHandler previous_;
};

}  // namespace spoonbill
