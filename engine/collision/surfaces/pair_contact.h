// Where two surfaces, or two parts of one, cross or touch.
#pragma once

#include "engine/collision/levels/parameter_range.h"
#include "engine/collision/solids/surface_contact.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// One region in which the surfaces cross or touch.
struct PairContact {
  SurfacePair pair;              // the deepest points, one on each surface
  Vector3 normal;                // unit, along which the first surface leaves the second
  double depth_m = 0.0;          // how far; 0 where they only touch
  ParameterRange first, second;  // all of the region is within
  Vector3 tangent_u, tangent_v;  // tangents_across() the normal, by the first surface
};

inline void take_tangents(const PiecewiseSurface& first, PairContact& contact) {
  const PairParameters& at = contact.pair.at;
  const Tangents tangents = tangents_across(contact.normal, evaluate(first, at.u, at.v));
  contact.tangent_u = tangents.u;
  contact.tangent_v = tangents.v;
}

}  // namespace spoonbill
