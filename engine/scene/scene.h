// A scene: what a simulation is built from. Plain data; lengths in metres.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/scene/fixing_plane.h"
#include "engine/scene/lattice_request.h"
#include "engine/scene/loads.h"
#include "engine/scene/material.h"
#include "engine/scene/material_region.h"
#include "engine/scene/tool.h"

namespace spoonbill {

// A solid body bounded by one tube, periodic in u and closed by a pole at both ends of v, or by one ring,
// periodic in both. Or, with a thickness, a thin shell behind one (see shell_lattice.h).
struct Body {
  std::string name;
  Surface surface;
  Material material;  // of what no region says otherwise
  LatticeRequest lattice;
  std::vector<MaterialRegion> regions = {};  // later ones win over earlier ones
  std::vector<Load> loads = {};
  std::vector<Support> supports = {};
  std::optional<double> shell_thickness_m = {};
  std::vector<TrimLoop> trims = {};  // keep a part of the surface: what is drawn and touched (trimmed_area.h)
  // The name of the solid of a CAD model that it is a face of; empty where it is none.
  std::string solid = {};
};

// How sculpting differs from the real thing: no gravity by default, damped, with a capped stiffness.
struct Sculpting {
  double damping_per_s = 4.0;  // mass-proportional
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  double force_scale = 1.0;  // newtons at the hand for each newton of contact
  // Damped besides as each body needs it to come to rest without swinging: see settling.h.
  bool settles = false;
};

// Sculpting both sides at once: what the hand does on one side of the plane, a second tool does mirrored.
struct Symmetry {
  bool on = false;
  Vector3 point_m = Vector3::Zero();  // any of the plane
  Vector3 normal = Vector3::UnitZ();  // unit
};

struct Scene {
  std::vector<Body> bodies;         // those that touch push each other; of a document more than are simulated
  std::vector<FixingPlane> planes;  // each holds nodes of any body
  Tool tool;
  Sculpting sculpting;
  Symmetry symmetry = {};
  std::optional<Ground> ground = {};
};

// What files, commands and the panel's sliders accept: wide enough for any concept, finite for every solver.
inline constexpr Range<int> control_point_count_range{2, 200};  // in each direction
inline constexpr Range<double> shell_thickness_range_m{1e-5, 0.1};
inline constexpr Range<int> body_count_range{1, 1000};        // of a document
inline constexpr Range<int> sculpted_body_count_range{1, 8};  // that are simulated together
inline constexpr Range<int> fixing_plane_count_range{0, 64};
inline constexpr Range<double> sculpting_damping_range_per_s{0.0, 1000.0};
inline constexpr double gravity_limit_m_per_s2 = 100.0;  // of the vector's length
inline constexpr Range<double> force_scale_range{0.0, 1e6};

template <>
inline constexpr auto fields_of<Sculpting> = std::to_array<Field<Sculpting>>({
    number_field("damping_per_s", &Sculpting::damping_per_s, sculpting_damping_range_per_s,
                 FieldUnit::per_second)
        .with_slider({"Damping", {0.0, 100.0}, false}),
    vector_field("gravity_m_per_s2", &Sculpting::gravity_m_per_s2, gravity_limit_m_per_s2,
                 FieldUnit::metre_per_s2),
    number_field("force_scale", &Sculpting::force_scale, force_scale_range, FieldUnit::times)
        .with_slider({"Force scale", {0.01, 100.0}, true}),
    switch_field("settles", &Sculpting::settles).optional(),
});

template <>
inline constexpr auto fields_of<Symmetry> = std::to_array<Field<Symmetry>>({
    switch_field("on", &Symmetry::on),
    position_field("point_mm", &Symmetry::point_m),
    direction_field("normal", &Symmetry::normal),
});

// What its trims keep of its surface; null without trims.
Result<std::shared_ptr<const TrimmedArea>> trim_of(const Body& body);

// Whether so many bodies are simulated together; says how to choose some.
Status check_body_count(const Scene& scene);

// Each names the field, the value and the range of the first thing that is not within it.
Status check_loads(const Body& body);  // and supports
Status check_sculpting(const Sculpting& sculpting);
Status check_symmetry(const Symmetry& symmetry);
// What goes with what: a soft tool pushes, on one side.
Status check_together(const Tool& tool, const Symmetry& symmetry);

}  // namespace spoonbill
