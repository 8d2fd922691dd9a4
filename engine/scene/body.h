// A body of a scene: surface, material, lattice, loads and supports. Plain data; lengths in metres.
#pragma once

#include <array>
#include <cstdint>
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
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/scene/body_motion.h"
#include "engine/scene/loads.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Parameters of the self-organising map that spreads a lattice's inner nodes (Kohonen 1990). Points of the
// body are drawn at random. For each point x, the node nearest to x moves towards x, and the nodes around the
// nearest node follow it. A node w that is d grid steps from the nearest node moves by the vector (x - w)
// times rate * exp(-d^2 / (2 s^2)). The rate and the width s of the neighbourhood shrink geometrically from
// their first to their last values. If s is below about one grid step, neighbours no longer follow, and the
// map can stay folded (Erwin et al. 1992).
struct FeatureMapSettings {
  int draws_per_node = 500;  // number of random points drawn for each inner node
  double first_rate = 0.1, last_rate = 0.01;
  double first_neighbourhood = 2.0, last_neighbourhood = 1.0;  // width s of the neighbourhood, in grid steps
  std::uint32_t seed = 1;
  friend bool operator==(const FeatureMapSettings&, const FeatureMapSettings&) = default;
};

inline constexpr Range<int> draws_per_node_range{1, 10000};
inline constexpr Range<int> map_seed_range{0, 1000000000};
inline constexpr Range<double> map_rate_range{1e-6, 1.0};
inline constexpr Range<double> map_neighbourhood_range{0.5, 64.0};

template <>
inline constexpr auto fields_of<FeatureMapSettings> = std::to_array<Field<FeatureMapSettings>>({
    whole_number_field("draws_per_node", &FeatureMapSettings::draws_per_node, draws_per_node_range),
    number_field("first_rate", &FeatureMapSettings::first_rate, map_rate_range),
    number_field("last_rate", &FeatureMapSettings::last_rate, map_rate_range),
    number_field("first_neighbourhood", &FeatureMapSettings::first_neighbourhood, map_neighbourhood_range),
    number_field("last_neighbourhood", &FeatureMapSettings::last_neighbourhood, map_neighbourhood_range),
    whole_number_field("seed", &FeatureMapSettings::seed, map_seed_range),
});

// How the cells of a solid's lattice are laid out. `bent`: a block of cells is bent into the body, so that
// its outer nodes lie on the surface; where no block can follow the shape, the cells are a box. `box`: equal
// cells about the body, along x, y and z (box_lattice.h). A tick of a soft body in a box takes fewer
// substeps, because no cell is flat; its surface is inside the cells, so thin parts are too stiff in bending.
enum class LatticeCells { bent, box };
inline constexpr const char* lattice_cells_names[] = {"bent", "box"};

// Size of a body's lattice: either the node counts, or a budget from which near-cubic cells are derived.
struct LatticeRequest {
  int node_budget = 2000;  // largest number of nodes; ignored if `counts` is given
  // Nodes in each direction, at least 2. The directions are:
  // - bent blocks: across (first, second) and along (third) the body;
  // - triangle meshes and bodies in a box of cells (box_lattice.h): x, y and z;
  // - open shells: along u, through the thickness, along v;
  // - closed shells: around, through and along the shell; the count around includes the node at the seam
  //   twice.
  std::optional<std::array<int, 3>> counts;
  // Settings of the map that spreads the inner nodes of a tube after transfinite interpolation has placed
  // them. If empty, the nodes stay where interpolation placed them.
  std::optional<FeatureMapSettings> feature_map = {};
  LatticeCells cells = LatticeCells::bent;  // a shell has cells of its own, and refuses a box
};

inline constexpr Range<int> node_budget_range{50, 80000};
inline constexpr Range<int> node_count_range{2, 64};  // number of nodes in each direction

// Kind of a body in a simulation. A deformable body has a lattice. Fixed and rigid bodies have none. A fixed
// body stays where it is, unless a command moves it (TurnBody and MoveBody in scene.h), and nothing that
// touches it can move it. A rigid body has a mass and moves freely, or a hand holds it by a spring
// (HandSpring).
enum class BodyKind { deformable, fixed, rigid };
inline constexpr const char* body_kind_names[] = {"deformable", "fixed", "rigid"};

// Spring by which a hand holds a rigid body where it is, or where a command moves the hand. It is critically
// damped, and more so in turns about axes of little inertia. The defaults are a choice for a loosely held
// spoon.
struct HandSpring {
  double stiffness_n_per_m = 300.0;
  double turn_stiffness_nm_per_rad = 1.0;
};
inline constexpr Range<double> hand_spring_range_n_per_m{0.1, 1e5};
inline constexpr Range<double> hand_turn_spring_range_nm_per_rad{1e-4, 1e3};

