// Quantities as the panel and reports show them: three digits or so, in the unit that a designer uses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

std::string modulus_text(double pascals);           // "1.20 MPa"
std::string millimetres_text(double metres);        // "8.0 mm"
std::string size_text(const Vector3& size_m);       // "100.0 x 12.0 x 5.0 mm"
std::string area_text(double square_metres);        // "7.54 cm²"
std::string volume_text(double cubic_metres);       // "48.0 cm³"
std::string grams_text(double kilograms);           // "34.2 g"
std::string density_text(double kilograms_per_m3);  // "1.80 g/cm³"
std::string newtons_text(double newtons);           // "1.23 N"
std::string percent_text(double share);             // "12 %", "0.081 %"
// "1 place", "3 places"
std::string count_text(std::size_t count, const char* one, const char* many);
// "at most 0.0123 mm"; "none" of what rounding alone leaves, a picometre or less.
std::string deviation_text(double deviation_m);

// What each set TickFlag means and what to do about it.
std::vector<std::string> flag_texts(std::uint32_t flags);

}  // namespace spoonbill
