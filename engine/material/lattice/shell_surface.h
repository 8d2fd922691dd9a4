// The surface of a shell by two shares of its domain, turned about so that one runs around or across and the
// other along it.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// One owner; immutable. The surface must outlive it.
class ShellSurface {
 public:
  // What the surface makes: see shell_lattice.h.
  enum class Form { sheet, ring, bowl };

  // Refused with the reason where it is none of these.
  static Result<ShellSurface> make(const Surface& surface);

  Form form() const { return form_; }
  // Shares from 0 to 1; `across` runs around where the form is no sheet, and `along` from the pole of a bowl.
  struct Place {
    double across = 0.0, along = 0.0;
  };
  Vector3 position_m(const Place& place) const;
  Vector3 normal(const Place& place) const;
  // 1 where normal, across and along make a right-handed frame in this order, -1 otherwise.
  double handedness() const { return (swapped_ ? -1.0 : 1.0) * (pole_at_end_ ? -1.0 : 1.0); }

  // Shares that cut every polynomial piece into the same number of parts, at least `least` in all; both ends
  // are among them.
  std::vector<double> across_shares(int least) const;
  std::vector<double> along_shares(int least) const;

 private:
  explicit ShellSurface(const Surface& surface) : surface_(&surface) {}
  struct Parameters {
    double u, v;
  };
  Parameters parameters(const Place& place) const;
  const KnotVector& across_knots() const { return swapped_ ? surface_->v : surface_->u; }
  const KnotVector& along_knots() const { return swapped_ ? surface_->u : surface_->v; }
  bool is_point(const std::vector<Place>& line) const;

  const Surface* surface_;
  Form form_ = Form::sheet;
  bool swapped_ = false, pole_at_end_ = false;
};

}  // namespace spoonbill
