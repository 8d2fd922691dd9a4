// The document that a new surface begins with.
#pragma once

#include <optional>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

// A body of the material around the surface, held so that it stays where it is pressed, a lattice that suits
// most shapes, a ball whose size follows from the body's, forces that a hand feels, and a view of the whole.
// Held is a tenth of it: at its foot, or of a flat one at its left end. `shell_thickness_m`: see Body.
Document starting_document(const std::string& name, Surface surface, const Material& material,
                           std::optional<double> shell_thickness_m = {});

}  // namespace spoonbill
