// Contact of the tool with the bodies in a tick.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/local_stroke.h"
#include "engine/simulation/tool_model.h"

namespace spoonbill {

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
  // Adds a hold on the point that the tool has touched first since it began to hold, as long as the tool
  // stays at the surface. Call after push() in every tick, with `holds` false where the tool may slide.
  void hold_sideways(std::span<const BodyState> bodies, const ToolHold& hold, bool holds);
  // Keeps only the nearest points of the surfaces out of the tool in this tick. For bodies that do not yield
  // to the tool's force.
  void push_nearest(std::span<const BodyState> bodies, const ToolHold& hold);
  // Holds the part of the surface that is inside the tool fixed in the tool's frame, until release(). To be
  // called by kernels, after prepare() has found the contacts.
  void grip(std::span<const BodyState> bodies, const ToolHold& hold);
  bool gripped() const { return gripped_; }
  // Holds only the point of the surface that is nearest to the tool, of the body in which the tool is
  // deepest.
  void grip_nearest(std::span<const BodyState> bodies, const ToolHold& hold);
  // The stroke of a tool with a local reach.
  LocalStroke& local_stroke() { return local_stroke_; }
  const LocalStroke& local_stroke() const { return local_stroke_; }
  // Takes over the contacts of a tool on the same lattices, before a body's surface was refined.
  // `new_sample` holds the new index of each of the body's samples. Allocates nothing.
  void carry_over(const ToolContact& before, int body, std::span<const int> new_sample);

  // Suspends the tool from the next prepare() on. It acts again when the button is released and the tool is
  // not near a body (see acts()) or hovers outside the bodies.
  void lift();
  bool lifted() const { return lifted_; }
  // Takes over whether another contact of the same tool was suspended.
  void keep_suspension(const ToolContact& other) {
    lifted_ = other.lifted_;
    hovered_ = other.hovered_;
  }
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
    local_stroke_.visit_state(visit);
    for (const BodyContact& contact : contacts_) {
      for (const ContactPoint& point : contact.points) {
        if (!point.is_used) continue;
        visit(&point.u, 1);
        visit(&point.v, 1);
      }
    }
    if (held_.body < 0) return;
    for (const double* value : {&held_.u, &held_.v}) visit(value, 1);
    for (const Vector3* value : {&held_.offset_m, &held_.normal}) visit(value->data(), 3);
  }

 private:
  // Point of a body's surface that the tool keeps hold of sideways, and its place and the surface's normal in
  // the tool's frame when the tool first touched it.
  struct HeldPoint {
    int body = -1;  // -1 for none
    double u = 0.0, v = 0.0;
    Vector3 offset_m = Vector3::Zero();
    Vector3 normal = Vector3::Zero();
  };
  // Point of a body's surface that is, or was, nearest to the tool.
  struct ContactPoint {
    bool is_used = false;
    double u = 0.0, v = 0.0;
    Vector3 position_m = Vector3::Zero();  // in this tick
  };
  struct BodyContact {
    std::optional<SurfaceCollider> collider;      // empty for a body with a mesh, which rigid tools pass
    std::unique_ptr<SurfaceProximity> proximity;  // only for B-spline tools
    CollisionResult collision;
    double approach_m = 0.0;  // how far a point of the body and the tool may approach each other in this tick
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
  // Returns whether the centre of the tool's sphere is outside the body. The sphere can push only points that
  // it reaches from outside.
  bool is_centre_outside(int body) const;
  // Returns whether the tool is a sphere that pushes only fixed points of the body, not the nearest point.
  bool rests_on_lattice(int body, const BodyState& state) const;
  // Returns whether the tool in the hand is a B-spline. Checks the tool's kind as well, because the model may
  // belong to an earlier solid tool.
  bool is_surface() const { return is_solid_ && placed_ != nullptr; }
  void add_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_nearest_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_pushes_between_samples(int body, const BodyState& state);
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
  LocalStroke local_stroke_;
  HeldPoint held_;
  bool is_solid_ = false;
  bool gripped_ = false;
  bool lifted_ = false;
  bool hovered_ = false;
  bool overflow_ = false;
};

}  // namespace spoonbill
