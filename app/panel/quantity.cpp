#include "app/panel/quantity.h"

#include <charconv>

#include "engine/base/number_text.h"

namespace spoonbill {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// A number and what follows it.
struct Reading {
  double number = 0.0;
  std::string_view unit;
  bool is_number = false;
};

Reading read_number(std::string_view text) {
  text = trimmed(text);
  Reading reading;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), reading.number);
  reading.is_number = error == std::errc{};
  reading.unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  return reading;
}

const QuantityUnit* find_unit(const Quantity& quantity, std::string_view name) {
  for (const QuantityUnit& unit : quantity.units) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::string in_unit(double value, const QuantityUnit& unit) {
  return number_text(value / unit.size) + (unit.name.empty() ? "" : " ") + std::string(unit.name);
}

Error unknown_unit(const Quantity& quantity, std::string_view name) {
  std::string known;
  for (const QuantityUnit& unit : quantity.units) {
    known += (known.empty() ? "" : ", ") + std::string(unit.name.empty() ? "none" : unit.name);
  }
  return Error{std::string(quantity.label) + ": unit " + std::string(name) + " not known; known: " + known};
}

}  // namespace

Result<double> read_quantity(const Quantity& quantity, const std::string& typed, const std::string& shown) {
  const std::string field = quantity.label;
  const Reading reading = read_number(typed);
  if (!reading.is_number) return Error{field + ": \"" + typed + "\" is no number"};
  const std::string_view name = reading.unit.empty() ? read_number(shown).unit : reading.unit;
  const QuantityUnit* unit = find_unit(quantity, name);
  if (unit == nullptr) return unknown_unit(quantity, name);
  const double value = reading.number * unit->size;
  if (!quantity.allowed.contains(value)) {
    return Error{field + " is " + in_unit(value, *unit) + ", must be " +
                 in_unit(quantity.allowed.low, *unit) + " to " + in_unit(quantity.allowed.high, *unit)};
  }
  return value;
}

}  // namespace spoonbill
