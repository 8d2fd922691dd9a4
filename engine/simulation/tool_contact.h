// The tool as the simulation uses it: its model, which is made outside the tick, and its contact with the
// bodies in a tick.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/signed_distance.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// Longest edge of a soft mesh, in lattice cells. Longer edges would not follow a dent and are halved.
inline constexpr double soft_edge_cells = 0.5;

// Makes the body of a soft tool from triangles, with no node fixed. Refuses a mesh that passes through itself
// or has an edge of more than two triangles. Also refuses a mesh that has more than soft_mesh_triangle_limit
// triangles once its edges are short enough. The error names the field.
Result<BodyState> make_soft_mesh(const MeshSolid& solid, const SoftTool& soft, InstructionSet set);

// Body of a tool prepared for contact; empty for a point or a sphere. Made outside the tick, owned by a
// simulation.
struct ToolModel {
  std::shared_ptr<const SignedDistance> distance;  // only for rigid implicit or tessellated tools
  std::shared_ptr<const Surface> surface;          // only for rigid B-spline tools, in the tool's frame
  std::shared_ptr<const NestedGrid> nested;        // grid of the samples of `surface`
  // Upper bound of the distance of the tool's points from the origin of its frame. It is limited to 0.1 m for
  // implicit and tessellated tools.
  double extent_m = 0.0;
  std::optional<BodyState> soft;  // only for soft tools, with the rest shape in the tool's frame
  std::vector<int> gripped;       // nodes of `soft` that are fixed to the hand
  // Only for soft meshes; shared with snapshots.
  std::shared_ptr<const std::vector<TriangleCorners>> triangles;
};

// Returns the body from which a tool's model is made; null for a point or a sphere.
inline std::shared_ptr<const ToolBody> find_model_body(const Tool& tool) {
  return tool.kind == ToolKind::solid ? tool.body : nullptr;
}

// Makes the model of a tool. Refuses a body that cannot be simulated; the error names the field.
Result<ToolModel> make_tool_model(const Tool& tool, InstructionSet set);

// Pose of a tool in the hand, and what the hand does with it.
struct ToolHold {
  Pose pose;
  // Axes of the tool in the world: the orientation of the pose, or the mirror image of that orientation.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double reach_m = 0.0;  // largest movement of any part of the tool in this tick, at least 0
  bool gripping = false;
  bool hovering = false;
};

// Contact of one tool with the bodies: finds where the tool touches their surfaces and adds constraints on
// their lattices. Owned by the simulation, which rebuilds it when the mapping of a body or the model of the
// tool is replaced. prepare() allocates nothing.
class ToolContact {
 public:
  ToolContact(std::span<const BodyState> bodies, const ToolModel& model);

  // Finds the tool's contacts and lets the kernel of its action (ToolKernel) add the constraints of this
  // tick. A tool that has hovered does not act again until it has stopped hovering and is outside the bodies.
  void prepare(std::span<const BodyState> bodies, const Tool& tool, const ToolModel& model,
               const ToolHold& hold);
  // Prepares a tick with a soft tool, which touches the bodies as a body of the simulation.
  void prepare_soft();
  // Decides and stores whether the tool acts in this tick, and returns the decision. `inside` is true if the
  // tool is inside a body. `near` is true if it is within a margin of a body: half a lattice cell for a rigid
  // tool, contact_margin_cells for a soft tool.
  bool acts(bool inside, bool near, const ToolHold& hold);
  void release();

  // Keeps the bodies' surfaces out of the tool in this tick; the surfaces slide along the tool. To be called
  // by kernels, after prepare() has found the contacts.
  void push(std::span<const BodyState> bodies, const ToolHold& hold);
  // Holds the part of the surface that is inside the tool fixed in the tool's frame, until release(). To be
  // called by kernels, after prepare() has found the contacts.
  void grip(std::span<const BodyState> bodies, const ToolHold& hold);
  bool gripped() const { return gripped_; }

