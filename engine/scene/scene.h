// A scene, from which a simulation is built, and the commands that change the simulation. Plain data; lengths
// in metres.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body.h"
#include "engine/scene/loads.h"
#include "engine/scene/material.h"
#include "engine/scene/tool.h"

namespace spoonbill {

// Settings by which sculpting deviates from real behaviour: drag, slower responses, no gravity by default,
// and scaled forces.
struct Sculpting {
  double drag_per_s = 24.0;  // damping of all motion, proportional to mass; does not change static forces
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  double force_scale = 1.0;  // force at the hand per newton of contact force
  // If true, each body is also damped critically, so that it comes to rest without ringing
  // (critical_damping_per_s()).
  bool is_critically_damped = false;
  // If true, a body that nothing fixes may move away. If false, such a body keeps its mean position and
  // orientation, provided that there is neither gravity nor ground (keeps_place()).
  bool free = false;
  // If true, every body has its true inertia, and a tick takes as many substeps as stability then requires.
  // If false, inertia is scaled up until the tool's number of substeps suffices
  // (SpringLattice::set_inertia()).
  bool real_time = false;
  // Number by which each substep of springs and contacts is divided if `real_time` is true. Results that
  // depend on it are not to be trusted. Bodies that are stepped implicitly still take one step a tick.
  int step_division = 1;
};

// Symmetric sculpting: a second tool is the mirror image of the hand's tool in a plane.
struct Symmetry {
  bool on = false;
  Vector3 point_m = Vector3::Zero();  // any point of the mirror plane
  Vector3 normal = Vector3::UnitZ();  // unit normal of the mirror plane
};

// Returns the mirror image of a point or a pose in the plane of symmetry.
Vector3 mirror_point(const Symmetry& symmetry, const Vector3& point_m);
Pose mirror_pose(const Symmetry& symmetry, const Pose& pose);

// How a trial of the scene runs (engine/trial): a body such as food is lowered until others bear it
// (LowerBody), comes to rest, and then a body such as a spoon is turned. At last, bodies move as they state
// (Body::motion).
struct TrialPlan {
  std::string lowered_body;              // name of the body that is lowered first; empty: none
  double lowering_speed_m_per_s = 0.01;  // along gravity
  std::string turned_body;               // name of the fixed or held body that turns; empty: none
  Vector3 point_m = Vector3::Zero();     // point of the axis of the turn
  Vector3 axis = Vector3::UnitX();       // unit vector; a positive angle is counter-clockwise seen against it
  double angle_deg = 0.0;
  double turn_speed_deg_per_s = 30.0;
};

struct Scene {
  // Bodies push each other where they touch. A document may have more bodies than can be simulated.
  std::vector<Body> bodies;
  std::vector<FixingPlane> planes;  // each plane fixes nodes of all bodies
  Tool tool;
  Sculpting sculpting;
  Symmetry symmetry = {};
  std::optional<Ground> ground = {};
  std::optional<TrialPlan> trial = {};
};

// Returns true if bodies that no plane or support fixes keep their mean position and orientation.
inline bool keeps_place(const Sculpting& sculpting, bool has_ground) {
  return !sculpting.free && !has_ground && sculpting.gravity_m_per_s2.isZero(0.0);
}
inline bool keeps_place(const Scene& scene) {
  return keeps_place(scene.sculpting, scene.ground.has_value());
}

// Limits that files, commands and the panel enforce. Within these limits every solver stays finite.
inline constexpr Range<int> body_count_range{1, 1000};  // number of bodies in a document
// Number of bodies that can be simulated together.
inline constexpr Range<int> sculpted_body_count_range{1, 8};
inline constexpr Range<double> drag_range_per_s{0.0, 8000.0};
inline constexpr double gravity_limit_m_per_s2 = 100.0;  // largest length of the gravity vector
inline constexpr Range<double> force_scale_range{0.0, 1e6};
inline constexpr Range<int> step_division_range{1, 8};
inline constexpr Range<double> lowering_speed_range_m_per_s{1e-4, 1.0};
inline constexpr Range<double> turn_angle_range_deg{-360.0, 360.0};
inline constexpr Range<double> turn_speed_range_deg_per_s{0.1, 360.0};

template <>
inline constexpr auto fields_of<Sculpting> = std::to_array<Field<Sculpting>>({
    number_field("drag_per_s", &Sculpting::drag_per_s, drag_range_per_s, FieldUnit::per_second)
        .with_slider({"Drag", {0.0, 600.0}, false}),
    vector_field("gravity_m_per_s2", &Sculpting::gravity_m_per_s2, gravity_limit_m_per_s2,
                 FieldUnit::metre_per_s2),
    number_field("force_scale", &Sculpting::force_scale, force_scale_range, FieldUnit::times)
        .with_slider({"Force scale", {0.01, 100.0}, true}),
    switch_field("settles", &Sculpting::is_critically_damped).optional(),
    switch_field("free", &Sculpting::free).optional(),
    switch_field("real_time", &Sculpting::real_time).optional(),
    whole_number_field("step_division", &Sculpting::step_division, step_division_range).optional(),
});

template <>
inline constexpr auto fields_of<Symmetry> = std::to_array<Field<Symmetry>>({
    switch_field("on", &Symmetry::on),
    position_field("point_mm", &Symmetry::point_m),
    direction_field("normal", &Symmetry::normal),
});

template <>
inline constexpr auto fields_of<TrialPlan> = std::to_array<Field<TrialPlan>>({
    text_field("lowered_body", &TrialPlan::lowered_body).optional(),
    number_field("lowering_speed_m_per_s", &TrialPlan::lowering_speed_m_per_s, lowering_speed_range_m_per_s)
        .optional(),
    text_field("turned_body", &TrialPlan::turned_body).optional(),
    position_field("point_mm", &TrialPlan::point_m).optional(),
    direction_field("axis", &TrialPlan::axis).optional(),
    number_field("angle_deg", &TrialPlan::angle_deg, turn_angle_range_deg).optional(),
    number_field("turn_speed_deg_per_s", &TrialPlan::turn_speed_deg_per_s, turn_speed_range_deg_per_s)
        .optional(),
});

// Refuses a scene without bodies, and more bodies than can be simulated together. The error for too many
// bodies explains how to select some.
Status check_body_count(const Scene& scene);

// Returns an error that names the first field out of range, with its value and its range.
Status check_sculpting(const Sculpting& sculpting);
Status check_symmetry(const Symmetry& symmetry);
// Checks the numbers of a trial, that its bodies are in the scene, that the turned body is fixed or held by a
// hand, and that the lowered body is neither.
Status check_trial(const Scene& scene);
// Removes the trial if check_trial() fails, for example because a body was removed or renamed. Returns a note
// about it; empty if the trial stays.
std::string drop_unfit_trial(Scene& scene);
// Refuses a soft tool if its action is not push or if symmetry is on.
Status check_tool_and_symmetry(const Tool& tool, const Symmetry& symmetry);

// The commands that the panel, a script or a recording sends to a simulation between two ticks.

// Adds a fixing plane. Knots are inserted where the plane cuts a surface, so that the fixed part keeps its
// exact shape.
struct PlacePlane {
  FixingPlane plane;
};
struct RemovePlanes {};
struct SetTool {
  Tool tool;
};
// Sets the material of a body. Regions with a material of their own keep it.
struct SetMaterial {
  Material material;
  int body = 0;  // index in the scene
};
struct SetSculpting {
  Sculpting sculpting;
};
struct SetSymmetry {
  Symmetry symmetry;
};
// Moves the tool to the hand, ignoring contact on the path between them. This command is sent when the tool
// starts to follow the hand after a pause.
struct ResetProxy {};
// Makes the tool pass through the body until it has left the body.
struct LiftTool {};
// Makes the current shape the rest shape.
struct KeepShape {};
// Inserts knots in a body's surface where it is behind its lattice. The shape does not change at that tick;
// the surface then catches up with the lattice. Without ranges, a knot along u and a knot along v are
// inserted at the point that is farthest behind. With ranges of the parameters, the elements that overlap
// them are halved.
struct RefineKnots {
  int body = 0;  // index in the scene
  std::optional<Range<double>> u = {}, v = {};
};

// Turns a fixed body, or the hand that holds a rigid one, about an axis. It starts and stops within
// turn_ramp_s each, at constant angular acceleration. A turn that has not ended is replaced.
struct TurnBody {
  int body = 0;  // index in the scene
  Vector3 point_m = Vector3::Zero();
  Vector3 axis = Vector3::UnitX();  // unit vector; a positive angle is counter-clockwise seen against it
  double angle_deg = 0.0;
  double speed_deg_per_s = 30.0;
};
// Moves a fixed body, or the hand that holds a rigid one, through waypoints. A motion that has not ended is
// replaced.
struct MoveBody {
  int body = 0;  // index in the scene
  BodyMotion motion = {};
};
// Lowers a free body level, along gravity, until contacts bear its weight, and then lets it go. A rigid body
// is let go when contacts first push it up.
struct LowerBody {
  int body = 0;  // index in the scene
  double speed_m_per_s = 0.01;
};

// Time in which a turn reaches its speed, s.
inline constexpr double turn_ramp_s = 0.1;
// turn_duration_s() returns the duration of a turn. turned_angle_deg() returns the angle of a turn `time_s`
// after its start.
double turn_duration_s(const TurnBody& turn);
double turned_angle_deg(const TurnBody& turn, double time_s);

using Command = std::variant<PlacePlane, RemovePlanes, SetTool, SetMaterial, SetSculpting, SetSymmetry,
                             ResetProxy, LiftTool, KeepShape, RefineKnots, TurnBody, LowerBody, MoveBody>;

// Names of the commands in scripts and recordings.
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
template <>
inline constexpr const char* kind_name<TurnBody> = "turn_body";
template <>
inline constexpr const char* kind_name<LowerBody> = "lower_body";
template <>
inline constexpr const char* kind_name<MoveBody> = "move_body";

template <>
inline constexpr auto fields_of<TurnBody> = std::to_array<Field<TurnBody>>({
    position_field("point_mm", &TurnBody::point_m),
    direction_field("axis", &TurnBody::axis),
    number_field("angle_deg", &TurnBody::angle_deg, turn_angle_range_deg),
    number_field("speed_deg_per_s", &TurnBody::speed_deg_per_s, turn_speed_range_deg_per_s),
});
template <>
inline constexpr auto fields_of<LowerBody> = std::to_array<Field<LowerBody>>({
    number_field("speed_m_per_s", &LowerBody::speed_m_per_s, lowering_speed_range_m_per_s),
});

}  // namespace spoonbill
