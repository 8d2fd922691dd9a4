// The code and the field of an error. Tests compare these two, because the text of a message may change.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "engine/base/result.h"

namespace spoonbill {

struct Refusal {
  Refusal() = default;  // represents no error
  explicit Refusal(ErrorCode error_code, std::string field_name = {})
      : code(error_code), field(std::move(field_name)) {}
  explicit Refusal(const Error& error) : code(error.code), field(error.field), message(error.message) {}
  explicit Refusal(const Status& status) : Refusal(status.ok() ? Refusal() : Refusal(status.error())) {}
  template <class T>
  explicit Refusal(const Result<T>& result) : Refusal(result.ok() ? Refusal() : Refusal(result.error())) {}

  friend bool operator==(const Refusal& a, const Refusal& b) {
    return a.code == b.code && a.field == b.field;
  }
  friend std::ostream& operator<<(std::ostream& out, const Refusal& refusal) {
    if (!refusal.code) return out << "accepted";
    return out << "code " << static_cast<int>(*refusal.code) << ", field \"" << refusal.field
               << "\": " << refusal.message;
  }

  std::optional<ErrorCode> code;  // code of the error; nullopt without an error
  std::string field;
  std::string message;  // text of the error, which is not compared
};

}  // namespace spoonbill
