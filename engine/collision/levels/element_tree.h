// A tree of boxes over the elements of a surface: which ranges of parameters can meet another surface at all
// (the limits of parameters that section 4.1 of Pungotra et al. 2013 takes from overlapping hulls).
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// One owner, one thread; allocates only when made.
class ElementTree {
 public:
  ElementTree(const KnotVector& u, const KnotVector& v);

  struct Node {
    int first_u, end_u, first_v, end_v;  // elements
    int left = -1, right = -1;           // -1 in a leaf, which is one element
    bool is_leaf() const { return left < 0; }
  };

  // Takes the boxes of the present shape: each element's from its control points, made smaller by the one
  // from its corners, where the surface is not far from flat.
  void update(SurfaceLevels& levels);

  int root() const { return 0; }
  // The leaf whose box has its middle nearest to a point.
  int leaf_near(const Vector3& point) const;
  const Node& node(int index) const { return nodes_[index]; }
  const Box& box(int index) const { return boxes_[index]; }
  // The sum of a box's sides.
  double size(int index) const { return sizes_[index]; }

 private:
  struct Direction {
    int degree;
    std::vector<int> first_control;  // of each element, into `control`
    std::vector<int> control;        // unrolled index to control index
    int elements() const { return static_cast<int>(first_control.size()); }
  };
  static Direction unroll(const KnotVector& knots);
  int add(const Node& range);
  void take_strip(SurfaceLevels& levels, int element_u);
  Box hull_of(const ControlNet& net, int element_u, int element_v) const;
  void join_boxes();

  Direction u_, v_;
  std::vector<Node> nodes_;  // parents before their children
  std::vector<Box> boxes_;
  std::vector<double> sizes_;
  std::vector<Box> strip_;      // working memory: of the elements of one span of u
  std::vector<double> bulges_;  // working memory, as strip_
  std::vector<int> leaf_;       // of each element
};

}  // namespace spoonbill
