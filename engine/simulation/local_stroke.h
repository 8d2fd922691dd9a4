// A stroke of local reach: it shapes the material near the touched point, and everything else keeps its
// place.
//
// The touched point moves with the tool. A node moves by the same displacement times a weight
//   (1 - (s / radius)^2)^2 * (1 - depth / (0.6 * thickness)).
// s is the distance along the surface from the touched point to the node's nearest point of the surface, and
// `depth` the node's distance from the surface there. The weight is 0 where s or depth is larger. The
// material takes its new place as its rest shape (SpringLattice::reform()), so nothing springs back or bends
// later. The volume may change. While a push goes deeper, the radius grows so that the tool fits into the
// dent; the dent then gets the profile of the wider radius as a whole.
//
// s is measured by fast marching over the samples of the surface (Kimmel and Sethian 1998). The thickness is
// the diameter of the largest sphere that touches the surface at the touched point from inside and contains
// no other sample (the shrinking ball of Ma, Bae and Choi 2012).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// Part of the thickness into which a local stroke reaches. The far side is held.
inline constexpr double local_depth_fraction = 0.6;

// Time in which the resistance of the material to a stroke that has stopped falls to a third, s. A hand then
// feels the stroke but need not press on to keep it.
inline constexpr double local_relaxation_s = 0.15;

// A tool that touches a point of a body's surface.
struct ToolSpot {
  int body = -1;                     // index of the body, or -1
  double u = 0.0, v = 0.0;           // the point
  Vector3 tool_m = Vector3::Zero();  // position of the tool
  Vector3 normal = Vector3::Zero();  // outward unit normal of the surface
};

// Region and progress of one local stroke. Owned by the contact of a tool. Only the constructor allocates.
class LocalStroke {
 public:
  explicit LocalStroke(std::span<const BodyState> bodies);

  // Finds the nodes that a stroke of this radius at this point moves, and their weights. A stroke that is
  // active goes on there. `state` is that of the touched body.
  void begin(const ToolSpot& touch, const BodyState& state, double radius_m);
  // Gives an active stroke another radius at the same point. A stroke that moved nothing any more may go on.
  void widen(const BodyState& state, double radius_m);
  void end() { touch_.body = -1; }
  bool is_active() const { return touch_.body >= 0; }
  int body() const { return touch_.body; }
  // The touch of begin().
  const ToolSpot& touch() const { return touch_; }
  // Returns how far the touched point has been moved inward since begin().
  double depth_m() const { return -moved_m_.dot(touch_.normal); }

  // Moves the touched point by `move_m` and the nodes around it by their weights, in the body of begin(). A
  // node whose springs or cells cannot take the new shape stays (SpringLattice::reform()). Once the touched
  // point itself hardly moves, the stroke moves nothing until the next begin().
  void move(SpringLattice& lattice, const Vector3& move_m);
  // Presses the touched point inward by another `deeper_m`, with the same limits. The dent has the profile of
  // the present radius, as if it had been pressed with it from the start: after widen(), nodes beside the
  // point catch up by at most `most_m` in a call.
  void press(SpringLattice& lattice, double deeper_m, double most_m);

  // Lets the material take its new place for `time_s`: the elastic depth, in which move() has put it, decays
  // with local_relaxation_s.
  void relax(double time_s);
  double elastic_m() const { return elastic_m_; }

  // Returns where the touched point is now, and how far the stroke reaches.
  Vector3 point_m(const SpringLattice& lattice) const { return point_.position_m(lattice); }
  double radius_m() const { return radius_m_; }

  // Takes over the stroke of another object for the same lattices. Allocates nothing.
  void carry_over(const LocalStroke& other);

  // Calls visit(const double*, count) with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    if (!is_active()) return;
    for (const double* value : {&touch_.u, &touch_.v}) visit(value, 1);
    for (const Vector3* value : {&touch_.tool_m, &touch_.normal, &moved_m_}) visit(value->data(), 3);
    for (const double* value : {&radius_m_, &elastic_m_}) visit(value, 1);
    const double spent = is_spent_ ? 1.0 : 0.0;
    visit(&spent, 1);
    visit(&pressed_m_, 1);
    for (const WeighedNode& node : nodes_) visit(&node.pressed_m, 1);
  }

 private:
  struct Sample {
    double distance_m = 0.0;  // along the surface
    Vector3 point_m = Vector3::Zero();
    Vector3 normal = Vector3::Zero();
  };
  struct WeighedNode {
    int node = 0;
    double weight = 0.0;
    double pressed_m = 0.0;  // inward move by press() since begin()
  };
  // The touched point in the rest shape.
  struct TouchedPoint {
    double u = 0.0, v = 0.0;
    Vector3 point_m = Vector3::Zero();
    Vector3 normal = Vector3::Zero();
  };
  using Ring = std::array<int, 8>;  // the samples around a sample; -1 for none
  // A grid of samples of which every stride-th counts, with wrapped neighbours.
  struct CoarseGrid;

  void find_nodes(const BodyState& state);
  void march(const BodyState& state, const CoarseGrid& grid, const TouchedPoint& at);
  double find_distance(const BodyMapping& mapping, int from, const Ring& ring, std::size_t at) const;
  double find_thickness_m(const BodyState& state, const CoarseGrid& grid, const TouchedPoint& at) const;
  void weigh_nodes(const BodyState& state, const TouchedPoint& at, double thickness_m);
  void record_move(const SpringLattice& lattice, const Vector3& before_m, double asked_m);

  ToolSpot touch_;
  EmbeddedPoint point_;                // the touched point
  Vector3 moved_m_ = Vector3::Zero();  // sum of its moves since begin()
  double radius_m_ = 0.0, elastic_m_ = 0.0;
  double pressed_m_ = 0.0;  // inward move of a node of weight 1 that press() has asked for since begin()
  double share_ = 0.0;      // part of a move that the touched point makes: the mean weight of its nodes
  bool is_spent_ = false;   // true if the material takes no further move
  std::vector<WeighedNode> nodes_, narrower_;  // narrower_ is working memory of widen()
  // Working memory: distances of all samples of a body, a heap of distances and samples, and the samples
  // within the radius.
  std::vector<float> distance_m_;
  std::vector<std::pair<float, int>> heap_;
  std::vector<Sample> region_;
};

}  // namespace spoonbill
