// The engine's errors are values: a Result holds either what was asked for or an Error whose message names
// the file or object, the field, and the remedy. Nothing in the engine throws for bad input.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "engine/base/assert.h"

namespace spoonbill {

// One line for the person at the program, without a trailing full stop or newline.
struct Error {
  std::string message;
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Error error) : content_(std::move(error)) {}

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }

  // Valid only when ok().
  T& value() & {
    SPOONBILL_ASSERT(ok());
    return *std::get_if<0>(&content_);
  }
  const T& value() const& {
    SPOONBILL_ASSERT(ok());
    return *std::get_if<0>(&content_);
  }
  T&& value() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  // Valid only when not ok().
  const Error& error() const {
    SPOONBILL_ASSERT(!ok());
    return *std::get_if<1>(&content_);
  }

 private:
  std::variant<T, Error> content_;
};

// Success, or the Error that prevented it.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : error_(std::move(error)) {}

  bool ok() const { return !error_; }
  explicit operator bool() const { return ok(); }
  // Valid only when not ok().
  const Error& error() const {
    SPOONBILL_ASSERT(!ok());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace spoonbill
