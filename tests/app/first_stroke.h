// First strokes on nine shapes, as a person makes them with the settings of a new document. Nothing is fixed.
#pragma once

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/session/session.h"
#include "engine/exchange/document.h"

namespace spoonbill {

struct FirstShape {
  std::string name;
  std::vector<std::string> options;  // of `spoonbill new`
  Vector3 above_m;                   // a point above the one that is pressed, along the direction `outward`
  Vector3 outward = Vector3::UnitY();
  double thickness_m = 0.0;  // along this direction

  // A quarter of the thickness, at most 4 mm.
  double travel_m() const { return std::min(0.25 * thickness_m, 0.004); }
};
std::span<const FirstShape> first_shapes();
// Returns the name of a shape for a test.
std::string first_shape_name(std::size_t shape);

// Makes the document in the folder and reads it. Without fixing planes.
Document make_first_document(const FirstShape& shape, const std::filesystem::path& folder);

// Follows the point that is pressed.
class PressedPoint {
 public:
  // The point of the surface that is nearest to `near_m`.
  PressedPoint(const Surface& rest, const Vector3& near_m);

  const Vector3& start_m() const { return start_m_; }
  const Vector3& normal() const { return normal_; }
  Vector3 position_m(const Surface& shaped) const;
  // Returns how far the point has moved inward, measured against the body farther from it than `region_m`:
  // against the rigid motion that fits there best (Kabsch 1976).
  double find_depth_m(const Surface& shaped, double region_m) const;

 private:
  Surface rest_;
  double u_ = 0.0, v_ = 0.0;
  Vector3 start_m_, normal_;
};

// Returns the distance of the surface from a ball; negative if the surface is inside.
double find_gap_m(const Surface& surface, const Vector3& centre_m, double radius_m);

}  // namespace spoonbill
