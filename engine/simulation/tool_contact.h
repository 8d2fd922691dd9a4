// The tool on the bodies: finds where it touches their surfaces and turns that into constraints on their
// lattices.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/tool_model.h"

namespace spoonbill {

// A tool that is held: where, and what the hand does with it.
struct ToolHold {
  Pose pose;
  // The tool's frame in the world: the pose's orientation, or the mirror image of one.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double reach_m = 0.0;  // how far any part of the tool may come in this tick
  bool gripping = false;
  bool hovering = false;
};

// One owner, the simulation; rebuilt with the mapping of a body or the model of the tool. prepare() allocates
// nothing.
class ToolContact {
 public:
  ToolContact(std::span<const BodyState> bodies, const ToolModel& model);

  // Finds the contacts of the tool, and has the kernel of its action (tool_kernel.h) set the constraints of
  // this tick.
  // While `hovering`, and then until it is outside the bodies, the tool acts on nothing.
  void prepare(std::span<const BodyState> bodies, const Tool& tool, const ToolModel& model,
               const ToolHold& hold);
  // The same for a soft tool, which is a body and touches the others by itself.
  void prepare_soft();
  // Whether the tool acts in this tick, of which it is known whether it is inside a body and near one.
  bool acts(bool inside, bool near, const ToolHold& hold);
  void release();

  // For the kernels, on what prepare() has found. The surface of the bodies stays out of the tool in this
  // tick, and slides along it.
  void push(std::span<const BodyState> bodies, const ToolHold& hold);
  // What of the surface is in the tool keeps its place in the tool's frame, in this tick and in those after
  // it, until release().
  void grip(std::span<const BodyState> bodies, const ToolHold& hold);
  bool gripped() const { return gripped_; }

  // Acts on nothing from the next prepare() on until the button is free and the tool has left the bodies, by
  // a margin or hovering.
  void lift();
  bool lifted() const { return lifted_; }
  bool hovered() const { return hovered_; }

  ContactConstraints& constraints() { return constraints_; }
  const ContactConstraints& constraints() const { return constraints_; }
  // With one of the bodies, and with which the tool is deepest in.
  const CollisionResult& collision(int body) const { return contacts_[body].collision; }
  int deepest_body() const;
  bool overflow() const { return overflow_; }

 private:
  struct BodyContact {
    SurfaceCollider collider;
    std::unique_ptr<SurfaceProximity> proximity;  // of a B-spline tool
    CollisionResult collision;
  };
  // A point of a body's surface and the plane of the tool that it must stay beyond.
  struct Pushed {
    EmbeddedPoint point;
    Vector3 normal;  // unit, away from the tool
    double gap_m;
  };

  void find(BodyContact& contact, const BodyState& body, const Tool& tool, const ToolModel& model,
            const ToolHold& hold);
  void find_near(BodyContact& contact, const BodyState& body, double margin, const ToolHold& hold);
  // Of a shell: which of its faces the tool is nearest to, and how deep in it.
  void take_face(BodyContact& contact, const BodyState& body, double margin) const;
  // A sphere that fits between samples.
  bool is_small(const BodyState& body) const;
  // Whether the tool is a B-spline: the model is of the last solid, and what is held may be none.
  bool is_surface() const { return is_solid_ && placed_ != nullptr; }
  void add_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_sphere_pushes(int body, const BodyState& state);
  // Of a sample of a body that is near the tool: to its surface, or to the far face of a shell.
  double gap_of(const BodyState& state, const NearSample& sample) const;
  void add_shell_pushes(int body, const BodyState& state, const ToolHold& hold);
  void add_plane_push(int body, const BodyState& state, const Pushed& pushed, const ToolHold& hold);
  void add_grips(int body, const BodyState& state, const Pose& pose);

  template <class Visit>
  void visit_near(BodyContact& contact, const BodyState& state, const Visit& visit);

  std::vector<BodyContact> contacts_;  // one a body
  std::unique_ptr<Surface> placed_;    // of a B-spline tool, in the world
  ToolShape shape_;                    // of any other
  ContactConstraints constraints_;
  bool is_solid_ = false;
  bool gripped_ = false;
  bool lifted_ = false;
  bool hovered_ = false;
  bool overflow_ = false;
};

}  // namespace spoonbill
