// Branch and bound over two patches: whether two surfaces touch between their finest samples, and no pair of
// points nearer than the nearest known is missed.
#pragma once

#include <vector>

#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// Says which pairs of places count. Of one surface with itself, Newton's method may lead to a single place,
// which is no distance from itself.
class PairJudge {
 public:
  virtual bool counts(const PairParameters& at) const = 0;

 protected:
  ~PairJudge() = default;
};

// One owner, one thread; allocates only when made.
class PairSearch {
 public:
  // Both may be the same surface, with a judge, which must outlive it.
  PairSearch(SurfaceLevels& first, SurfaceLevels& second, const PairJudge* judge = nullptr);

  void begin();
  void forget_best();

  // The best pair so far is that of `from` polished, where it is nearer; as it is where, polished, it does
  // not count.
  void offer(const PairParameters& from);
  const SurfacePair& best() const { return best_; }
  double best_distance_m() const { return best_distance_m_; }

  // Searches two cells until nothing in them can be nearer than the best by more than `tolerance_m`, or the
  // best is within `enough_m`.
  void search(const LevelCell& a, const LevelCell& b, double tolerance_m, double enough_m);

  // Whether a search ended before its time.
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

  static Patch patch_of(SurfaceLevels& levels, const LevelCell& cell);
  static std::array<Patch, 4> cut(const PiecewiseSurface& surface, const Patch& patch);
  void split(const Pair& pair);

  SurfaceLevels* first_;
  SurfaceLevels* second_;
  const PairJudge* judge_;
  std::vector<Pair> pairs_;
  SurfacePair best_;
  double best_distance_m_ = 0.0;
  bool overflow_ = false;
};

}  // namespace spoonbill
