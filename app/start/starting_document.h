// The document that a new surface begins with.
#pragma once

#include <optional>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

// A body of the material around the surface, a lattice that suits most shapes, a ball to press it with whose
// size follows from the body's, forces that a hand feels, and a view of the whole. `shell_thickness_m`: see
// Body.
Document starting_document(const std::string& name, Surface surface, const Material& material,
                           std::optional<double> shell_thickness_m = {});

}  // namespace spoonbill
