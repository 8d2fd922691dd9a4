#include "engine/simulation/shell_gap.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Of the height over a surface: what lies that much farther to its side is not over it. Nearest points are
// found to far less.
constexpr double beside_share = 0.2, rounding_m = 1e-6;

}  // namespace

double far_face_lead_m(double thickness_m, const Vector3& normal, const Vector3& push) {
  SPOONBILL_ASSERT_DEBUG(thickness_m >= 0.0);
  return thickness_m * std::max(0.0, normal.dot(push));
}

bool gap_to_shell(const Surface& shell, double thickness_m, double u, double v, const Vector3& point_m,
                  double margin_m, Vector3& normal, double& gap_m) {
  const Vector3 outward = unit_normal(shell, u, v), over = point_m - position(shell, u, v);
  const double height = over.dot(outward);
  if ((over - height * outward).norm() > beside_share * std::abs(height) + rounding_m) return false;
  const bool behind = height < -0.5 * thickness_m;
  normal = behind ? Vector3(-outward) : outward;
  gap_m = behind ? -height - thickness_m : height;
  return gap_m <= margin_m;
}

bool settle_shell_gap(const MaybeShell& of, const MaybeShell& other, double margin_m, NearPoint& near) {
  SPOONBILL_ASSERT_DEBUG(of.surface != nullptr && other.surface != nullptr);
  if (other.thickness_m > 0.0 &&
      !gap_to_shell(*other.surface, other.thickness_m, near.other_u, near.other_v, near.point_m,
                    margin_m + of.thickness_m, near.normal, near.gap_m)) {
    return false;
  }
  if (of.thickness_m > 0.0) {
    near.gap_m -= far_face_lead_m(of.thickness_m, unit_normal(*of.surface, near.u, near.v), near.normal);
  }
  return near.gap_m <= margin_m;
}

}  // namespace spoonbill