  // Suspends the tool from the next prepare() on. It acts again when the button is released and the tool is
  // not near a body (see acts()) or hovers outside the bodies.
  void lift();
  bool lifted() const { return lifted_; }
  bool hovered() const { return hovered_; }

  ContactConstraints& constraints() { return constraints_; }
  const ContactConstraints& constraints() const { return constraints_; }
  // collision() returns the collision with a body. deepest_body() returns the index of the body in which the
  // tool is deepest.
  const CollisionResult& collision(int body) const { return contacts_[body].collision; }
  int deepest_body() const;
  bool overflow() const { return overflow_; }

  // Calls `visit` with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    constraints_.visit_state(visit);
    for (const BodyContact& contact : contacts_) {
      for (const ContactPoint& point : contact.points) {
        if (!point.is_used) continue;
        visit(&point.u, 1);
        visit(&point.v, 1);
      }
    }
  }

 private:
  // Point of a body's surface that is, or was, nearest to the tool.
  struct ContactPoint {
    bool is_used = false;
    double u = 0.0, v = 0.0;
    Vector3 position_m = Vector3::Zero();  // in this tick
  };
  struct BodyContact {
    SurfaceCollider collider;
    std::unique_ptr<SurfaceProximity> proximity;  // only for B-spline tools
    CollisionResult collision;
    // The nearest point may jump between places where the tool is equally deep. Each place stays constrained
    // while it pushes; otherwise the force would ripple. points[i] has the key nearest_point_key - i.
    std::array<ContactPoint, 8> points;
  };
  // Point of a body's surface, and the tangent plane of the tool that the point must not cross.
  struct Pushed {
    EmbeddedPoint point;
    Vector3 normal;  // unit normal, away from the tool
    double gap_m;
    int key;  // see nearest_point_key
  };

  void find(BodyContact& contact, const BodyState& body, const Tool& tool, const ToolModel& model,
            const ToolHold& hold);
  void find_near_points(BodyContact& contact, const BodyState& body, double margin, const ToolHold& hold);
  // Replaces the contact with a shell's surface by the contact with the face of the shell that is nearest to
  // the tool.
  void select_shell_face(BodyContact& contact, const BodyState& body, double margin) const;
  // Assigns the nearest point of the last find() to one of the contact points and returns that point's index.
  // Frees the points that pushed with no force in the last tick.
  std::size_t track_nearest(int body, const BodyState& state, double reach_m);
  // Adds pushes at the contact points other than the nearest one.
  void add_earlier_pushes(int body, const BodyState& state, std::size_t nearest, const ToolHold& hold);
  // Returns whether the tool is a point, or a sphere with a radius less than a lattice cell.
  bool is_small(const BodyState& body) const;
  // Returns whether the tool in the hand is a B-spline. Checks the tool's kind as well, because the model may
  // belong to an earlier solid tool.
  bool is_surface() const { return is_solid_ && placed_ != nullptr; }
  void add_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_pushes_between_samples(int body, const BodyState& state, double reach_m);
  void add_sphere_pushes(int body, const BodyState& state, const ToolHold& hold);
  // Returns the gap between the tool and the point (u, v) of the body's surface, or of the far face of a
  // shell, given the tool's distance to the surface.
  double find_gap(const BodyState& state, double u, double v, double distance_m) const;
  double find_gap(const BodyState& state, const NearSample& sample) const;
  void add_shell_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_plane_push(int body, const BodyState& state, const Pushed& pushed, const ToolHold& hold);
  void add_grips(int body, const BodyState& state, const Pose& pose);

  template <class Visit>
  void visit_near(BodyContact& contact, const BodyState& state, const Visit& visit);

  std::vector<BodyContact> contacts_;  // contact with each body
  std::unique_ptr<Surface> placed_;    // only for B-spline tools, in world coordinates
  ToolShape shape_;                    // for all other tools
  ContactConstraints constraints_;
  bool is_solid_ = false;
  bool gripped_ = false;
  bool lifted_ = false;
  bool hovered_ = false;
  bool overflow_ = false;
};

}  // namespace spoonbill
