// A stroke of local reach: it shapes the material near the touched point, and everything else keeps its
// place.
//
// The touched point moves with the tool. A node moves by the same displacement times a weight
//   (1 - (s / radius)^2)^2 * (1 - depth / (0.6 * thickness)).
// s is the distance along the surface from the touched point to the node's nearest point of the surface, and
// `depth` the node's distance from the surface there. The weight is 0 where s or depth is larger. The
// material takes its new place as its rest shape (SpringLattice::reform()), so nothing springs back or bends
// later. The volume may change.
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
};

// Region and progress of one local stroke. Owned by the contact of a tool. Only the constructor allocates.
class LocalStroke {
 public:
  explicit LocalStroke(std::span<const BodyState> bodies);

  // Finds the nodes that a stroke of this radius at this point moves, and their weights. A stroke that is
  // active goes on there. `state` is that of the touched body.
  void begin(const ToolSpot& touch, const BodyState& state, double radius_m);
  void end() { touch_.body = -1; }
  bool is_active() const { return touch_.body >= 0; }
  int body() const { return touch_.body; }
  // Position of the tool when it touched the point.
  const Vector3& tool_start_m() const { return touch_.tool_m; }

  // Moves the touched point by `move_m` and the nodes around it by their weights, in the body of begin(). A
  // node whose springs or cells cannot take the new shape stays (SpringLattice::reform()). Once the touched
  // point itself hardly moves, the stroke moves nothing until the next begin().
  void move(SpringLattice& lattice, const Vector3& move_m);

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
    visit(touch_.tool_m.data(), 3);
    for (const double* value : {&radius_m_, &elastic_m_}) visit(value, 1);
    const double spent = is_spent_ ? 1.0 : 0.0;
    visit(&spent, 1);
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

  void march(const BodyState& state, const CoarseGrid& grid, const TouchedPoint& at);
  double find_distance(const BodyMapping& mapping, int from, const Ring& ring, std::size_t at) const;
  double find_thickness_m(const BodyState& state, const CoarseGrid& grid, const TouchedPoint& at) const;
  void weigh_nodes(const BodyState& state, const TouchedPoint& at, double thickness_m);

  ToolSpot touch_;
  EmbeddedPoint point_;  // the touched point
  double radius_m_ = 0.0, elastic_m_ = 0.0;
  double share_ = 0.0;     // part of a move that the touched point makes: the mean weight of its nodes
  bool is_spent_ = false;  // true if the material takes no further move
  std::vector<WeighedNode> nodes_;
  // Working memory: distances of all samples of a body, a heap of distances and samples, and the samples
  // within the radius.
  std::vector<float> distance_m_;
  std::vector<std::pair<float, int>> heap_;
  std::vector<Sample> region_;
};

}  // namespace spoonbill
