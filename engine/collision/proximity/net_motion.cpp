#include "engine/collision/proximity/net_motion.h"

#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Calls visit(i, point) for each control point relative to the frame, m.
template <class Visit>
void visit_points(const ControlNet& net, const Pose& frame, const Visit& visit) {
  const Eigen::Matrix3d back = frame.orientation.conjugate().toRotationMatrix();
  for (std::size_t i = 0; i < net.x.size(); ++i) {
    visit(i, Vector3(back * (Vector3(net.x[i], net.y[i], net.z[i]) - frame.position_m)));
  }
}

}  // namespace

NetMotion::NetMotion(int control_points)
    : points_m_(static_cast<std::size_t>(control_points), Vector3::Zero()) {}

void NetMotion::remember(const ControlNet& net, const Pose& frame) {
  SPOONBILL_ASSERT(net.x.size() == points_m_.size());
  visit_points(net, frame, [&](std::size_t i, const Vector3& point) { points_m_[i] = point; });
  is_known_ = true;
}

double NetMotion::since_m(const ControlNet& net, const Pose& frame) const {
  SPOONBILL_ASSERT(net.x.size() == points_m_.size());
  if (!is_known_) return std::numeric_limits<double>::infinity();
  double most_square = 0.0;
  visit_points(net, frame, [&](std::size_t i, const Vector3& point) {
    const double square = (point - points_m_[i]).squaredNorm();
    // A value that is not a number is kept, because no comparison with it is true.
    if (square > most_square || std::isnan(square)) most_square = square;
  });
  return std::sqrt(most_square);
}

}  // namespace spoonbill
