// Texts for the panel and for reports. Quantities have about three digits and the units that a designer uses.
// Other texts describe closedness, material regions and the flags of a tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

struct BodyRegion;
struct Closing;
enum class Closedness;
struct MaterialRegion;

std::string decimals_text(double value, int decimals);  // "1.230" with 3 decimals
std::string modulus_text(double pascals);               // "1.20 MPa"
std::string millimetres_text(double metres);            // "8.0 mm"
std::string size_text(const Vector3& size_m);           // "100.0 x 12.0 x 5.0 mm"
std::string area_text(double square_metres);            // "7.54 cm²"
std::string volume_text(double cubic_metres);           // "48.0 cm³"
std::string grams_text(double kilograms);               // "34.2 g"
std::string density_text(double kilograms_per_m3);      // "1.80 g/cm³"
std::string newtons_text(double newtons);               // "1.23 N"
std::string percent_text(double fraction);              // "12 %", "0.081 %"
// Returns a text that says how much slower a body with this inertia scale responds than the real body: "real
// time", "1.4 times slower", "31 times slower".
std::string slowness_text(double inertia_scale);
// Returns the count with its noun, such as "1 body" or "3 bodies".
std::string count_text(std::size_t count, const char* one, const char* many);
// Returns "at most 0.0123 mm", or "none" for a deviation of up to a picometre, which is rounding error.
std::string deviation_text(double deviation_m);

// Returns a text for each TickFlag that is set, with its meaning and a remedy.
std::vector<std::string> flag_texts(std::uint32_t flags);

const char* name_of(Closedness closedness);        // "solid", "tube", "sheet"
std::string closing_text(const Closing& closing);  // "a tube, open by 12.0 mm at an end"

// Returns the material and friction of a region: "silicone-soft, friction 0.9", or "friction 0.9" without a
// material.
std::string region_material_text(const MaterialRegion& region);
// Returns the extent of a region: "50 to 100 % along, 0 to 2.0 mm deep". Directions that the region spans
// completely are omitted.
std::string region_extent_text(const BodyRegion& region);

}  // namespace spoonbill
