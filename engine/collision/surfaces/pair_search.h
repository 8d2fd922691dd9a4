// Searches that decide whether two surfaces touch: separation of the convex hulls of their control points,
// and branch and bound over two patches.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// Returns true only if a plane separates the convex hulls of the control points, which contain the surfaces;
// the plane is verified with all control points. Hulls that nearly touch may count as intersecting. Only
// support functions are used, so the hulls of moving control points need not be built (Gilbert, Johnson and
// Keerthi 1988). Allocates nothing.
bool hulls_are_apart(const ControlNet& first, const ControlNet& second);

// Decides which pairs of points count. It is needed when a surface is tested against itself: Newton's method
// may move both points to the same position, and a distance of zero between them then means nothing.
class PairJudge {
 public:
  virtual bool counts(const PairParameters& at) const = 0;

 protected:
  ~PairJudge() = default;
};

// Branch and bound over two patches. Not thread-safe. Allocates only on construction.
class PairSearch {
 public:
  // Both arguments may be the same surface if there is a judge. The surfaces and the judge must outlive the
  // search.
  PairSearch(SurfaceLevels& first, SurfaceLevels& second, const PairJudge* judge = nullptr);

  // Starts a new query: clears the best pair and overflow().
  void begin();
  void forget_best();

  // Polishes the pair `from` by Newton's method. The result becomes the best pair if its distance is less
  // than that of the best pair. If the judge rejects the polished pair, `from` itself is considered.
  void offer(const PairParameters& from);
  const SurfacePair& best() const { return best_; }
  double best_distance_m() const { return best_distance_m_; }

  // Searches two cells until no pair of points in them can be nearer than the best pair by more than
  // `tolerance_m`, or the distance of the best pair is at most `enough_m`. Both values are in metres; the
  // tolerance must be positive.
  void search(const LevelCell& a, const LevelCell& b, double tolerance_m, double enough_m);

  // Returns true if the searches since begin() exceeded a capacity and skipped some patches.
  bool overflow() const { return overflow_; }

 private:
  struct Patch {
    double u0, u1, v0, v1;
    PatchCorners corners;
    double bulge;
    double size() const;
  };
  struct Pair {
    Patch a, b;
    int depth;
  };

  static Patch make_patch(SurfaceLevels& levels, const LevelCell& cell);
  static std::array<Patch, 4> cut(const PiecewiseSurface& surface, const Patch& patch);
  void split(const Pair& pair);

  SurfaceLevels* first_;
  SurfaceLevels* second_;
  const PairJudge* judge_;
  std::vector<Pair> pairs_;
  SurfacePair best_;
  double best_distance_m_ = 0.0;
  int splits_left_ = 0;  // splits left until the next begin()
  bool overflow_ = false;
};

}  // namespace spoonbill
