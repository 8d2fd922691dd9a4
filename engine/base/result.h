// Errors as values: a Result is either a value or an Error whose message names the file or object, the field
// and the remedy. Nothing in the engine throws for bad input.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/base/assert.h"

namespace spoonbill {

// Kind of an error. Callers and tests may depend on the kind; the message is for people.
enum class ErrorCode {
  missing,            // a required file, field, option or part is absent
  unknown,            // a name, field, kind or option that does not exist
  duplicate,          // a name or field given twice
  wrong_type,         // a field of the wrong type, such as text where a number belongs
  malformed,          // text or bytes that cannot be parsed
  out_of_range,       // a value outside its range, or not finite
  inconsistent,       // values that contradict each other
  too_many,           // more items, bytes or memory than the limit
  too_few,            // fewer items than the method needs
  degenerate,         // geometry without length, area, volume or direction
  self_intersecting,  // a result that would fold over or pass through itself
  mismatch,           // parts that do not meet, edges or bodies that do not fit together
  not_converged,      // an iteration or fit that misses its tolerance
  unsupported,        // valid input of a kind that the program does not handle
  unreadable,         // a file or device that cannot be opened or read
  unwritable,         // a file or device that cannot be written
  in_use,             // a file or device that another program is using
  cancelled,          // stopped by the user
  unavailable,        // a library, driver, display or permission that this machine lacks
  process_failed,     // a child process that crashed, hung or exceeded its limits
  internal            // a fault of the program itself
};

struct Error {
  // `field_name` is the JSON field, option or parameter at fault, such as "radius_mm"; empty if no single
  // field is at fault.
  Error(ErrorCode error_code, std::string error_message, std::string field_name = {})
      : code(error_code), message(std::move(error_message)), field(std::move(field_name)) {}

  // Returns the same error with "context: " before its message.
  Error in(std::string_view context) const { return {code, std::string(context) + ": " + message, field}; }

  ErrorCode code = ErrorCode::internal;
  std::string message;  // one line, without a trailing full stop or newline
  std::string field;
};

// A value, or the error that prevented it.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Error error) : content_(std::move(error)) {}

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }

  // Returns the value; requires ok().
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

  // Returns the error; requires !ok().
  const Error& error() const {
    SPOONBILL_ASSERT(!ok());
    return *std::get_if<1>(&content_);
  }

 private:
  std::variant<T, Error> content_;
};

// Success, or the error that prevented it.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : error_(std::move(error)) {}

  bool ok() const { return !error_; }
  explicit operator bool() const { return ok(); }
  // Returns the error; requires !ok().
  const Error& error() const {
    SPOONBILL_ASSERT(!ok());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace spoonbill
