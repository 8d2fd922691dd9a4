// Contact of bodies with the ground, as constraints on their lattices, and the heights of surfaces above it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/material/contact/ground_contacts.h"
#include "engine/scene/loads.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// Heights of a surface above a plane. The height is itself a spline whose coefficients are the heights of the
// control points. It is sampled four times per element in each direction. Between samples, parabolas through
// neighbouring samples estimate the lowest height. Has one owner on one thread. Allocates only in make().
class SkinHeights {
 public:
  // Makes the memory for the heights of any surface with these knots.
  static Result<SkinHeights> make(const KnotVector& u, const KnotVector& v);

  int rows() const { return nested_.grid.rows(); }
  int columns() const { return nested_.grid.columns(); }
  const std::vector<double>& u_parameters() const { return nested_.grid.u.parameters; }
  const std::vector<double>& v_parameters() const { return nested_.grid.v.parameters; }
  double u(int row) const { return nested_.grid.u.parameters[static_cast<std::size_t>(row)]; }
  double v(int column) const { return nested_.grid.v.parameters[static_cast<std::size_t>(column)]; }

  // Samples the heights above the plane. Parts of the surface higher than `reach_m` may be skipped. If it
  // returns false, the whole surface is higher, and the heights are not valid.
  bool compute(const Surface& surface, const Vector3& point_m, const Vector3& normal, double reach_m);
  // Returns an estimate of the lowest height between a sample and its neighbours; infinite if the sample was
  // skipped.
  double lowest_m(int row, int column) const;

 private:
  explicit SkinHeights(NestedGrid nested);
  bool compute_row(int row, double reach_m);
  double height(int row, int column) const {
    return height_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns()) +
                   static_cast<std::size_t>(column)];
  }
  double dip_along_u(int row, int column) const;
  double dip_along_v(int row, int column) const;

  NestedGrid nested_;
  std::vector<double> control_;  // heights of the control points
  std::vector<double> blended_;  // one row of samples before blending along v
  std::vector<double> height_;   // heights of the samples; infinite if skipped
};

// Returns whether the body is in a box of cells, whose nodes are not on the skin.
bool is_boxed(const LatticeMesh& mesh);

// Returns the height below which a point of a body is constrained, for a tick of `time_s`.
double find_ground_margin_m(const BodyState& body, const Vector3& gravity_m_per_s2, double time_s);

// Largest penetration of the skin of a resting body into the ground, in lattice cells, where its nodes touch
// the ground.
inline constexpr double ground_depth_limit_cells = 0.01;

// Ground contact of deformable bodies (see RigidGroundContact and SampledGroundContact for others). Owned by
// the simulation, which rebuilds it when the mapping of a body is replaced. find() allocates nothing.
class BodyGroundContact {
 public:
  explicit BodyGroundContact(std::span<const BodyState> bodies);

  // Adds a constraint for each node whose attached samples (see Footing) can reach the ground in the coming
  // tick of `time_s`. Skips bodies of which has_sampled_ground_contact() is true.
  void find(std::span<const BodyState> bodies, const Ground& ground, const Sculpting& sculpting,
            double time_s);

  // Forgets the forces of the contacts and the positions of the skin, for example after a jump of the bodies.
  void forget();

  // Calls `visit` with the state on which the next tick depends.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    contacts_.visit_state(visit);
    for (const BodyFootings& body : bodies_) {
      for (const Footing& footing : body.footings) {
        if (footing.is_near) visit(&footing.skin_m, 1);
      }
    }
  }

  GroundContacts& contacts() { return contacts_; }
  const GroundContacts& contacts() const { return contacts_; }

 private:
  // A node together with the samples attached to it. "Followed" samples of the mapping move exactly with the
  // lattice; samples of the skin are on the surface of the control net, which differs slightly. There is a
  // footing for each node on the outer shell of the lattice or, in a box of cells, for each node with
  // attached samples. In a box, a node without followed samples of its own gets the followed samples nearest
  // to its skin samples.
  struct Footing {
    int node = 0;
    int first_followed = 0, followed_count = 0;  // range in BodyFootings::followed
    int first = 0, count = 0;                    // range in BodyFootings::samples
    double skin_m = 0.0;                         // filtered height of the skin above the followed samples
    bool is_near = false;                        // whether the footing was near the ground in the last tick
  };
  struct Sample {
    int row = 0, column = 0;
  };
  // Samples attached to one node.
  struct AttachedSamples {
    std::vector<int> followed;
    std::vector<Sample> skin;
  };
  struct BodyFootings {
    std::optional<SkinHeights> heights;  // empty for a rigid body, which has no footings
    // The size of a cell or, in a box of cells, the largest distance at rest between a followed sample and
    // its node, whichever is larger.
    double max_sample_distance_m;
    std::vector<Footing> footings;
    std::vector<int> followed;  // indices of samples of the mapping
    std::vector<Sample> samples;
  };

  static std::vector<AttachedSamples> attach_samples(const BodyState& body, const SkinHeights& heights);
  static BodyFootings make_footings(const BodyState& body);
  void find(int index, const BodyState& body, const Ground& ground, double reach_m, double time_s);
  // Updates Footing::skin_m, the filtered height of the skin above the followed samples. `followed_m` is the
  // height of the lowest followed sample, `constant_s` the time constant of the filter.
  void update_skin_offset(const BodyFootings& body, double followed_m, double time_s, double constant_s,
                          Footing& footing) const;

  std::vector<BodyFootings> bodies_;
  GroundContacts contacts_;
};

}  // namespace spoonbill
