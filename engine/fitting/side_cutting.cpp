#include "engine/fitting/side_cutting.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Cuts each triangle between the middles of its sides that are too long.
class SideCutter {
 public:
  SideCutter(std::vector<Vector3>& points_m, double longest_m)
      : points_m_(&points_m), longest_m_(longest_m) {}

  void cut(const TriangleCorners& t, std::vector<TriangleCorners>& pieces) {
    std::array<std::uint32_t, 3> middle{};
    std::array<bool, 3> is_cut{};
    for (std::size_t k = 0; k < 3; ++k) is_cut[k] = middle_of(t[k], t[(k + 1) % 3], middle[k]);
    const auto cuts = std::count(is_cut.begin(), is_cut.end(), true);
    if (cuts == 0) pieces.push_back(t);
    if (cuts == 3) {
      pieces.push_back({middle[0], middle[1], middle[2]});
      for (std::size_t k = 0; k < 3; ++k) pieces.push_back({t[k], middle[k], middle[(k + 2) % 3]});
    }
    if (cuts != 1 && cuts != 2) return;
    // From the side that is cut alone, or after the one that is not.
    std::size_t k = 0;
    while (cuts == 1 ? !is_cut[k] : is_cut[(k + 2) % 3]) ++k;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], m = middle[k];
    pieces.push_back({m, b, cuts == 1 ? c : middle[(k + 1) % 3]});
    if (cuts == 1) {
      pieces.push_back({a, m, c});
    } else {
      pieces.push_back({a, m, middle[(k + 1) % 3]});
      pieces.push_back({a, middle[(k + 1) % 3], c});
    }
  }

 private:
  bool middle_of(std::uint32_t a, std::uint32_t b, std::uint32_t& middle) {
    if (((*points_m_)[a] - (*points_m_)[b]).norm() <= longest_m_) return false;
    const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    const auto [place, is_new] = middles_.try_emplace(key, static_cast<std::uint32_t>(points_m_->size()));
    if (is_new) points_m_->push_back(0.5 * ((*points_m_)[a] + (*points_m_)[b]));
    middle = place->second;
    return true;
  }

  std::vector<Vector3>* points_m_;
  double longest_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

}  // namespace

void cut_long_sides(std::vector<Vector3>& points_m, std::vector<TriangleCorners>& triangles, double longest_m,
                    std::size_t triangle_limit) {
  SPOONBILL_ASSERT(longest_m > 0.0);
  // Each round halves what is too long.
  for (int round = 0; round < 16 && triangles.size() < triangle_limit; ++round) {
    SideCutter cutter(points_m, longest_m);
    std::vector<TriangleCorners> pieces;
    for (const TriangleCorners& corners : triangles) cutter.cut(corners, pieces);
    const bool done = pieces.size() == triangles.size();
    triangles = std::move(pieces);
    if (done) break;
  }
}

}  // namespace spoonbill
