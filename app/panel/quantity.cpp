#include "app/panel/quantity.h"

#include <array>
#include <charconv>
#include <cstdio>
#include <span>
#include <string_view>

#include "app/report/quantity_text.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// How many SI units one of it is; the name is empty for a pure number.
struct QuantityUnit {
  std::string_view name;
  double size = 1.0;
};

constexpr std::array<QuantityUnit, 3> lengths = {{{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}}};
constexpr std::array<QuantityUnit, 4> moduli = {{{"Pa", 1.0}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}};
constexpr std::array<QuantityUnit, 4> densities = {
    {{"g/cm\u00b3", 1e3}, {"g/cm3", 1e3}, {"kg/m\u00b3", 1.0}, {"kg/m3", 1.0}}};
constexpr std::array<QuantityUnit, 1> pure_number = {{{"", 1.0}}};
constexpr std::array<QuantityUnit, 1> rates = {{{"/s", 1.0}}};
constexpr std::array<QuantityUnit, 2> factors = {{{"\u00d7", 1.0}, {"x", 1.0}}};

std::span<const QuantityUnit> units_of(FieldUnit unit) {
  switch (unit) {
    case FieldUnit::metre:
      return lengths;
    case FieldUnit::pascal:
      return moduli;
    case FieldUnit::kilogram_per_m3:
      return densities;
    case FieldUnit::per_second:
      return rates;
    case FieldUnit::times:
      return factors;
    default:
      return pure_number;
  }
}

std::string rounded(double number, int decimals, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f%s", decimals, number, unit);
  return text.data();
}

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

const QuantityUnit* find_unit(const FieldForm& form, std::string_view name) {
  for (const QuantityUnit& unit : units_of(form.unit)) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::string in_unit(double value, const QuantityUnit& unit) {
  return number_text(value / unit.size) + (unit.name.empty() ? "" : " ") + std::string(unit.name);
}

Error unknown_unit(const FieldForm& form, std::string_view name) {
  std::string known;
  for (const QuantityUnit& unit : units_of(form.unit)) {
    known += (known.empty() ? "" : ", ") + std::string(unit.name.empty() ? "none" : unit.name);
  }
  return Error{std::string(form.slider.label) + ": unit " + std::string(name) +
               " not known; known: " + known};
}

}  // namespace

std::string quantity_text(const FieldForm& form, double value) {
  switch (form.unit) {
    case FieldUnit::metre:
      return millimetres_text(value);
    case FieldUnit::pascal:
      return modulus_text(value);
    case FieldUnit::kilogram_per_m3:
      return density_text(value);
    case FieldUnit::per_second:
      return rounded(value, 1, " /s");
    case FieldUnit::times:
      return rounded(value, 2, " \u00d7");
    default:
      return rounded(value, 2, "");
  }
}

Result<double> read_quantity(const FieldForm& form, const std::string& typed, const std::string& shown) {
  const std::string field = form.slider.label;
  const Reading reading = read_number(typed);
  if (!reading.is_number) return Error{field + ": \"" + typed + "\" is no number"};
  const std::string_view name = reading.unit.empty() ? read_number(shown).unit : reading.unit;
  const QuantityUnit* unit = find_unit(form, name);
  if (unit == nullptr) return unknown_unit(form, name);
  const double value = reading.number * unit->size;
  if (!form.range.contains(value)) {
    return Error{field + " is " + in_unit(value, *unit) + ", must be " + in_unit(form.range.low, *unit) +
                 " to " + in_unit(form.range.high, *unit)};
  }
  return value;
}

}  // namespace spoonbill
