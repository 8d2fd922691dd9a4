// Contact between two bodies of a simulation, and of a body with itself, as constraints between lattices. A
// thin shell has two faces: its surface, and the far face one thickness behind it. Each face is touched from
// its own side.
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/proximity/mesh_pair_proximity.h"
#include "engine/collision/proximity/mesh_proximity.h"
#include "engine/collision/proximity/self_proximity.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/surface_contact.h"
#include "engine/material/contact/body_contacts.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/normal_cones.h"

namespace spoonbill {

// Returns by how much the gap of a shell's surface exceeds the gap of the face that a contact touches, in
// metres. The result is 0 if the contact touches the surface itself, and the thickness if the contact pushes
// the far face straight towards the surface. `push` is the unit vector along which the contact pushes the
// shell, `normal` the surface's unit normal. Exact for flat shells.
double far_face_offset_m(double thickness_m, const Vector3& normal, const Vector3& push);

// Finds the gap from a point to the near face of a shell, and the outward normal of that face. (u, v) is the
// nearest point of the shell's surface. A point deeper below the surface than half the thickness belongs to
// the far face. Returns false if the gap exceeds the margin, or if the point is beside the rim of the shell
// and touches neither face.
bool find_shell_gap(const Surface& shell, double thickness_m, double u, double v, const Vector3& point_m,
                    double margin_m, Vector3& normal, double& gap_m);

// Surface of a shell, or of a solid if `thickness_m` is 0.
struct ShellOrSolid {
  const Surface* surface;
  double thickness_m;
};
// Corrects the gap and the normal of `near` for the thickness of both bodies. The point belongs to the first
// body and is near the second. Returns false if the gap exceeds the margin, or if the point is beside the rim
// of a shell and touches neither face. Allocates nothing.
bool resolve_shell_gap(const ShellOrSolid& of, const ShellOrSolid& other, double margin_m, NearPoint& near);

// Largest penetration of two bodies pressed together at up to 60 mm/s, or of a body pressed onto itself, in
// lattice cells of the coarser body. Control nets follow a dent one cell wide only in part, and contacts act
// between points that the lattices move. At rest, the drawn surfaces overlap by up to 0.02 cells of each body
// for this reason, and by another 0.02 between samples. During an impact, they overlap by another 0.01.
inline constexpr double body_depth_limit_cells = 0.07;

// Gap below which a constraint is added for a point, in lattice cells of the coarser body that is deformable.
// The margin is at least twice the approach of the bodies in a step of find().
inline constexpr double contact_margin_cells = 0.08;

// A tick is divided where bodies near each other approach each other in it by more than this distance, in
// cells like those of BodyPairContact::find(), and into at most so many parts.
inline constexpr double approach_limit_cells = 0.15;
inline constexpr int tick_parts_limit = 16;

// State of a body, and its index in the simulation.
struct IndexedBody {
  int index;
  const BodyState* state;
};

// Returns whether the samples of a body bear rigid ones alone where these are blunt (find_blunt_samples()):
// those of a soft body that are at most a cell apart.
bool bears_blunt_bodies(const BodyState& body);

// Returns a near point of a body's surface as a weighted sum of the nodes of the body's lattice.
EmbeddedPoint find_embedding(const BodyMapping& mapping, const NearPoint& near);

// Adds a constraint for each of `points`, which are points of the body `from` near the body `to`. Both may be
// the same body. `deepest_new_m` is that of BodyContacts::add(). `cones` are those of a rigid body `from`
// near another rigid body; the default for any other. Returns false if a capacity was exceeded.
bool add_near_points(const IndexedBody& from, const IndexedBody& to, const std::vector<NearPoint>& points,
                     double deepest_new_m, BodyContacts& contacts, const NormalCones& cones = {});

// Contact of two bodies. Owned by the simulation, which rebuilds it when the mapping of either body is
// replaced. find() and add_contacts() allocate nothing.
class BodyPairContact {
 public:
  BodyPairContact(const BodyState& first, const BodyState& second);

  // Returns the number of parts into which the coming tick must be divided so that bodies that the last
  // find() found near each other approach each other by at most approach_limit_cells in each: a power of two,
  // so that it changes rarely, and at most tick_parts_limit. Contacts are planes that stay as they are in a
  // part, while the bodies turn and slide.
  int choose_tick_parts(const BodyState& first, const BodyState& second) const;
  // Finds the points on the skin of each body that can be near the skin of the other in a step of
  // `time_s`, a tick or a part of it. Returns false if a capacity was exceeded.
  bool find(const IndexedBody& first, const IndexedBody& second, double time_s);
  // Forgets what earlier calls of find() have found. Must be called before the bodies jump.
  void forget();
  // Smallest gap that the last find() found, negative where the bodies overlap; infinite if they are not
  // near.
  double least_gap_m() const {
    return std::visit([](const auto& proximity) { return proximity->least_gap_m(); }, proximity_);
  }
  // deepest_on_first() and deepest_on_second() return the point of a body's surface that is deepest in the
  // other body or nearest to it, as found by the last find(). Empty if nothing is near, or if the body is a
  // mesh.
  std::optional<SurfaceSpot> deepest_on_first(const BodyState& first) const;
  std::optional<SurfaceSpot> deepest_on_second(const BodyState& second) const;
  // Adds a constraint for each point of the last find(). Returns false if a capacity was exceeded.
  bool add_contacts(const IndexedBody& first, const IndexedBody& second, BodyContacts& contacts) const;

 private:
  // On the heap, because a proximity search cannot be moved.
  std::variant<std::unique_ptr<SurfaceProximity>, std::unique_ptr<MeshProximity>,
               std::unique_ptr<MeshPairProximity>>
      proximity_;
  bool is_mesh_first_ = false;  // whether the first body has a mesh and the second a surface
  NormalCones first_cones_, second_cones_;
  double cell_m_ = 0.0, tick_motion_m_ = 0.0;  // at the last find(): size of cells, approach in a tick
};

// Contact of a body with itself, where one part of its surface comes near another part from outside. A
// slender body in a box of cells (LatticeMesh::slender) has no self-contact: it is thinner than two cells
// somewhere, and its far side would be mistaken for a part that has been pressed through the near side. Owned
// by the simulation, which rebuilds it when the body's mapping is replaced.
class BodySelfContact {
 public:
  explicit BodySelfContact(const BodyState& body);

  // Takes over what the contact of the body knew before knots were inserted, which changed the body's mapping
  // from `coarser` to `finer` and no shape. Allocates nothing.
  void carry_over(const BodySelfContact& before, const BodyMapping& coarser, const BodyMapping& finer);

  // Adds a constraint for each point near another part of the body. Returns false if a capacity was exceeded.
  // Allocates nothing.
  bool add_contacts(const IndexedBody& body, BodyContacts& contacts) const;

 private:
  // On the heap, because a SelfProximity cannot be moved. Null for a mesh or a slender body in a box of
  // cells.
  std::unique_ptr<SelfProximity> proximity_;
};

}  // namespace spoonbill