template <>
inline constexpr auto fields_of<HandSpring> = std::to_array<Field<HandSpring>>({
    number_field("stiffness_n_per_m", &HandSpring::stiffness_n_per_m, hand_spring_range_n_per_m).optional(),
    number_field("turn_stiffness_nm_per_rad", &HandSpring::turn_stiffness_nm_per_rad,
                 hand_turn_spring_range_nm_per_rad)
        .optional(),
});

// A solid bounded by one tube (periodic in u, closed by a pole at both ends of v) or one ring (periodic in u
// and v). With a shell thickness, the body is instead a thin shell behind one surface (shell_lattice.h). A
// fixed or rigid body may be bounded by a closed triangle mesh instead of a surface.
struct Body {
  std::string name;
  Surface surface;         // without control points if the body has a mesh
  Material material;       // material of the body outside its regions
  LatticeRequest lattice;  // ignored unless the body is deformable
  // Parts of the body with their own material or friction. Where parts overlap, the later part applies.
  std::vector<MaterialRegion> regions = {};
  std::vector<Load> loads = {};
  std::vector<Support> supports = {};
  std::optional<double> shell_thickness_m = {};
  // Trim loops around the part of the surface that is drawn and touched (trimmed_area.h).
  std::vector<TrimLoop> trims = {};
  // Corners of a closed line on the surface, as parameters (u, v): the rim of a body that bears food. The
  // line is straight in the parameters between one corner and the next. Empty if the body has no known rim.
  std::vector<Vector2> rim = {};
  // Name of the CAD solid that has this body as a face; empty if the body is not a face of a solid.
  std::string solid = {};
  BodyKind kind = BodyKind::deformable;
  std::optional<HandSpring> hand = {};  // of a rigid body that a hand holds; empty for any other body
  // Motion of a fixed body, or of the hand that holds a rigid one, in a trial after its turn (trial.h).
  std::optional<BodyMotion> motion = {};
  // The mesh that bounds the body (see check_mesh()); null for a body with a surface.
  std::shared_ptr<const CleanMesh> mesh = {};
  Pose mesh_pose = {};  // where the mesh is
};

// Largest number of triangles of a body's mesh. It is small, because a mesh that moves is moved and searched
// in every tick of one millisecond.
inline constexpr int body_triangle_limit = 20000;

// Number of control points of a surface in each direction, and of all surfaces of a document together.
inline constexpr Range<int> control_point_count_range{2, 4000};
inline constexpr int document_control_point_limit = 1'000'000;
// Number in each direction of a surface that a simulation moves in every tick.
inline constexpr Range<int> sculpted_control_point_count_range{2, 200};
inline constexpr Range<double> shell_thickness_range_m{1e-5, 0.1};
inline constexpr Range<int> rim_corner_count_range{3, 1000};

// Placement of a body in a document: the body is turned about an axis through the origin, then moved. Reading
// a document moves the body there (move_body()), and writing it states the moved surface without a placement.
struct BodyPlacement {
  Vector3 position_m = Vector3::Zero();
  Vector3 axis = Vector3::UnitX();  // unit vector; a positive angle is counter-clockwise seen against it
  double angle_deg = 0.0;

  Pose pose() const;
};
inline constexpr Range<double> placement_angle_range_deg{-360.0, 360.0};

template <>
inline constexpr auto fields_of<BodyPlacement> = std::to_array<Field<BodyPlacement>>({
    position_field("position_mm", &BodyPlacement::position_m).optional(),
    direction_field("axis", &BodyPlacement::axis).optional(),
    number_field("angle_deg", &BodyPlacement::angle_deg, placement_angle_range_deg).optional(),
});

// Returns an error that names the first field out of range, with its value and its range.
Status check_feature_map(const FeatureMapSettings& settings);
Status check_lattice_request(const LatticeRequest& lattice);
// Checks the numbers of loads and supports, and that point loads are within the surface's domain.
Status check_loads(const Body& body);
// Refuses a fixed or rigid body with regions, loads or supports, which would have no effect, a hand at a body
// that is not rigid, a motion of a body that is neither fixed nor held by a hand, and a mesh of a deformable
// body. Checks the motion.
Status check_kind(const Body& body);
// Refuses a mesh that is not one closed part, with or without cavities, that passes through itself, that has
// an edge of more than two triangles, or that has more than body_triangle_limit triangles.
Status check_mesh(const CleanMesh& mesh);
// Returns the triangles of a body with a mesh, where the mesh is.
TriangleMesh find_placed_mesh(const Body& body);
// Returns the box about the mesh, or about the control points of the surface.
Box find_bounds(const Body& body);

// Returns the area within the body's trim loops; null if the body has no trims.
Result<std::shared_ptr<const TrimmedArea>> make_trimmed_area(const Body& body);

}  // namespace spoonbill
