// The lumps that the window offers to begin with, by kind and sizes.
#pragma once

#include <span>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/shapes/stock_shapes.h"

namespace spoonbill {

struct LumpField {
  const char* name;
  double usual_mm;
};

struct LumpKind {
  const char* name;  // "Sphere"
  std::vector<LumpField> fields;
};

// Those that a lattice can fill.
std::span<const LumpKind> lump_kinds();

struct LumpChoice {
  std::size_t kind = 0;          // in lump_kinds()
  std::vector<double> sizes_mm;  // one a field
};

LumpChoice usual_choice(std::size_t kind);

// A document around the lump, of the material, with so few control points that a hand feels it move in a tick
// of a millisecond: within 0.1 mm of the exact shape. Refused with the size that is out of range.
Result<Document> lump_document(const LumpChoice& choice, const Material& material);

}  // namespace spoonbill
