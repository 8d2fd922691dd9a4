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

// As scripts and recordings call them.
template <>
inline constexpr const char* kind_name<PlacePlane> = "place_plane";
template <>
inline constexpr const char* kind_name<RemovePlanes> = "remove_planes";
template <>
inline constexpr const char* kind_name<SetTool> = "set_tool";
template <>
inline constexpr const char* kind_name<SetMaterial> = "set_material";
template <>
inline constexpr const char* kind_name<SetSculpting> = "set_sculpting";
template <>
inline constexpr const char* kind_name<SetSymmetry> = "set_symmetry";
template <>
inline constexpr const char* kind_name<ResetProxy> = "reset_proxy";
template <>
inline constexpr const char* kind_name<LiftTool> = "lift_tool";
template <>
inline constexpr const char* kind_name<KeepShape> = "keep_shape";
template <>
inline constexpr const char* kind_name<RefineKnots> = "refine_knots";

}  // namespace spoonbill
