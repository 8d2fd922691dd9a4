// Commands: what the panel, a script or a recording asks of a simulation between two ticks.
#pragma once

#include <variant>

#include "engine/scene/scene.h"

namespace spoonbill {

// Adds a fixing plane. Knots are inserted where it cuts the surface, so that the fixed part of the surface
// stays.
struct PlacePlane {
  FixingPlane plane;
};
struct RemovePlanes {};
struct SetTool {
  Tool tool;
};
// Of what no region of the body says otherwise.
struct SetMaterial {
  Material material;
  int body = 0;  // in the scene
};
struct SetSculpting {
  Sculpting sculpting;
};
struct SetSymmetry {
  Symmetry symmetry;
};
// Puts the tool where the hand is, without sweeping the way between: after the hand was not followed for a
// while.
struct ResetProxy {};
// The tool acts on nothing until it has left the body.
struct LiftTool {};
// Makes the current shape the rest shape.
struct KeepShape {};
// Gives the body's surface another knot in each direction where it follows its lattice worst: the same shape,
// and room for the next strokes.
struct RefineKnots {
  int body = 0;  // in the scene
};

using Command = std::variant<PlacePlane, RemovePlanes, SetTool, SetMaterial, SetSculpting, SetSymmetry,
                             ResetProxy, LiftTool, KeepShape, RefineKnots>;

}  // namespace spoonbill
